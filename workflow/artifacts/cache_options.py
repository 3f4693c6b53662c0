"""Where the store is, and how large it may get: what the user says, or the defaults."""

from __future__ import annotations

import os
from pathlib import Path

from data_collection.user_folders import user_cache

DEFAULT_GIB = 10.0


def default_folder() -> Path | None:
    """The folder that `CACHE` names, or else one in the user's cache folder; None where there is no such folder."""
    named = os.environ.get("CACHE")
    if named:
        return Path(os.path.expanduser(named)).absolute()  # noqa: PTH111 (no error where there is no home folder)
    own = user_cache()
    return None if own is None else own / "artifacts"


def default_limit() -> int:
    """The size limit in bytes: `CACHE_GIB`, where 0 turns the store off.

    Raises:
        ValueError: It is not a size.
    """
    return size_in_bytes("CACHE_GIB", os.environ.get("CACHE_GIB") or str(DEFAULT_GIB), "0 for no cache")


def size_in_bytes(name: str, gibibytes: str, zero: str) -> int:
    """Parse a size.

    Args:
        name: Its name in messages.
        gibibytes: The text.
        zero: What 0 means, for messages.

    Raises:
        ValueError: The text is not a size.
    """
    try:
        size = float(gibibytes)
    except ValueError:
        size = -1.0
    if not 0 <= size < float("inf"):
        raise ValueError(f"{name}={gibibytes}: must be a number of gibibytes, {zero}")
    return int(size * 2**30)
