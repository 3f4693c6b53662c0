"""Read a study's config and check it against the schema, with messages that a person can act on."""

from __future__ import annotations

import difflib
import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, cast

import yaml
from jsonschema import Draft202012Validator
from jsonschema.exceptions import ValidationError
from jsonschema.validators import extend
from referencing import Registry
from referencing.jsonschema import DRAFT202012

from data_collection.files import replacing
from workflow.plan.limits import MAX_CONFIG_BYTES, MAX_CONFIG_VALUES, MAX_NUMBER_LENGTH

SCHEMAS = Path(__file__).parents[1] / "schemas"
MOST_PROBLEMS = 100
"""So many problems are told; the rest is counted."""
COPY = ".config.yaml"  # in the output folder


class ConfigError(ValueError):
    """The config cannot be run; `problems` lists everything that is wrong with it."""

    def __init__(self, source: str, problems: Iterable[str]) -> None:
        self.problems = tuple(problems)
        count = len(self.problems)
        if count > MOST_PROBLEMS:
            self.problems = (*self.problems[:MOST_PROBLEMS], f"and {count - MOST_PROBLEMS} more")
        head = f"{source}: {count} problem{'s' if count > 1 else ''}, nothing was started:"
        super().__init__("\n".join([head, *(f"  {problem}" for problem in self.problems)]))


def read_config(path: Path) -> dict[str, Any]:
    """Read a YAML config as plain data.

    Raises:
        ConfigError: the file is missing, too large, not YAML, not a mapping, has tags or aliases, or has a key twice.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MAX_CONFIG_BYTES + 1)
        text = content.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(str(path), [f"cannot be read: {error}"]) from error
    if len(content) > MAX_CONFIG_BYTES:
        raise ConfigError(str(path), [f"larger than {MAX_CONFIG_BYTES:,} bytes, which no config is"])
    try:
        data = yaml.load(text, Loader=_StrictLoader)
    # A number or a date that is none is a ValueError of the library's.
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise ConfigError(str(path), [f"is not plain YAML: {' '.join(str(error).split())}"]) from error
    if not isinstance(data, dict):
        raise ConfigError(str(path), ["must be a mapping that begins with keys such as `experiments:`"])
    return data


def keep_config(path: Path, out: Path) -> Path:
    """Copy a config into an output folder, so that all processes of a run read the same, whoever edits the file.

    Returns:
        The copy, of which `origin` tells where it came from.

    Raises:
        ConfigError: the file cannot be read, or is no plain YAML.
    """
    copy = out / COPY
    with replacing(copy, copy.with_suffix(".origin")) as (content, origin_file):
        content.write_bytes(path.read_bytes())
        origin_file.write_text(str(path.resolve()), encoding="utf-8")
    read_config(copy)  # the file may have changed since it was checked
    return copy


def origin(path: Path) -> Path:
    """The file that a config was copied from, to whose folder its paths are relative; itself if it is no copy."""
    note = path.with_suffix(".origin")
    return Path(note.read_text(encoding="utf-8")) if path.name == COPY and note.is_file() else path


class _StrictLoader(yaml.SafeLoader):
    """Safe YAML of bounded size without tags, without duplicate keys, and without aliases, which blow a file up."""

    values = 0

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode) or key_node.tag != "tag:yaml.org,2002:str":
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {_short(key_node.value)} is not text (quote it)", key_node.start_mark
                )
            if key_node.value in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {_short(key_node.value)} stands twice", key_node.start_mark
                )
            seen.add(key_node.value)
        return super().construct_mapping(node, deep)

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        self.values += 1
        problem = None
        if isinstance(event, yaml.AliasEvent):
            problem = "aliases are not used here"
        elif event.tag is not None:
            problem = "tags are not used here"
        elif self.values > MAX_CONFIG_VALUES:
            problem = f"more than {MAX_CONFIG_VALUES:,} values, which no config has"
        if problem:
            raise yaml.composer.ComposerError(None, None, problem, event.start_mark)
        node = super().compose_node(parent, index)
        is_number = isinstance(node, yaml.ScalarNode) and node.tag != "tag:yaml.org,2002:str"
        if node is not None and is_number and len(node.value) > MAX_NUMBER_LENGTH:
            raise yaml.composer.ComposerError(None, None, "a number that is too long", node.start_mark)
        return node


def schema_problems(config: Mapping[str, Any]) -> list[str]:
    """Everything in which a config departs from the schema, each naming its key and what is allowed."""
    errors = _validator().iter_errors(config)
    problems = {problem for error in errors for problem in _explain(error)}
    return sorted(problems)


def default(key: str, of: str = "experiment") -> Any:
    """The schema's default of a key of an experiment, None where it has none."""
    entry = _schemas()["config.schema.json"]["$defs"][of]["properties"][key]
    while "default" not in entry and entry.get("$ref", "").startswith("#/$defs/"):
        entry = _schemas()["config.schema.json"]["$defs"][entry["$ref"].removeprefix("#/$defs/")]
    return entry.get("default")


