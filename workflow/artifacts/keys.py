"""Keys: a hash of all that makes an artifact, known before it is made.

A job's key hashes its rule, wildcards, parameters (among them the hash of its code and of the lock file) and, by
role, the keys of its inputs; an output's key hashes its job's key and its role in it. The key of a file that no job
makes is the hash of its content. Paths are in no key: it is the same in every clone and output folder.
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
        value: a parameter of a rule, or a part of one.
        where: what messages call it.

    Raises:
        ValueError: it is or holds an absolute path, or a type of which equal values need not look equal.
    """
    if value is None or isinstance(value, bool | int | float):
        return value
    if isinstance(value, str):
        if Path(value).is_absolute():
            raise ValueError(f"{where}: {value!r} is an absolute path, with which nothing could be shared")
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
    raise ValueError(f"{where}: a {type(value).__name__} cannot be part of a key (allowed: what JSON can say)")


def job_key(rule: str, wildcards: Mapping[str, str], parameters: Mapping[str, Any], inputs: Mapping[str, str]) -> str:
    """The key of a job.

    Args:
        rule: name of its rule.
        wildcards: their values.
        parameters: `params` of the rule; `code`, the hash of its code and of the lock file, must be among them.
        inputs: the key of each input by its role (see `workflow.execution.roles`).

    Raises:
        ValueError: a parameter cannot be part of a key, or there is no `code`.
    """
    if not isinstance(parameters.get("code"), str):
        raise ValueError(
            f"rule {rule} has no parameter code=tracked(script): changes of its code would be overlooked"
        )
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
    """sha256 of plain data, the same for equal data."""
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
