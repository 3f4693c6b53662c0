"""Kinds of values that stand in a config."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias, TypeVar, get_args

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag
from pydantic_core import PydanticCustomError
from typing_extensions import TypeAliasType

from data_collection.limits import NAME_PATTERN, NAME_RULE
from data_collection.strict_model import LISTED
from model.methods import METHODS

Channel = Literal["action", "position", "object", "color"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
WORDLESS = tuple(name for name, method in METHODS.items() if not method.hears_words)
"""The methods that hear no words (ALL): they run by themselves, once for all ROW."""

_T = TypeVar("_T")


def _each_once(values: tuple[_T, ...]) -> tuple[_T, ...]:
    seen: set[_T] = set()
    for value in values:
        if value in seen:
            raise PydanticCustomError("twice", "twice", {"value": value})
        seen.add(value)
    return values


def _given(value: object) -> object:
    """A key may be left out, but not be null."""
    if value is None:
        raise PydanticCustomError("null", "null")
    return value


Several: TypeAlias = Annotated[
    tuple[_T, ...], Field(min_length=1, json_schema_extra={"uniqueItems": True}), LISTED, AfterValidator(_each_once)
]
Maybe: TypeAlias = Annotated[_T | None, BeforeValidator(_given)]
PerChannel: TypeAlias = Annotated[
    Annotated[_T, Tag("one")] | Annotated[dict[Channel, _T], Tag("each")],
    Discriminator(lambda value: "each" if isinstance(value, dict) else "one"),
]
OnePerSet: TypeAlias = Annotated[
    Annotated[_T, Tag("one")] | Annotated[Several[_T], Tag("each")],
    Discriminator(lambda value: "each" if isinstance(value, list | tuple) else "one"),
]
"""What an experiment of one data set says once, and one of several in a list."""
Name = TypeAliasType("Name", Annotated[str, Field(pattern=NAME_PATTERN, description=NAME_RULE)])
TrialCount: TypeAlias = Annotated[int, Field(ge=1, le=1_000_000)]
Percent: TypeAlias = Annotated[int, Field(ge=0, le=100)]
if TYPE_CHECKING:
    MethodName: TypeAlias = str
else:
    MethodName = TypeAliasType("MethodName", Literal[tuple(METHODS)])
