"""Locks: one run at a time in an output folder, and none alongside the jobs of a killed run."""

from __future__ import annotations

import fcntl
import os
import secrets
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

RUNNING, JOBS = ".running", ".jobs"  # locked by a run, and by its jobs
TURN = "STUDY_RUN"  # the environment variable with the run that a job belongs to


@contextmanager
def turn_of_run(out: Path) -> Iterator[bool]:
    """Lock an output folder while the block lasts and this process lives; yields whether it was free.

    Waits for jobs that outlived a killed run; what they make is kept.
    """
    with (out / RUNNING).open("a") as running, (out / JOBS).open("a") as jobs:
        try:
            fcntl.flock(running, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
            return
        except OSError as error:  # not every shared file system has locks
            sys.stderr.write(f"{out}: cannot be locked ({error.strerror}); run one study at a time in this folder\n")
        os.environ[TURN] = secrets.token_hex(8)
        (out / RUNNING).write_text(os.environ[TURN])  # jobs of earlier runs that begin from now on see it and end
        try:
            fcntl.flock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            sys.stderr.write(f"{out}: waiting for the last jobs of a run that was killed\n")
            fcntl.flock(jobs, fcntl.LOCK_EX)
        except OSError:
            pass  # without locks, as above
        with suppress(OSError):
            fcntl.flock(jobs, fcntl.LOCK_UN)
        try:
            yield True
        finally:
            del os.environ[TURN]


@contextmanager
def turn_of_job(out: Path) -> Iterator[None]:
    """Keep new runs out of an output folder while the block lasts.

    Raises:
        SystemExit: Another run than this job's has begun.
    """
    with (out / JOBS).open("a") as jobs:
        with suppress(OSError):  # not every shared file system has locks
            fcntl.flock(jobs, fcntl.LOCK_SH)
        if TURN in os.environ and (out / RUNNING).read_text() != os.environ[TURN]:
            raise SystemExit("another run has begun in this folder")
        yield
