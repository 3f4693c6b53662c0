"""The smoke study on a real Slurm of one node, with a job cancelled on the way: few jobs, and the same bytes."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.cluster.slurm import CPUS, Slurm, missing, slurm
from tests.workflow.runs import SMOKE, command, hashes
from workflow.artifacts.provenance import ROOT
from workflow.execution.engine import planned

pytestmark = [pytest.mark.slow, pytest.mark.skipif(missing() != "", reason=missing())]

PATIENCE = 900.0  # seconds for a run, on a machine that does much else
# What the plugin would wait for between large jobs on a busy cluster; this one has no accounting either.
PLUGIN = ("--slurm-init-seconds-before-status-checks=2", "--slurm-status-command=squeue", "--latency-wait=10")
QUEUE = "%i|%T|%C|%m|%l|%M|%k"


@dataclass(frozen=True)
class Ran:
    """A study whose first run lost a job.

    Attributes:
        out: Its output folder.
        cancelled: What the first run printed, and its status.
        resumed: The same of the second.
        fits: How many fits the first run had ended with.
        jobs: Of Slurm, in the order of their submission: group, state, cores, memory, limit and time.
    """

    out: Path
    cancelled: tuple[str, int]
    resumed: tuple[str, int]
    fits: int
    jobs: list[list[str]]


def start(running: Slurm, out: Path) -> subprocess.Popen[str]:
    line = [*command(SMOKE, out), f"--cores={CPUS}", "--profile=slurm", "--", *PLUGIN]
    return subprocess.Popen(
        line, cwd=ROOT, env=running.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def ended(process: subprocess.Popen[str]) -> tuple[str, int]:
    """What a run printed, and its status."""
    printed, _ = process.communicate(timeout=PATIENCE)
    return printed, process.returncode


def queue(running: Slurm, *more: str) -> list[list[str]]:
    lines = running.call("squeue", "--noheader", "--sort=i", f"--format={QUEUE}", *more).splitlines()
    return [line.split("|") for line in lines]


def cancel_fits(running: Slurm, out: Path, process: subprocess.Popen[str]) -> None:
    """Cancel a job of Slurm that makes fits, in the midst of it."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until and process.poll() is None:
        fitting = [job[0] for job in queue(running, "--states=RUNNING") if "_fits_" in job[-1]]
        if fitting and any((out / ".artifacts" / "fits").rglob("*.json")):
            running.call("scancel", fitting[0])
            return
        time.sleep(0.2)
    raise AssertionError(f"no fit was made:\n{ended(process)[0]}")


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ran]:
    folder = tmp_path_factory.mktemp("slurm")
    out = folder / "out"
    with slurm(folder / "s") as running:
        processes = [start(running, out)]
        try:
            cancel_fits(running, out, processes[0])
            cancelled = ended(processes[0])
            fits = len(list((out / ".artifacts" / "fits").rglob("*.json")))
            processes.append(start(running, out))
            resumed = ended(processes[1])
        finally:
            for process in processes:
                with suppress(ProcessLookupError):
                    process.kill()
        yield Ran(out, cancelled, resumed, fits, queue(running, "--states=all"))


def test_a_cancelled_job_ends_the_run_with_a_message(ran: Ran) -> None:
    printed, status = ran.cancelled
    assert status == 1
    assert re.search(r"SLURM-job '\d+' failed, SLURM status is: 'CANCELLED'", printed), printed
    assert 0 < ran.fits < 10


def test_the_next_run_goes_on_and_has_the_bytes_of_a_local_run(ran: Ran, finished: Path) -> None:
    printed, status = ran.resumed
    assert status == 0, printed
    kept = re.search(r"artifacts of (\d+) jobs are kept", printed)
    assert kept is not None
    assert int(kept[1]) >= ran.fits + 14  # trials, percepts and features are 14 jobs
    assert hashes(ran.out) == hashes(finished)
    assert (ran.out / "manifest.json").read_bytes() == (finished / "manifest.json").read_bytes()


def test_jobs_are_grouped(ran: Ran, tmp_path: Path, record_property: Callable[[str, object], None]) -> None:
    count = len(planned(SMOKE, tmp_path))
    record_property("jobs of Slurm", f"{len(ran.jobs)} for {count} jobs of the study")
    for job in ran.jobs:
        record_property("job, state, cores, memory, limit, time, group", " ".join(job))
    assert [job[-1].split("_")[1] for job in ran.jobs] == ["data", "fits", "fits", "results"]
    assert [job[1] for job in ran.jobs] == ["COMPLETED", "CANCELLED", "COMPLETED", "COMPLETED"]
    assert count > 40
