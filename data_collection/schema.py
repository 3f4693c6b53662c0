"""Settings as dataclasses whose fields carry documentation and range: JSON schema and reader derive from them."""

import dataclasses
import json
from collections.abc import Mapping
from typing import Any, TypeVar

T = TypeVar("T")

_TYPES = {float: "number", int: "integer", bool: "boolean", str: "string"}


def setting(
    default: Any = dataclasses.MISSING,
    *,
    doc: str,
    low: float | None = None,
    high: float | None = None,
    factory: Any = dataclasses.MISSING,
    entries: type | None = None,
    **schema: Any,
) -> Any:
    """Return a dataclass field.

    Args:
        default: Value when the key is absent; without one, and without a factory, the key is required.
        doc: What it is, with its unit.
        low: Smallest value allowed.
        high: Largest value allowed.
        factory: Makes the default.
        entries: Dataclass of the entries of a list.
        schema: Further keywords of the field's JSON schema.
    """
    if low is not None:
        schema["minimum"] = low
    if high is not None:
        schema["maximum"] = high
    metadata = {"doc": doc, "schema": schema, "entries": entries}
    return dataclasses.field(default=default, default_factory=factory, metadata=metadata)


def json_schema(cls: type) -> dict[str, Any]:
    """Return the closed JSON schema (draft 2020-12) of a dataclass of settings."""
    properties: dict[str, Any] = {}
    required = []
    for item in dataclasses.fields(cls):
        entry: dict[str, Any] = {"description": item.metadata["doc"]}
        if isinstance(item.type, type) and dataclasses.is_dataclass(item.type):
            entry = {**json_schema(item.type), **entry, "default": {}}
        elif item.metadata["entries"] is not None:
            entry.update(type="array", items=json_schema(item.metadata["entries"]), default=[])
        else:
            if item.type in _TYPES:
                entry["type"] = _TYPES[item.type]
            if item.default is not dataclasses.MISSING:
                entry["default"] = _plain(item.default)
            elif item.default_factory is not dataclasses.MISSING:
                entry["default"] = _plain(item.default_factory())
            else:
                required.append(item.name)
        entry.update(item.metadata["schema"])
        properties[item.name] = entry
    schema: dict[str, Any] = {"type": "object", "properties": properties, "additionalProperties": False}
    return {**schema, "required": required} if required else schema


def mismatches(cls: type, mapping: Mapping[str, Any], name: str) -> list[str]:
    """Return where a mapping breaks the schema of a dataclass, each with its key path under ``name``."""
    from jsonschema import Draft202012Validator

    errors = sorted(Draft202012Validator(json_schema(cls)).iter_errors(mapping), key=lambda error: error.json_path)
    return [f"{error.json_path.replace('$', name, 1)}: {error.message}" for error in errors]


def build(cls: type[T], mapping: Mapping[str, Any]) -> T:
    """Return the dataclass that a mapping without mismatches describes; absent keys take their defaults."""
    values: dict[str, Any] = {}
    for item in dataclasses.fields(cls):  # type: ignore[arg-type]
        if item.name not in mapping:
            continue
        given = mapping[item.name]
        if isinstance(item.type, type) and dataclasses.is_dataclass(item.type):
            values[item.name] = build(item.type, given)
        elif item.metadata["entries"] is not None:
            values[item.name] = tuple(build(item.metadata["entries"], entry) for entry in given)
        elif item.type in (float, int):
            values[item.name] = item.type(given)
        else:
            values[item.name] = _frozen(given)
    return cls(**values)


def _plain(value: Any) -> Any:
    return json.loads(json.dumps(value))


def _frozen(value: Any) -> Any:
    """Return lists as tuples and whole numbers inside them as floats."""
    if isinstance(value, Mapping):
        return {key: _frozen(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return tuple(_frozen(entry) for entry in value)
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
