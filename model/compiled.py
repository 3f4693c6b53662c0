"""Compilation by Numba: one decorator, and the folder in which machine code is kept between processes.

Numba notices a change of the file of a cached function, but not of the functions that it calls from other
files. The folder is therefore named by a digest of all compiled sources, of the versions and of the
processor: a folder never holds code of two kinds, even on a file system that different machines share.
"""

from __future__ import annotations

import fcntl
import hashlib
import logging
import os
import platform
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import ParamSpec, TypeVar

import numba
import numpy as np
from llvmlite import binding
from numba.core.caching import UserProvidedCacheLocator

from data_collection.user_folders import user_cache

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


class PackageLocator(UserProvidedCacheLocator):  # type: ignore[misc]
    """Where Numba keeps the machine code of a function of this package: by its place in the package.

    Numba's own locators name a folder by the path of the source, so that another clone, or the same one seen through
    a link, would compile the same code again.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """The folder of a source file, below the folder of the package; of other files as Numba has it."""
        folder, package = Path(py_file).absolute().parent, Path(__file__).absolute().parent
        if folder.is_relative_to(package):
            return folder.relative_to(package).as_posix()
        return str(super().get_suitable_cache_subpath(py_file))


def compiled(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Compile a function to machine code at its first call, or load it from `cache_folder`.

    No reordering of floating-point operations (`fastmath`) and no threads: the same input gives the same bytes.
    Every compiled function is called with arguments of one type each, C-contiguous arrays in particular, or with
    literals (Numba compiles for True and for False apart), in a fixed order: processes that start together can only
    write the same entries.
    """
    return _compile(function)


def _compile(function: Callable[_Arguments, _Result], **options: bool) -> Callable[_Arguments, _Result]:
    folder = cache_folder()
    before = numba.config.CACHE_DIR, numba.config.CACHE_LOCATOR_CLASSES
    # Numba reads these settings when it decorates; nobody else's functions are to move into this folder.
    numba.config.CACHE_DIR = "" if folder is None else str(folder)
    numba.config.CACHE_LOCATOR_CLASSES = f"{PackageLocator.__module__}.{PackageLocator.__name__}"
    try:
        dispatcher: Callable[_Arguments, _Result] = numba.njit(
            function, cache=folder is not None, error_model="numpy", **options
        )
    finally:
        numba.config.CACHE_DIR, numba.config.CACHE_LOCATOR_CLASSES = before
    return dispatcher


def lean(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """As `compiled`, for functions that make no arrays but get many, in named tuples.

    Numba counts references to every array of a tuple at every use, which takes longer than the arithmetic of a short
    function. Where no array is made or returned there is nothing to count; Numba refuses to compile what does.
    """
    return _compile(function, _nrt=False)


def inlined(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """As `lean`, and made part of its compiled callers: for the shortest functions, whose call costs more."""
    return _compile(function, _nrt=False, forceinline=True)


@lru_cache(maxsize=1)
def cache_folder() -> Path | None:
    """The folder of the compiled code, None where none can be written.

    The first that can be written of: the environment's `NUMBA_CACHE_DIR`; `__pycache__` of this package; the
    user's cache folder (`XDG_CACHE_HOME`, else `~/.cache`).
    """
    package = Path(__file__).parent
    named = os.environ.get("NUMBA_CACHE_DIR")
    user = user_cache()
    for base in [*([Path(named)] if named else []), package / "__pycache__", *([user] if user else [])]:
        folder = base / f"compiled-{_digest(package)}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    logging.getLogger(__name__).warning(
        "no folder for compiled code can be written, so every process compiles again: set NUMBA_CACHE_DIR"
    )
    return None


def compile_once(warm_up: Callable[[], None]) -> None:
    """Have everything compiled by one process, while those that start at the same time wait for it.

    Args:
        warm_up: Calls every compiled function that a fit needs. It runs if the folder has never seen it end.
    """
    folder = cache_folder()
    if folder is None or (folder / "complete").exists():
        return
    with (folder / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
        except OSError:  # A file system without locks: each process compiles for itself, to the same effect.
            logging.getLogger(__name__).info("%s cannot be locked", folder)
        if not (folder / "complete").exists():
            logging.getLogger(__name__).info("compiling the samplers for this machine, once")
            warm_up()
            (folder / "complete").touch()


def _digest(package: Path) -> str:
    """What machine code depends on, as 16 hexadecimal digits."""
    processor = binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()
    versions = numba.__version__, np.__version__, platform.python_version(), *processor
    digest = hashlib.sha256("\n".join(versions).encode())
    for source in sorted(package.rglob("*.py")):  # all of them: compiled code also builds what other modules define
        digest.update(source.relative_to(package).as_posix().encode() + source.read_bytes())
    return digest.hexdigest()[:16]
