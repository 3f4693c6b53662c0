"""Keys: a hash of everything that determines an artifact, known before the artifact is made.

A job's key hashes its rule, its wildcards, its parameters (which include the hash of its code and of the lock file),
and the keys of its inputs by role. An output's key hashes the key of its job and its role. The key of a file that no
job makes is the hash of its content. No key contains a path, so keys are equal in all clones and output folders.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any


def plain(value: Any, where: str = "value") -> Any:
    """A value as plain JSON data: tuples and ranges become lists, dataclasses mappings.

    Args:
        value: A parameter of a rule, or a part of one.
        where: Its name in messages.

    Raises:
        ValueError: The value contains an absolute path or a type without canonical JSON.
    """
    if value is None or isinstance(value, bool | int | float):
        return value
    if isinstance(value, str):
        if Path(value).is_absolute():
            raise ValueError(f"{where}: {value!r} is an absolute path, which differs between machines")
        return str(value)
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise ValueError(f"{where}: key {key!r} is not text")
        return {key: plain(inner, f"{where}.{key}") for key, inner in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: plain(getattr(value, each.name), f"{where}.{each.name}") for each in fields(value)}
    if isinstance(value, list | tuple | range):
        return [plain(inner, f"{where}[{i}]") for i, inner in enumerate(value)]
    raise ValueError(f"{where}: a {type(value).__name__} cannot be part of a key (allowed: JSON types)")


def job_key(rule: str, wildcards: Mapping[str, str], parameters: Mapping[str, Any], inputs: Mapping[str, str]) -> str:
    """The key of a job.

    Args:
        rule: Name of its rule.
        wildcards: Values by name.
        parameters: `params` of the rule; they must include `code`, the hash of its code and of the lock file.
        inputs: The key of each input by its role (see `workflow.execution.roles`).

    Raises:
        ValueError: A parameter cannot be part of a key, or `code` is missing.
    """
    if not isinstance(parameters.get("code"), str):
        raise ValueError(f"rule {rule} has no parameter code=tracked(script): changes to its code would go unnoticed")
    parts = {
        "rule": rule,
        "wildcards": plain(wildcards, f"rule {rule}, wildcards"),
        "parameters": plain(parameters, f"rule {rule}, params"),
        "inputs": dict(inputs),
    }
    return hash_of(parts)


def output_key(key_of_job: str, role: str) -> str:
    """The key of one output of a job."""
    return hash_of({"job": key_of_job, "output": role})


def hash_of(data: Any) -> str:
    """sha256 of plain data; equal data have equal hashes."""
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
