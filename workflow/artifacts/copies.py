"""Copying and removing artifacts, which are files or folders."""

from __future__ import annotations

import os
import shutil
import stat
from pathlib import Path


def copy(source: Path, target: Path) -> None:
    """Copy a file, or a folder without its hidden files, to a path that does not exist yet."""
    if source.is_dir():
        target.mkdir()
        for path in sorted(source.rglob("*")):
            if path.is_file() and not path.name.startswith("."):
                (target / path.relative_to(source)).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, target / path.relative_to(source))
    else:
        shutil.copyfile(source, target)


def share(folder: Path) -> None:
    """Open a folder that `mkdtemp` made to whom the umask lets in; it stays with the group of a shared folder."""
    mask = os.umask(0)
    os.umask(mask)
    folder.chmod(folder.stat().st_mode & stat.S_ISGID | 0o777 & ~mask)


def temporary_name(path: Path) -> Path:
    """A name next to a path that the next run recognises as left over from a killed one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    return path.parent / f".{path.name}.{os.getpid()}.part"


def remove_any(path: Path, ignore_errors: bool = True) -> None:
    """Remove a file or folder if it exists; of a folder, errors may be ignored."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=ignore_errors)
    else:
        path.unlink(missing_ok=True)
