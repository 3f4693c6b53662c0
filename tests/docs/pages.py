"""The pages of the documentation, as the blocks of code in them.

A comment `<!-- test: … -->` before a block says what a test has to know: `skip because …`, `fails` (the command ends
with another status than 0), `file NAME` (the block is the content of a file), `output` (of the block before).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md")))

_COMMENT = re.compile(r"<!-- test: (.*) -->\s*")
_FENCE = re.compile(r"\s*```(\w*)\s*")


@dataclass(frozen=True)
class Block:
    """A fenced block of code.

    Attributes:
        language: What stands behind the fence, for instance `sh`; empty for none.
        code: The lines between the fences.
        line: Number of the first of them in the page, from 1.
        note: What the comment before the block says; empty for none.
        heading: The heading that the block stands under.
    """

    language: str
    code: str
    line: int
    note: str = ""
    heading: str = ""

    @property
    def runs(self) -> bool:
        """Whether the block is to be run, or written to a file."""
        runnable = self.language in ("sh", "python") or self.note.startswith("file ")
        return runnable and not self.note.startswith("skip because ")


def blocks(text: str) -> list[Block]:
    """The blocks of a page, in their order."""
    found: list[Block] = []
    opened: Block | None = None
    note = heading = ""
    code: list[str] = []
    for number, line in enumerate(text.splitlines(), start=1):
        if opened is not None:
            if line.strip() == "```":
                found.append(Block(opened.language, "\n".join(code), opened.line, opened.note, opened.heading))
                opened, note = None, ""
            else:
                code.append(line)
        elif comment := _COMMENT.fullmatch(line):
            note = comment[1]
        elif fence := _FENCE.fullmatch(line):
            opened, code = Block(fence[1], "", number + 1, note, heading), []
        elif line.startswith("#"):
            heading, note = line.lstrip("# "), ""
        elif line.strip():
            note = ""
    assert opened is None, f"a block that begins in line {opened.line - 1} has no end"
    return found


def matches(printed: str, expected: str) -> bool:
    """Whether an output holds the expected lines, next to each other; … stands for any text within a line."""
    lines = [".*".join(map(re.escape, line.strip().split("…"))) for line in expected.strip().splitlines()]
    return re.search(r"^\s*" + r"\s*\n\s*".join(lines) + r"\s*$", printed, re.MULTILINE) is not None
