"""What a run needs of the machine: a home folder, a name of the user, and room for a socket.

Containers, clusters and service accounts may lack any of them, and libraries stop over that in words of their own.
"""

from __future__ import annotations

import getpass
import os
import sys
import tempfile
from collections.abc import Iterator, MutableMapping
from contextlib import contextmanager
from pathlib import Path

HOME = ".home"  # in the output folder, where the user has none
LONGEST_SOCKET = 107  # bytes of the path of a socket
_BELOW_TEMPORARY = len("/pymp-12345678/listener-12345678")  # what `multiprocessing` appends
_SHORT_FOLDERS = ("/tmp", "/var/tmp", "/dev/shm")
_ROOM = 2**16  # bytes that a folder must take to count as one that can be written


def settle(out: Path, environment: MutableMapping[str, str] = os.environ) -> None:
    """Give this process, and those that it starts, what the machine does not.

    Args:
        out: The output folder, which holds what a home folder would.
        environment: What is changed.
    """
    try:
        getpass.getuser()
    except (KeyError, OSError):  # the user's id has no entry in the list of users
        environment["LOGNAME"] = f"user{os.getuid()}"
    try:
        home = Path.home()
    except RuntimeError:
        home = out / HOME
        home.mkdir(exist_ok=True)
        environment["HOME"] = str(home)
    if not takes_files(home / ".config"):  # each figure would warn
        environment.setdefault("MPLCONFIGDIR", str(out / HOME / "matplotlib"))
    cache = Path(environment.get("XDG_CACHE_HOME") or home / ".cache")
    if not takes_files(cache):  # libraries write there as they are imported
        environment["XDG_CACHE_HOME"] = str(out / HOME / "cache")
        environment.setdefault("TORCH_HOME", str(cache / "torch"))  # whose weights can still be read
    named = environment.get("TMPDIR", "")
    if named and not Path(named).is_dir():
        sys.stderr.write(f"TMPDIR={named}: is no folder; {tempfile.gettempdir()} is used\n")


def takes_files(folder: Path) -> bool:
    """Whether files can be written to a folder, or to where it would be made."""
    whole = folder.absolute()
    there = next(each for each in (whole, *whole.parents) if os.path.exists(each))  # noqa: PTH110 (never raises)
    try:
        with tempfile.TemporaryFile(dir=there) as file:
            file.write(bytes(_ROOM))
            file.flush()
    except OSError:
        return False
    return True


@contextmanager
def short_temporary_folder() -> Iterator[None]:
    """Have sockets made, while the block lasts, in a folder whose path leaves room for their names.

    Jobs go on to use the user's own temporary folder.

    Raises:
        ValueError: There is none.
    """
    before = tempfile.tempdir
    longest = LONGEST_SOCKET - _BELOW_TEMPORARY
    folders = (tempfile.gettempdir(), *_SHORT_FOLDERS)
    short = next((each for each in folders if len(os.fsencode(each)) <= longest and takes_files(Path(each))), None)
    if short is None:
        raise ValueError(
            f"TMPDIR={tempfile.gettempdir()}: too long for the path of a socket, or it cannot be written, and so are "
            f"{', '.join(_SHORT_FOLDERS)}: set TMPDIR to a folder of at most {longest} characters that can be written"
        )
    tempfile.tempdir = short
    try:
        yield
    finally:
        tempfile.tempdir = before
