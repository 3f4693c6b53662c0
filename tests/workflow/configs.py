"""Small configs to change and break."""

from pathlib import Path
from typing import Any

from tests.synthetic import WORDS

FILE = Path("study.yaml")


def minimal(**changes: Any) -> dict[str, Any]:
    """A config of one experiment; a change to None leaves a key out."""
    own: dict[str, Any] = {"words": WORDS, "D": [6]} | changes
    return {"experiments": {"own": {key: value for key, value in own.items() if value is not None}}}
