"""Every way in which a value can break the schema of the config, made from the schema itself."""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from workflow.plan.schema import Schema, inner, resolved

Path = tuple[str | int, ...]

WRONG_TYPES: dict[str, list[Any]] = {
    "integer": ["text", 1.5, 2.0, True, None, [1], math.nan],
    "number": ["text", True, None, [1.0], {"a": 1}],
    "string": [5, None, True, ["text"], {"a": 1}],
    "boolean": ["yes", 1, None, []],
    "array": ["text", 5, None, {"a": 1}],
    "object": ["text", 5, None, ["a"]],
}


def sample(schema: Schema, overrides: Mapping[str, Any], name: str = "") -> Any:
    """A valid value in which every key is present.

    Args:
        schema: Of the value.
        overrides: Valid values, by key, that cannot be guessed from the schema.
        name: The key that holds the value.
    """
    schema = resolved(schema)
    if name in overrides:
        return copy.deepcopy(overrides[name])
    if "properties" in schema:
        return {key: sample(found, overrides, key) for key, found in schema["properties"].items()}
    if "default" in schema:
        return copy.deepcopy(schema["default"])
    if "const" in schema or "enum" in schema:
        return schema.get("const") or schema["enum"][0]
    if schema["type"] == "array":
        return [sample(schema["items"], overrides)] * schema.get("minItems", 1)
    if schema["type"] in ("integer", "number"):
        return schema.get("minimum", schema.get("exclusiveMinimum", 0) + 1)
    return "text"


def broken(schema: Schema, value: Any, path: Path = ()) -> Iterator[tuple[str, Path, Any]]:
    """Each way to break a valid value: (what is wrong, where, the broken value as a whole)."""
    schema = resolved(schema)
    if "discriminator" in schema:
        kinds = schema["discriminator"]["mapping"]
        none_at_all: list[Any] = ["text", 5, None, ["a"], {}]
        yield from ((f"no kind {wrong!r}", path, wrong) for wrong in none_at_all)
        yield "unknown kind", (*path, "kind"), value | {"kind": "no_such_kind"}
        schema = resolved({"$ref": kinds[value["kind"]]})
    if "oneOf" in schema:  # one value for all channels, or a mapping of values; one for one data set, or a list
        kinds = {one.get("type"): one for one in map(resolved, schema["oneOf"])}
        if isinstance(value, dict):
            yield from ((f"wrong type {wrong!r}", path, wrong) for wrong in ("text", None, ["a"], True))
            yield from _broken_mapping(kinds["object"], value, path)
        else:
            found = broken(schema["oneOf"][0], value, path)
            yield from (
                one for one in found if not ("array" in kinds and one[1] == path and isinstance(one[2], list))
            )
        return
    free = "const" in schema or "enum" in schema
    kinds_of_wrong: list[Any] = ["nonsense", 17, None] if free else WRONG_TYPES[schema["type"]]
    for wrong in kinds_of_wrong:
        if not (path[-1:] == ("kind",) and isinstance(wrong, str)):  # another kind has other keys
            yield f"wrong type or value {wrong!r}", path, wrong
    yield from _out_of_range(schema, path)
    if isinstance(value, list | tuple):
        yield from _broken_list(schema, list(value), path)
    if isinstance(value, dict):
        yield from _broken_mapping(schema, value, path)


def _out_of_range(schema: Schema, path: Path) -> Iterator[tuple[str, Path, Any]]:
    if schema.get("type") == "number":
        for wrong in (math.nan, math.inf, -math.inf):
            yield f"not finite {wrong}", path, wrong
    step = 1 if schema.get("type") == "integer" else 0.001
    for key, wrong in (("minimum", -step), ("maximum", step), ("exclusiveMinimum", 0), ("exclusiveMaximum", 0)):
        if key in schema:
            yield f"beyond {key}", path, schema[key] + wrong
    if "maxLength" in schema:
        yield "too long", path, "x" * (schema["maxLength"] + 1)
    if schema.get("minLength", 0) > 0:
        yield "empty", path, ""
    if "pattern" in schema:
        for bad in ("two words / and ../more", "x\n", "a\0b", ""):
            if not re.search(schema["pattern"], bad):
                yield f"pattern {bad!r}", path, bad


def _broken_list(schema: Schema, value: list[Any], path: Path) -> Iterator[tuple[str, Path, Any]]:
    if schema.get("minItems", 0) > 0:
        yield "wrong length: too short", path, value[: schema["minItems"] - 1]
    if "maxItems" in schema:
        yield "wrong length: too long", path, [*value, *[sample(inner(schema, 0), {})] * schema["maxItems"]]
    if schema.get("uniqueItems"):
        yield "duplicate", path, [*value, value[0]]
    if value:
        for label, where, wrong in broken(inner(schema, 0), value[0], (*path, 0)):
            yield label, where, [wrong, *value[1:]]


def _broken_mapping(schema: Schema, value: dict[str, Any], path: Path) -> Iterator[tuple[str, Path, Any]]:
    names = resolved(schema.get("propertyNames", {}))
    if schema.get("additionalProperties") is False or "enum" in names:
        yield "unknown key", path, {**value, "no_such_key": 1}
    if "pattern" in names:
        for bad in ("", "two words", "../up", "x" * 80):
            if not re.search(names["pattern"], bad):
                yield f"bad name {bad[:9]!r}", path, {**value, bad: next(iter(value.values()), {})}
    if schema.get("minProperties", 0) > 0:
        yield "empty", path, {}
    for key in schema.get("required", ()):
        yield f"missing key {key}", path, {k: v for k, v in value.items() if k != key}
    alike = "pattern" in names and "discriminator" not in inner(schema, "")  # the first entry stands for all
    for key in list(value)[: 1 if alike else None]:
        for label, where, wrong in broken(inner(schema, key), value[key], (*path, key)):
            yield label, where, {**value, key: wrong}
