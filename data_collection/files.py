"""Files that are either complete or not there."""

from __future__ import annotations

import io
import os
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def replacing(*paths: Path) -> Iterator[tuple[Path, ...]]:
    """Give temporary paths in the folders of `paths`, and rename them to `paths` if the block succeeds.

    Folders are made. When the block raises, nothing appears under the final names and the temporary files
    are removed.
    """
    with ExitStack() as cleanup:
        temporary = []
        for path in paths:
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
            os.close(handle)
            temporary.append(Path(name))
            cleanup.callback(Path(name).unlink, missing_ok=True)
        yield tuple(temporary)
        mask = os.umask(0)
        os.umask(mask)
        for name_, path in zip(temporary, paths, strict=True):
            name_.chmod(0o666 & ~mask)  # mkstemp makes private files; these are artifacts to share
            name_.replace(path)


def write_text(path: Path, text: str) -> None:
    """Write a file of text, which appears only when it is complete."""
    with replacing(path) as (temporary,):
        temporary.write_text(text, encoding="utf-8")


def write_arrays(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write named arrays, without pickles, as an npz file, which appears only when it is complete.

    The same arrays give the same bytes. NumPy's own function leaves the headers to the Python that runs it, whose
    patch versions differ in them.
    """
    import numpy as np

    with replacing(path) as (temporary,), zipfile.ZipFile(temporary, "w") as archive:
        for name, array in arrays.items():
            content = io.BytesIO()
            np.lib.format.write_array(content, np.asanyarray(array), allow_pickle=False)
            entry = zipfile.ZipInfo(f"{name}.npy")  # of 1 January 1980
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            archive.writestr(entry, content.getvalue(), zipfile.ZIP_DEFLATED, 6)
