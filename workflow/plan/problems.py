"""What is wrong with a config, in messages that a person can act on."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from workflow.plan.schema import (
    Schema,
    allowed,
    alternative,
    choices,
    config_schema,
    inner,
    meaning_of,
    number_text,
    range_text,
    resolved,
)
from workflow.plan.typing_slips import number_of, quoted

KINDS = {
    "integer": "a whole number",
    "number": "a finite number",
    "string": "text",
    "array": "a list, like [1, 2]",
    "object": "a mapping of keys to values",
    "boolean": "true or false",
}
LIMITS = {
    "greater_than_equal": "is less than the minimum of {ge}",
    "less_than_equal": "is more than the maximum of {le}",
    "greater_than": "must be more than {gt}",
    "less_than": "must be less than {lt}",
    "too_short": "needs at least {min_length} entry",
    "too_long": "has more than {max_length} entries",
    "string_too_short": "needs at least {min_length} character",
    "string_too_long": "has more than {max_length} characters",
    "literal_error": "is unknown",
}


def problems_of(error: ValidationError, config: Any) -> list[str]:
    """Everything in which a config departs from its model, in alphabetical order: the key, and what is allowed.

    Args:
        error: What pydantic says.
        config: The config as plain data.
    """
    found = [one for one in error.errors(include_url=False) if not _follows(one)]
    return sorted(
        {
            line
            for one in found
            for line in _explain(one["type"], one["loc"], one["input"], one.get("ctx", {}), config)
        }
    )


def _follows(error: ErrorDetails) -> bool:
    """Whether an error only follows from others: pydantic counts the valid entries of a list."""
    return error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]


def key_path(parts: Iterable[str | int]) -> str:
    """`experiments.simulator.ROW[1]` of ("experiments", "simulator", "ROW", 1)."""
    text = ""
    for part in parts:
        text += f"[{part}]" if isinstance(part, int) else f".{part}"
    return text.removeprefix(".") or "the config"


def short(value: Any) -> str:
    """A value as it is shown, cut where it is long."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"


def _explain(
    kind: str, loc: Sequence[str | int], value: Any, context: Mapping[str, Any], config: Any
) -> Iterator[str]:
    if kind in ("extra_forbidden", "invalid_key", "missing"):
        path, schema, _ = _place(loc[:-1], config)
        keys = sorted(schema.get("properties", {}))
        if isinstance(loc[-1], int):
            yield f"{key_path(path)}: {short(value)} needs {schema['minItems']} entries{_note(schema)}"
        elif kind == "missing":
            yield f"{key_path(path)}: key {loc[-1]!r} is missing{_note(inner(schema, loc[-1]))}"
        else:
            yield f"{key_path(path)}: unknown key {short(loc[-1])}{_hint(loc[-1], keys)} (allowed: {', '.join(keys)})"
        return
    path, schema, meaning = _place([part for part in loc if part != "[key]"], config)
    where = key_path(path)
    if kind == "value_error":  # a check of ours; the lines of that of a whole mapping begin with the key
        sign = "." if "properties" in schema else ": "
        yield from (f"{where}{sign}{line}" for line in str(context["error"]).splitlines())
    elif loc and loc[-1] == "[key]":
        _, mapping, _ = _place(loc[:-2], config)
        names = resolved(mapping.get("propertyNames", {}))
        says = "unknown key" if choices(names) else "the name"
        ends = _hint(value, choices(names)) if choices(names) else " is not allowed"
        yield f"{key_path(path[:-1])}: {says} {short(value)}{ends}{_note(names)}"
    elif kind.startswith("union_tag"):
        kinds = list(schema["discriminator"]["mapping"])
        name = schema["discriminator"]["propertyName"]
        if kind == "union_tag_not_found":
            yield f"{where}: key {name!r} is missing (allowed: {', '.join(kinds)})"
        else:
            told = f"{short(value[name])} is unknown{_hint(value[name], kinds)}"
            yield f"{where}.{name}: {told} (allowed: {', '.join(kinds)})"
    elif kind == "twice":
        yield f"{where}: {short(context['value'])} stands twice{_note(schema, meaning)}"
    elif kind in ("string_pattern_mismatch", "string_unicode"):
        yield f"{where}: {short(value)} is not allowed ({schema.get('of_kind', 'visible characters')})"
    elif kind in LIMITS:
        words = [word for one in schema.get("oneOf", [schema]) for word in choices(one)]
        hint = _hint(value, words) if kind == "literal_error" else ""
        limits = {key: number_text(limit) for key, limit in context.items() if isinstance(limit, int | float)}
        yield f"{where}: {short(value)} {LIMITS[kind].format(**limits)}{hint}{_note(schema, meaning)}"
    else:
        expected = KINDS[schema.get("type", "string" if choices(schema) else "object")] + range_text(schema)
        note = _note(schema, meaning) if choices(schema) or schema.get("description") or meaning else ""
        slip = quoted(value) if expected == "text" and "a word" in note else ""
        slip = number_of(value) if "number" in expected else slip
        yield f"{where}: {short(value)} must be {expected}{note}{f'; {slip}' if slip else ''}"


def _place(loc: Sequence[str | int], config: Any) -> tuple[list[str | int], Schema, str]:
    """Where an error is: its path in the config, its schema, and what its key means.

    Args:
        loc: Where pydantic says that it is, with marks of unions.
        config: The config as plain data.
    """
    schema, value = resolved(config_schema()), config
    path: list[str | int] = []
    meaning = ""
    for part in loc:
        if "discriminator" in schema:  # the part says the kind
            schema = resolved({"$ref": schema["discriminator"]["mapping"][part]})
            continue
        if "oneOf" in schema:  # one value for all channels, or a mapping; a number, or a word
            schema = alternative(schema, value)
            continue
        path.append(part)
        schema = inner(schema, part)
        meaning = meaning_of(schema)
        try:
            value = value[part]
        except (KeyError, IndexError, TypeError):
            value = None
    return path, schema, meaning


def _note(schema: Schema, meaning: str = "") -> str:
    """What is allowed, in brackets, and what the key means."""
    if values := choices(schema):
        return f" (allowed: {', '.join(values)})"
    says = meaning_of(schema) or meaning or (f"a {allowed(schema)}" if schema else "")
    return f" ({says})" if says else ""


def _hint(given: Any, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(given, known, n=1) if isinstance(given, str) else []
    return f"; did you mean {close[0]!r}?" if close else ""
