"""The JSON schema of the config, made from its model."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from workflow.plan.study_config import StudyConfig

Schema = Mapping[str, Any]


@cache
def config_schema() -> dict[str, Any]:
    """The closed JSON schema (draft 2020-12) of a config."""
    schema: dict[str, Any] = _plain(StudyConfig.model_json_schema())
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _plain(schema: Any, names: bool = False) -> Any:
    """A part of a schema without titles, which repeat the keys, and without null, which stands for no value at all.

    Args:
        schema: The part.
        names: Whether the keys of a mapping are names of the config, not keywords.
    """
    if isinstance(schema, list):
        return [_plain(item) for item in schema]
    if not isinstance(schema, Mapping):
        return schema
    if names:
        return {key: _plain(value) for key, value in schema.items()}
    own = {
        key: value if key == "default" else _plain(value, key in ("properties", "$defs"))
        for key, value in schema.items()
        if key not in ("title", "anyOf") and not (key == "default" and value is None)
    }
    for choice in schema.get("anyOf", ()):
        if choice != {"type": "null"}:
            own = _plain(choice) | own
    return own


def resolved(schema: Schema) -> Schema:
    """A schema whose reference is followed; what stands beside a reference wins, `of_kind` says what is behind it."""
    if "$ref" not in schema:
        return schema
    behind = resolved(config_schema()["$defs"][schema["$ref"].removeprefix("#/$defs/")])
    own = {key: value for key, value in schema.items() if key != "$ref"}
    return {**behind, "of_kind": behind.get("description", ""), **own}


def inner(schema: Schema, key: str | int) -> Schema:
    """The schema of what a mapping or list holds at a key; empty where the key is unknown."""
    if isinstance(key, int):
        places = schema.get("prefixItems", ())
        found = places[key] if key < len(places) else schema.get("items")
    else:
        found = schema.get("properties", {}).get(key, schema.get("additionalProperties"))
    return resolved(found) if isinstance(found, Mapping) else {}


def alternative(schema: Schema, value: object) -> Schema:
    """Of several schemas the one that a value is to fit; all of them for text, of which each might be meant."""
    kind = "object" if isinstance(value, Mapping) else "array" if isinstance(value, list) else ""
    each = list(map(resolved, schema["oneOf"]))
    fitting = [one for one in each if one.get("type") == kind]
    fitting = fitting or [one for one in each if one.get("type") not in ("object", "array")] or each
    return schema if isinstance(value, str) and len(fitting) > 1 else fitting[0]


def meaning_of(schema: Schema) -> str:
    """What a key means; of the sentence that describes a model, what stands in it."""
    text = str(schema.get("description", ""))
    return text[0].lower() + text[1:-1] if text.endswith(".") else text


def allowed(schema: Schema) -> str:
    """What a value may be, in words."""
    if values := choices(schema):
        return ", ".join(f"`{value}`" for value in values)
    if "discriminator" in schema:
        return "a mapping with the key `kind`"
    if "oneOf" in schema:
        told = " or ".join(allowed(one) for one in schema["oneOf"] if one.get("type") != "object")
        per_channel = any(one.get("type") == "object" for one in schema["oneOf"])
        return f"{told}; or a mapping from channels to such values" if per_channel else told
    match schema.get("type"):
        case "integer":
            return f"whole number{range_text(schema)}"
        case "number":
            return f"number{range_text(schema)}"
        case "array":
            least, most = schema.get("minItems", 0), schema.get("maxItems")
            count = f" of {least}" if least == most else "" if least == 0 else f" of {least} or more"
            item = resolved(schema.get("items") or schema["prefixItems"][0])
            each = item["description"] if "pattern" in item else allowed(item)
            return f"list{count}, each: {each}"
        case "object":
            return f"mapping from names to: {allowed(inner(schema, ''))}"
        case "boolean":
            return "`true`, `false`"
    return "text"


def choices(schema: Schema) -> list[str]:
    """The values of a text of which only some are allowed."""
    return list(schema["enum"]) if "enum" in schema else [schema["const"]] if "const" in schema else []


def range_text(schema: Schema) -> str:
    """The range of a number, with a space before it; nothing where there is none."""
    words = {"minimum": "from", "maximum": "to", "exclusiveMinimum": "above", "exclusiveMaximum": "to below"}
    return "".join(f" {word} {number_text(schema[key])}" for key, word in words.items() if key in schema)


def number_text(number: float) -> str:
    """A number as people write it: 4, not 4.0."""
    return str(int(number)) if number == int(number) else repr(number)
