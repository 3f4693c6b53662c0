"""The reference of all config keys, made from the schemas: `python -m workflow.plan.reference docs/config.md`."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from data_collection.files import replacing
from workflow.plan.config import SCHEMAS
from workflow.plan.limits import MAX_CONFIG_BYTES, MAX_CONFIG_VALUES, MAX_FITS

Schema = Mapping[str, Any]

TOP = "config.schema.json"
HEAD = """\
# Config reference

Generated from [`workflow/schemas/`](../workflow/schemas/) by `make docs`. Do not edit.

A config is one YAML file. Any other key, and any value outside of what is allowed, is refused by name before anything
runs. Nothing may stand twice in a list of conditions (`D`, `ROW`, `methods`, …). Worked examples stand in
[conditions](conditions.md).

The file is read as data: no tags, no aliases, at most {bytes:,} bytes and {values:,} values. An experiment has at
most {fits:,} fits and parts of a simulation.
"""


def reference() -> str:
    """The whole page as Markdown: a section for each mapping of the config, a row for each key."""
    schemas = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in SCHEMAS.glob("*.schema.json")}
    whole = _follow(schemas[TOP], TOP, schemas)
    lines = [HEAD.format(bytes=MAX_CONFIG_BYTES, values=MAX_CONFIG_VALUES, fits=MAX_FITS)]
    for path, schema in _sections("", whole):
        lines += _section(path, schema, whole["properties"] if path else {})
    return "\n".join(lines)


def _follow(schema: Any, file: str, schemas: Mapping[str, Schema]) -> Any:
    """A schema without references; what stands beside a reference wins over what is behind it.

    Args:
        schema: a schema, or part of one.
        file: the file that it stands in.
        schemas: every file by its name.
    """
    if isinstance(schema, list):
        return [_follow(item, file, schemas) for item in schema]
    if not isinstance(schema, Mapping):
        return schema
    own = {key: _follow(value, file, schemas) for key, value in schema.items() if key not in ("$ref", "$defs")}
    if "$ref" not in schema:
        return own
    target, _, pointer = schema["$ref"].partition("#/")
    behind: Any = schemas[target or file]
    for part in filter(None, pointer.split("/")):
        behind = behind[part]
    return {**_follow(behind, target or file, schemas), **own}


def _sections(path: str, schema: Schema) -> Iterator[tuple[str, Schema]]:
    """Every mapping with keys of its own, itself first: its place in the config, and its schema."""
    yield path, schema
    for key, value in schema["properties"].items():
        for below, inner in _inner(key, value):
            yield from _sections(f"{path}.{below}".removeprefix("."), inner)


def _inner(key: str, schema: Schema) -> Iterator[tuple[str, Schema]]:
    """The mapping with keys of its own that a key holds, if it does: itself, by name, or as items of a list."""
    for suffix, inner in (("", schema), (".NAME", schema.get("additionalProperties")), ("[…]", schema.get("items"))):
        if isinstance(inner, Mapping) and "properties" in inner:
            yield f"{key}{suffix}", inner


def _section(path: str, schema: Schema, shared: Mapping[str, Schema]) -> list[str]:
    """The lines of one section; keys that are the same at the top of the config are not told again."""
    keys = {key: value for key, value in schema["properties"].items() if shared.get(key) != value}
    lines = [f"## {path or 'The whole config'}", ""]
    if meaning := schema.get("description"):
        lines += [f"{_sentence(meaning)}", ""]
    if len(keys) < len(schema["properties"]):
        again = ", ".join(f"`{key}`" for key in schema["properties"] if key not in keys)
        lines += [f"Beside these, for this experiment alone: {again}.", ""]
    lines += ["| key | allowed | default | meaning |", "| --- | --- | --- | --- |"]
    for key, value in keys.items():
        place = next((f"{path}.{below}".removeprefix(".") for below, _ in _inner(key, value)), "")
        allowed = f"[{place}](#{_anchor(place)})" if place else _allowed(value)
        shown = f"`{_literal(value['default'])}`" if "default" in value and not place else ""
        shown = "required" if key in schema.get("required", ()) else shown
        cells = (f"`{key}`", allowed, shown, value.get("description", ""))
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return [*lines, ""]


def _anchor(heading: str) -> str:
    """What GitHub makes of a heading: small letters, no punctuation."""
    return "".join(letter for letter in heading.lower() if letter.isalnum() or letter in "_-")


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}{'' if text.endswith('.') else '.'}"


def _literal(value: Any) -> str:
    """A value as it may stand in a YAML file."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _allowed(schema: Schema) -> str:
    """What a value may be, in words."""
    if "enum" in schema:
        return ", ".join(f"`{_literal(value)}`" for value in schema["enum"])
    if "else" in schema:
        return f"{_allowed(schema['else'])}; or a mapping from channels to such numbers"
    kind = schema.get("type")
    if kind in ("integer", "number"):
        return " ".join(filter(None, ["whole number" if kind == "integer" else "number", _range(schema)]))
    if kind == "array":
        return _list(schema)
    if kind == "object":
        return f"mapping from names to: {_allowed(schema['additionalProperties'])}"
    return {"boolean": "`true`, `false`", "string": "text"}[str(kind)]


def _range(schema: Schema) -> str:
    low, high = schema.get("minimum"), schema.get("maximum")
    if low is not None and high is not None:
        return f"from {low:g} to {high:g}" if isinstance(high, float) else f"from {low} to {high}"
    if low is not None:
        return f"from {low}"
    return f"above {schema['exclusiveMinimum']}" if "exclusiveMinimum" in schema else ""


def _list(schema: Schema) -> str:
    least, most = schema.get("minItems", 0), schema.get("maxItems")
    count = f" of {least}" if least == most else "" if least == 0 else f" of {least} or more"
    items = schema["items"]
    each = items["description"] if items.get("type") == "string" and "description" in items else _allowed(items)
    return f"list{count}, each: {each}"


def main() -> None:
    """Write the page to the path that is given."""
    with replacing(Path(sys.argv[1])) as (temporary,):
        temporary.write_text(reference(), encoding="utf-8")


if __name__ == "__main__":
    main()
