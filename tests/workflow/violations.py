"""Every way in which a value can break a JSON schema, made from the schema itself."""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Iterator
from typing import Any

Schemas = dict[str, dict[str, Any]]
Path = tuple[str | int, ...]

WRONG_TYPES: dict[str, list[Any]] = {
    "integer": ["text", 1.5, 2.0, True, None, [1], math.nan],
    "number": ["text", True, None, [1.0], {"a": 1}],
    "string": [5, None, True, ["text"], {"a": 1}],
    "boolean": ["yes", 1, None, []],
    "array": ["text", 5, None, {"a": 1}],
    "object": ["text", 5, None, ["a"]],
}


class Breaker:
    """Makes valid samples of a set of schemas, and broken ones.

    Args:
        schemas: the schemas by file name.
        overrides: valid values of properties, by name, that cannot be guessed from the schema.
    """

    def __init__(self, schemas: Schemas, overrides: dict[str, Any]) -> None:
        self.schemas = schemas
        self.overrides = overrides

    def resolve(self, schema: dict[str, Any], document: str) -> tuple[dict[str, Any], str]:
        """The schema that a reference means, and the document that it stands in."""
        while "$ref" in schema:
            name, _, pointer = schema["$ref"].partition("#")
            document = name or document
            schema = self.schemas[document]
            for part in pointer.strip("/").split("/") if pointer else ():
                schema = schema[part]
        return schema, document

    def sample(self, schema: dict[str, Any], document: str, name: str = "") -> Any:
        """A valid value in which every property is present."""
        schema, document = self.resolve(schema, document)
        if name in self.overrides:
            return copy.deepcopy(self.overrides[name])
        if schema.get("type") == "object":
            properties = schema.get("properties", {})
            value = {key: self.sample(inner, document, key) for key, inner in properties.items()}
            if not properties:
                value = copy.deepcopy(schema.get("default", {}))
            return value
        if "default" in schema:
            return copy.deepcopy(schema["default"])
        if "enum" in schema:
            return schema["enum"][0]
        if schema["type"] == "array":
            return [self.sample(schema["items"], document)] * schema.get("minItems", 1)
        if schema["type"] in ("integer", "number"):
            return schema.get("minimum", schema.get("exclusiveMinimum", 0) + 1)
        return "text"

    def broken(
        self, schema: dict[str, Any], document: str, value: Any, path: Path = ()
    ) -> Iterator[tuple[str, Path, Any]]:
        """Each way to break a valid value: (what is wrong, where, the broken value as a whole)."""
        schema, document = self.resolve(schema, document)
        if "if" in schema and not isinstance(value, dict):  # one value for all channels, or a mapping of values
            yield from self.broken(schema["else"], document, value, path)
            return
        if "if" in schema:
            for wrong in ("text", None, ["a"], True):
                yield f"wrong type {wrong!r}", path, wrong
            yield from self._broken_mapping(schema["then"], document, value, path)
            return
        for wrong in WRONG_TYPES.get(schema.get("type", ""), ["nonsense", 17, None]):
            yield f"wrong type or value {wrong!r}", path, wrong
        yield from self._out_of_range(schema, value, path)
        if isinstance(value, list):
            yield from self._broken_list(schema, document, value, path)
        if isinstance(value, dict):
            yield from self._broken_mapping(schema, document, value, path)

    def _out_of_range(self, schema: dict[str, Any], value: Any, path: Path) -> Iterator[tuple[str, Path, Any]]:
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

    def _broken_list(
        self, schema: dict[str, Any], document: str, value: list[Any], path: Path
    ) -> Iterator[tuple[str, Path, Any]]:
        if schema.get("minItems", 0) > 0:
            yield "wrong length: too short", path, value[: schema["minItems"] - 1]
        if "maxItems" in schema:
            yield "wrong length: too long", path, [*value, *range(schema["maxItems"])]
        if schema.get("uniqueItems"):
            yield "duplicate", path, [*value, value[0]]
        if value and "items" in schema:
            for label, where, wrong in self.broken(schema["items"], document, value[0], (*path, 0)):
                yield label, where, [wrong, *value[1:]]

    def _broken_mapping(
        self, schema: dict[str, Any], document: str, value: dict[str, Any], path: Path
    ) -> Iterator[tuple[str, Path, Any]]:
        if schema.get("additionalProperties") is False:
            yield "unknown key", path, {**value, "no_such_key": 1}
        if "propertyNames" in schema:
            allowed, _ = self.resolve(schema["propertyNames"], document)
            for bad in ("", "two words", "../up", "x" * 80):
                if not re.search(allowed.get("pattern", ""), bad) or len(bad) < allowed.get("minLength", 0):
                    yield f"bad name {bad[:9]!r}", path, {**value, bad: next(iter(value.values()), {})}
        if schema.get("minProperties", 0) > 0:
            yield "empty", path, {}
        for key in schema.get("required", ()):
            yield f"missing key {key}", path, {k: v for k, v in value.items() if k != key}
        for key, inner in schema.get("properties", {}).items():
            if key in value:
                for label, where, wrong in self.broken(inner, document, value[key], (*path, key)):
                    yield label, where, {**value, key: wrong}
        if isinstance(schema.get("additionalProperties"), dict) and value:
            key = next(iter(value))
            for label, where, wrong in self.broken(
                schema["additionalProperties"], document, value[key], (*path, key)
            ):
                yield label, where, {**value, key: wrong}
