"""Artifacts of named arrays: npz without pickles, never half written, checked when read."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_collection.files import write_arrays
from features.size_limits import MAX_ARRAYS_BYTES, MAX_ARRAYS_RATIO, PLAIN_ARRAYS_BYTES


class ArtifactError(ValueError):
    """A stored artifact is missing, damaged or of another kind; the message names the file."""


def save_arrays(path: Path, kind: str, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write named arrays; the same arrays give the same bytes.

    Args:
        path: File to write.
        kind: What the arrays are together; checked when they are read.
        arrays: Numbers, booleans or text.
    """
    write_arrays(path, {"kind": np.array(kind), **arrays})


def load_arrays(
    path: Path, kind: str, names: tuple[str, ...], optional: tuple[str, ...] = ()
) -> dict[str, NDArray[Any]]:
    """Read the arrays `names`, and those of `optional` that are there, that `save_arrays` has written as `kind`.

    Raises:
        ArtifactError: The file is missing, damaged, of another kind, or holds other arrays.
    """
    if not path.is_file():
        raise ArtifactError(f"{path}: no such file of {kind}")
    try:
        _refuse_bombs(path)
        with np.load(path, allow_pickle=False) as stored:
            found = str(stored["kind"]) if "kind" in stored.files else ""
            wanted = [*names, *(name for name in optional if name in stored.files)]
            different = sorted({"kind", *wanted} ^ set(stored.files))
            # What is something else is not unpacked.
            arrays = {name: stored[name] for name in wanted} if found == kind and not different else {}
        if bare := [name for name, array in arrays.items() if not isinstance(array, np.ndarray)]:
            raise ValueError(f"{', '.join(bare)} hold no array")  # NumPy gives their bytes
    except Exception as error:  # damaged bytes surface as zip, zlib, memory, syntax, … errors
        raise ArtifactError(f"{path}: not a file of {kind}, truncated or damaged: {error}") from error
    if found != kind:
        raise ArtifactError(f"{path}: holds {found or 'something else'}; expected {kind}")
    if different:
        raise ArtifactError(f"{path}: {', '.join(different)} missing or unknown; expected {', '.join(names)}")
    return arrays


def _refuse_bombs(path: Path) -> None:
    """Refuse a file that would unpack to far more than it holds, by what it says of itself, before it is unpacked.

    Raises:
        ValueError: It is too large, larger than its size explains, or an array is larger than its part of the file.
    """
    packed = path.stat().st_size
    with zipfile.ZipFile(path) as archive:
        unpacked = sum(member.file_size for member in archive.infolist())
        if unpacked > min(MAX_ARRAYS_BYTES, max(PLAIN_ARRAYS_BYTES, MAX_ARRAYS_RATIO * packed)):
            raise ValueError(f"unpacks from {packed:,} to {unpacked:,} bytes, which no file of arrays does")
        for member in archive.infolist():
            with archive.open(member) as file:
                version = np.lib.format.read_magic(file)
                read = (
                    np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
                )
                shape, _, dtype = read(file)
            if math.prod(shape) * dtype.itemsize > member.file_size:
                raise ValueError(f"{member.filename} says that it is larger than it is")


def texts_to_array(texts: tuple[str | None, ...] | None, count: int) -> NDArray[np.str_]:
    """Return texts as an array, with an empty text for None."""
    return np.array([text or "" for text in texts or (None,) * count], dtype=np.str_)


def texts_from_array(array: NDArray[Any]) -> tuple[str | None, ...] | None:
    """Undo `texts_to_array`; None when no text is known."""
    texts = tuple(str(text) or None for text in array)
    return texts if any(texts) else None
