"""What is remembered from one command to the next, in a file of the cache: never needed, only quicker."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

from data_collection.files import write_text

MOST = 20_000
"""So many entries are kept, those that were added last."""


def recall(path: Path) -> dict[str, dict[str, Any]]:
    """Return what `remember` wrote; nothing where the file is missing or something else."""
    try:
        known = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    is_known = isinstance(known, dict) and all(isinstance(value, dict) for value in known.values())
    return known if is_known else {}


def remember(path: Path, known: dict[str, dict[str, Any]]) -> None:
    """Write what is known by key; where it cannot be written, it is not remembered."""
    kept = dict(list(known.items())[-MOST:])
    with suppress(OSError):
        write_text(path, json.dumps(kept, ensure_ascii=False))
