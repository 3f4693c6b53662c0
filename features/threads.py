"""Numbers that do not hang on the number of threads."""

from contextlib import AbstractContextManager
from typing import Any


def one_thread() -> AbstractContextManager[Any]:
    """Give a block in which BLAS and OpenMP use one thread: the order of sums decides the last bits."""
    from threadpoolctl import threadpool_limits

    return threadpool_limits(1)  # type: ignore[no-any-return]
