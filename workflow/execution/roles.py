"""What files and values are to a job: the names that its rule gives them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def by_role(items: Sequence[Any]) -> dict[str, Any]:
    """What Snakemake lists (input, output, params, wildcards) by role: `fit`, `logs[0]`, or `[0]` without a name."""
    names: Mapping[str, tuple[int, int | None]] = dict(items._get_names())  # type: ignore[attr-defined]
    roles = {i: f"[{i}]" for i in range(len(items))}
    for name, (first, end) in names.items():
        if end is None:
            roles[first] = name
        else:
            roles |= {i: f"{name}[{i - first}]" for i in range(first, end)}
    return {role: items[i] for i, role in roles.items()}
