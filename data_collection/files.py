"""Files that are either complete or not there."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path


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
