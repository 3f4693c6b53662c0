"""What commands print: on terminals and in files of any encoding, and numbers with their nouns."""

from __future__ import annotations

import codecs
import io
import os
import sys
from collections.abc import Callable

_PLAIN = str.maketrans(
    {"…": "...", "“": '"', "”": '"', "’": "'", "–": "-", "—": "-", "−": "-", "×": "x", "→": "->", "≤": "<="}
    | {"│": "|", "├": "+", "└": "+", "─": "-"}
)
HANDLER = "plain"
STOPPED = 130  # as a shell says of what an interrupt ended


def _plain(error: UnicodeError) -> tuple[str | bytes, int]:
    """What stands for characters that an encoding lacks: others that look like them, or their numbers."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end].translate(_PLAIN)
    return text.encode("ascii", "backslashreplace").decode(), error.end


def print_anywhere() -> None:
    """Let nothing that this process prints fail for want of a character, as “…” does where output is ASCII."""
    codecs.register_error(HANDLER, _plain)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=HANDLER)


def run_command(command: Callable[[], int], stopped: int = STOPPED) -> int:
    """Run a command line so that it ends in words where its user stops it, or stops reading what it prints.

    Args:
        command: Runs it, and returns its exit status.
        stopped: The exit status after an interrupt.
    """
    print_anywhere()
    try:
        status = command()
        sys.stdout.flush()
        return status
    except KeyboardInterrupt:
        sys.stderr.write("stopped\n")
        return stopped
    except BrokenPipeError:  # as of `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python would complain as it ends
        return 0


def counted(number: int, noun: str, plural: str = "") -> str:
    """A number with its noun: 1 problem, 2 problems, no problems."""
    return f"{f'{number:,}' if number else 'no'} {noun if number == 1 else plural or f'{noun}s'}"
