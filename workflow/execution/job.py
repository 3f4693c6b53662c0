"""What every script does around its work: verify the inputs, write the log, record the outputs.

Output goes to the log, warnings and failures also to the screen. The last line of a log says what the job took.
"""

from __future__ import annotations

import json
import logging
import os
import resource
import sys
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from workflow.artifacts.records import FULL, DamagedError, record_path, records_of_job, verified_inputs, write_record
from workflow.execution.roles import by_role, paths
from workflow.execution.turns import turn_of_job

OUT = Path()  # Snakemake runs jobs in the output folder
CLEAR = "\r\033[K"  # clears the terminal's line that shows the progress
TOOK = "took "  # begins the last line of a job's log


@contextmanager
def job(snakemake: Any) -> Iterator[tuple[Any, Any]]:
    """Verify the inputs of a job, record its outputs, and send everything that it prints to its log.

    That includes the output of compiled code. Warnings also appear on the screen, and so do the message of a failure
    and the last lines of the log; the traceback is in the log only.

    Args:
        snakemake: What Snakemake gives to a script: rule, input, output, params, wildcards and log.

    Yields:
        The inputs and the outputs as paths, by the names that the rule gives them.

    Raises:
        SystemExit: The job failed, and the reason has been shown.
    """
    log = snakemake.log[0]
    began, start_up = time.perf_counter(), time.process_time()  # the latter counts from the start of the process
    sys.stdout.flush()
    sys.stderr.flush()
    screen = os.fdopen(os.dup(2), "w", errors="backslashreplace")
    clear = CLEAR if screen.isatty() else ""
    with Path(log).open("w") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, TextIOWrapper):  # a log has any word, whatever the terminal can show
                stream.reconfigure(encoding="utf-8", errors="backslashreplace")
        to_screen = logging.StreamHandler(screen)
        to_screen.setLevel(logging.WARNING)
        to_screen.setFormatter(logging.Formatter(f"{clear}%(levelname)s %(message)s"))
        to_log = logging.StreamHandler(sys.stderr)
        logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s", handlers=[to_log])
        logging.getLogger().addHandler(to_screen)
        logging.captureWarnings(capture=True)
        try:
            with turn_of_job(OUT), recorded(snakemake):
                yield paths(snakemake.input), paths(snakemake.output)
        except Exception as error:
            sys.stdout.flush()
            sys.stderr.flush()
            says = f"{type(error).__name__}: {error}{_where_full(error)}"
            print(f"{clear}{says}\n{last_lines(Path(log))}(more in {log})", file=screen, flush=True)
            with suppress(OSError):  # the log may be on a full disk
                traceback.print_exc()
            raise SystemExit(1) from None
        finally:
            with suppress(OSError):
                sys.stdout.write(time_line(start_up, time.perf_counter() - began))
                sys.stdout.flush()
                sys.stderr.flush()


def _where_full(error: Exception) -> str:
    """The full disk, if that is the error: the system's message does not name it."""
    if not isinstance(error, OSError) or error.errno not in FULL:
        return ""
    where = error.filename or OUT.resolve()
    return f"\nthe disk of {where} is full; make room and run again, which goes on from here"


def last_lines(log: Path, count: int = 5) -> str:
    """The last lines of a job's log, indented; empty if there is no log."""
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - 4096))
            end = file.read().decode("utf-8", errors="replace")
    except OSError:
        return ""
    return "".join(f"    {line}\n" for line in end.splitlines()[-count:])


def time_line(start_up: float, wall: float, before: Mapping[str, float] | None = None) -> str:
    """What this process has taken so far, as the last line of a log.

    Args:
        start_up: As in `time_of`.
        wall: As in `time_of`.
        before: What earlier processes took, which is added.
    """
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    took = {"start_up": start_up, "processor": time.process_time(), "wall": wall, "memory": memory}
    for name, value in (before or {}).items():
        took[name] = max(took[name], value) if name == "memory" else took[name] + value
    return f"{TOOK}{json.dumps({name: round(value, 3) for name, value in took.items()})}\n"


def time_of(log: Path) -> dict[str, float] | None:
    """What a job took, from the last line of its log; None if the log has no such line.

    In seconds, `wall` is the time since it began to verify its inputs, `processor` the CPU time of its process, and
    `start_up` the CPU time before that. `memory` is the peak of its process, in MiB.
    """
    try:
        line = log.read_text(encoding="utf-8", errors="replace").rstrip().rpartition("\n")[2]
        return dict(json.loads(line.removeprefix(TOOK))) if line.startswith(TOOK) else None
    except (OSError, ValueError):
        return None


@contextmanager
def recorded(snakemake: Any) -> Iterator[None]:
    """Verify the inputs of a job, and record its outputs once all are in place.

    Raises:
        DamagedError: An input does not match its record, or changed while the job read it.
    """
    outputs = by_role(snakemake.output)
    for path in outputs.values():
        record_path(OUT, path).unlink(missing_ok=True)  # of earlier outputs
    inputs = verified_inputs(OUT, by_role(snakemake.input))
    yield
    # External files have no record that would show a change.
    for role, each in verified_inputs(OUT, by_role(snakemake.input)).items():
        if each != inputs[role]:
            raise DamagedError(f"{each.path} changed while the job read it; run again")
    records = records_of_job(
        OUT, snakemake.rule, by_role(snakemake.wildcards), by_role(snakemake.params), inputs, outputs
    )
    for path, record in records.items():
        write_record(OUT, path, record)