@cache
def _schemas() -> dict[str, Any]:
    """The schemas by file name, without `$schema`: a validator changes its class where it meets one."""
    loaded = {path.name: json.loads(path.read_text()) for path in sorted(SCHEMAS.glob("*.schema.json"))}
    return {
        name: {key: value for key, value in schema.items() if key != "$schema"} for name, schema in loaded.items()
    }


@cache
def _validator() -> Draft202012Validator:
    """A validator in which 2.0 is no integer, and infinity and NaN are no numbers."""
    types = Draft202012Validator.TYPE_CHECKER.redefine_many(
        {
            "integer": lambda _, value: isinstance(value, int) and not isinstance(value, bool),
            "number": lambda _, value: (
                isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
            ),
        }
    )
    registry: Registry[Any] = Registry().with_resources(
        (name, DRAFT202012.create_resource(schema)) for name, schema in _schemas().items()
    )
    unique = {"uniqueItems": _unique_items}
    strict: Any = extend(Draft202012Validator, unique, type_checker=types)  # type: ignore[no-untyped-call]
    return cast(Draft202012Validator, strict(_schemas()["config.schema.json"], registry=registry))


def _unique_items(_: Any, wanted: bool, value: Any, __: Any) -> Iterator[ValidationError]:
    """The keyword `uniqueItems`; the library's compares each with each where kinds are mixed."""
    if wanted and isinstance(value, list) and len(set(map(repr, value))) < len(value):
        yield ValidationError("not unique")


def key_path(parts: Iterable[str | int]) -> str:
    """`experiments.simulator.ROW[1]` of ("experiments", "simulator", "ROW", 1)."""
    text = ""
    for part in parts:
        text += f"[{part}]" if isinstance(part, int) else f".{part}"
    return text.removeprefix(".") or "the config"


def _explain(error: ValidationError) -> Iterator[str]:
    if error.context:
        for inner in error.context:
            yield from _explain(inner)
        return
    where = key_path(error.absolute_path)
    rule, value = str(error.validator), cast(Any, error.instance)
    schema: dict[str, Any] = dict(cast(Mapping[str, Any], error.schema))
    limit: Any = error.validator_value
    meaning = schema.get("description")
    note = f" ({meaning})" if meaning else ""
    if rule == "additionalProperties":
        allowed = sorted(schema.get("properties", {}))
        unknown = sorted(set(value) - set(allowed))
        for key in unknown[:MOST_PROBLEMS]:
            close = difflib.get_close_matches(key, allowed, n=1)
            hint = f"; did you mean {close[0]!r}?" if close else ""
            yield f"{where}: unknown key {_short(key)}{hint} (allowed: {', '.join(allowed)})"
    elif rule == "required":
        for key in sorted(set(limit) - set(value)):
            yield f"{where}: key {key!r} is missing{note}"
    elif rule == "enum":
        yield f"{where}: {_short(value)} is unknown (allowed: {', '.join(map(str, limit))})"
    elif rule == "type":
        expected = [limit] if isinstance(limit, str) else limit
        kinds = " or ".join(_TYPES.get(kind, kind) for kind in expected)
        yield f"{where}: {_short(value)} must be {kinds}{note}"
    elif rule == "uniqueItems":
        counts = Counter(map(repr, value))
        twice = next(item for item in value if counts[repr(item)] > 1)
        yield f"{where}: {_short(twice)} stands twice{note}"
    elif rule == "pattern" and len(error.absolute_path) and error.absolute_path[-1] != value:
        yield f"{where}: {_short(value)} is not allowed{note}"
    elif rule == "pattern":
        yield f"{where}: the name {_short(value)} is not allowed{note}"
    else:
        yield f"{where}: {_short(value)} {_LIMITS.get(rule, 'does not fit {}').format(limit)}{note}"


_TYPES = {
    "integer": "a whole number",
    "number": "a finite number",
    "string": "text",
    "array": "a list, like [1, 2]",
    "object": "a mapping of keys to values",
    "boolean": "true or false",
}
_LIMITS = {
    "minimum": "is less than the minimum of {}",
    "maximum": "is more than the maximum of {}",
    "exclusiveMinimum": "must be more than {}",
    "exclusiveMaximum": "must be less than {}",
    "minItems": "needs at least {} entries",
    "maxItems": "has more than {} entries",
    "minProperties": "needs at least {} entry",
    "maxProperties": "has more than {} entries",
    "minLength": "needs at least {} character",
    "maxLength": "has more than {} characters",
    "const": "must be {}",
}


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"
