"""Do what a page says, from its first block to its last, in the current folder: `python -m tests.docs.run_page PAGE`.

Python blocks share one namespace. What a reader does once and for all, or for hours, is only looked at: `make test`
and the like print what they would do.
"""

from __future__ import annotations

import io
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from tests.docs.pages import Block, blocks, matches

# The environment is there, so that no command has to set it up.
SHELL = """\
set -euo pipefail
make() {
    case "$1" in
        setup|test|test-slow|lint|format|bench|lock|reference) command make -o .venv/.ready --dry-run "$@" ;;
        *) command make -o .venv/.ready "$@" ;;
    esac
}
"""


def run_shell(code: str, succeeds: bool = True) -> str:
    """Run commands in bash and return what they print."""
    done = subprocess.run(
        ["bash", "-c", SHELL + code], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    if (done.returncode == 0) is not succeeds:
        raise SystemExit(f"status {done.returncode} of\n{code}\n{done.stdout}")
    return done.stdout


def run_block(block: Block, page: str, namespace: dict[str, Any]) -> str:
    """Run one block and return what it prints; a traceback names the page and its line."""
    if block.note.startswith("file "):
        path = Path(block.note.removeprefix("file "))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{block.code}\n", encoding="utf-8")
        return ""
    if block.language == "sh":
        return run_shell(block.code, succeeds=block.note != "fails")
    with redirect_stdout(io.StringIO()) as printed:
        exec(compile("\n" * (block.line - 1) + block.code, page, "exec"), namespace)
    return printed.getvalue()


def run_page(page: Path) -> None:
    """Run the blocks of a page, and compare what they print where the page shows it."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    printed = ""
    for block in blocks(page.read_text(encoding="utf-8")):
        if block.runs:
            sys.stdout.write(f"{page.name}:{block.line} {block.language}\n")
            printed = run_block(block, str(page), namespace)
            sys.stdout.write(printed)
        elif block.note == "output" and not matches(printed, block.code):
            raise SystemExit(f"{page.name}:{block.line}: the page shows\n{block.code}\nprinted was\n{printed}")


if __name__ == "__main__":
    run_page(Path(sys.argv[1]))
