"""Slurm by Snakemake's plugin, mended in two places of the version that environment.lock names."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any


@contextmanager
def mended() -> Iterator[None]:
    """Mend the plugin for as long as the block lasts.

    A job of Slurm is Snakemake again. It is to run its group itself, as many jobs at a time as it has cores; the
    plugin would have it do one after the other, each by `srun` and a further Snakemake (issue 469 of the plugin). And
    of a group that failed, Snakemake does not show what the plugin knows of it.
    """
    from snakemake_executor_plugin_slurm import Executor

    arguments, print_error = Executor.additional_general_args, Executor.print_job_error

    def tell(executor: Any, job: Any, msg: str | None = None, aux_logs: Sequence[str] = (), **more: Any) -> None:
        logs = "".join(f"\n(more in {log})" for log in aux_logs if log)
        sys.stderr.write(f"{msg or 'a job of Slurm failed'}{logs}\n")
        print_error(executor, job, msg, aux_logs=list(aux_logs), **more)

    Executor.additional_general_args, Executor.print_job_error = lambda executor: "--executor local", tell
    try:
        yield
    finally:
        Executor.additional_general_args, Executor.print_job_error = arguments, print_error
