"""What files and values are to a job: the names that its rule gives them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from snakemake.iocontainers import Namedlist


def by_role(items: Any) -> dict[str, Any]:
    """What Snakemake lists (input, output, params, wildcards) by role: `fit`, `logs[0]`, or `[0]` without a name.

    Raises:
        ValueError: Something without a name comes after something with one.
    """
    named: dict[str, Any] = {}
    for name, value in items.items():
        named |= (
            {f"{name}[{i}]": each for i, each in enumerate(value)} if isinstance(value, Namedlist) else {name: value}
        )
    roles = {f"[{i}]": value for i, value in enumerate(items[: len(items) - len(named)])} | named
    if list(roles.values()) != list(items):
        raise ValueError(f"{items}: what has no name must come first")
    return roles


def paths(files: Namedlist) -> Namedlist:
    """Files that Snakemake lists (input, output) as paths, under the same names."""
    return Namedlist(files, custom_map=Path)
