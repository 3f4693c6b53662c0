"""What all settings have in common: a closed, frozen model that takes nothing for something else."""

import json
from typing import Annotated, TypeAlias

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from typing_extensions import TypeAliasType

from data_collection.limits import PATH_PATTERN, WORD_PATTERN, WORD_RULE, normal


class StrictModel(BaseModel):
    """Settings: no unknown keys, no text for a number, no 2.0 for a whole number, no NaN; lists become tuples.

    A validator of a whole model raises a `ValueError` with one line per problem: the key, a colon, what is wrong.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        regex_engine="python-re",
        protected_namespaces=(),
    )

    def to_json(self) -> str:
        """Return all settings as canonical JSON, defaults included: the same text for the same settings."""
        return json.dumps(self.model_dump(), sort_keys=True, separators=(",", ":"))


LISTED = Field(strict=False)
"""Marks a tuple, which YAML and JSON write as a list."""

Word = TypeAliasType(
    "Word",
    Annotated[
        str,
        Field(pattern=WORD_PATTERN, description=f"a word: {WORD_RULE}"),
        BeforeValidator(lambda value: normal(value) if isinstance(value, str) else value),
    ],
)
FilePath = TypeAliasType(
    "FilePath",
    Annotated[
        str,
        Field(
            pattern=PATH_PATTERN,
            min_length=1,
            max_length=4000,
            description="a path, relative to the folder of the config file",
        ),
    ],
)
Point: TypeAlias = Annotated[tuple[float, float], LISTED]
Vector: TypeAlias = Annotated[tuple[float, float, float], LISTED]
_Share: TypeAlias = Annotated[float, Field(ge=0, le=1)]
Color: TypeAlias = Annotated[tuple[_Share, _Share, _Share], LISTED]
