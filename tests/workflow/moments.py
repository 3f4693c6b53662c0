"""Kill a process at every step that it takes in the file system."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

CHANGES = {"os.rename", "os.remove", "os.rmdir", "os.mkdir", "os.chmod", "os.utime"}
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT


def killed_at_each_step(work: Callable[[], object], folder: Path) -> Iterator[str]:
    """Run a function in a child process that is killed before its first change below a folder, its second, and so on.

    A file that is opened to be written is two steps: before it is there, and when it is there but empty.

    Yields:
        What the child was about to do, each time that it was killed; ends when a child gets to its end.
    """
    number = 0
    while True:
        number += 1
        reads, writes = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                os.close(reads)
                sys.addaudithook(_Killer(number, folder, writes))
                work()
            finally:
                os._exit(0)
        os.close(writes)
        with os.fdopen(reads) as told:
            step = told.read()
        _, status = os.waitpid(child, 0)
        if not os.WIFSIGNALED(status):
            assert status == 0
            return
        yield step


class _Killer:
    """Kills its own process at a step."""

    def __init__(self, number: int, folder: Path, told: int) -> None:
        self._left = number
        self._folder = str(folder)
        self._told = told
        self._dying = False

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        writing = event == "open" and isinstance(arguments[2], int) and bool(arguments[2] & WRITING)
        if writing and Path(str(arguments[0])).is_dir():
            return  # a file without a name, in this folder: it leaves nothing behind
        if self._dying or not (event in CHANGES or writing):
            return
        path = str(arguments[0])
        if not path.startswith(self._folder) and (
            path.startswith("/") or not str(Path.cwd()).startswith(self._folder)
        ):
            return
        self._step(f"{event} {path}")
        if writing:
            if self._left == 1:
                self._dying = True
                os.close(os.open(path, arguments[2], 0o600))
            self._step(f"empty {path}")

    def _step(self, what: str) -> None:
        self._left -= 1
        if self._left == 0:
            os.write(self._told, what.encode())
            os.kill(os.getpid(), signal.SIGKILL)
