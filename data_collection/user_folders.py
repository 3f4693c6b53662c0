"""Where a user's own files are, on machines on which that is not said: containers, service accounts, clusters."""

from __future__ import annotations

import os
from pathlib import Path

NAME = "cross-situational-learning"


def user_cache() -> Path | None:
    """The project's part of the user's cache folder, which need not exist.

    It is in `XDG_CACHE_HOME` (which counts only if it is absolute, says its specification), else in `~/.cache`. None
    where neither that nor HOME is set and the user's id has no entry in the list of users.
    """
    named = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if named.is_absolute():
        return named / NAME
    try:
        return Path.home().absolute() / ".cache" / NAME
    except RuntimeError:
        return None
