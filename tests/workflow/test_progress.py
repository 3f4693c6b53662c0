"""What a run says of its progress."""

from __future__ import annotations

import io
import json
import threading
import time
from pathlib import Path

import pytest

from workflow.execution.dag import Job
from workflow.execution.job import CLEAR, time_of
from workflow.execution.progress import Progress, span, working_at


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_in_a_pipe_a_line_comes_now_and_then_and_at_the_end() -> None:
    stream, clock = io.StringIO(), Clock()
    progress = Progress(stream, clock)
    progress.begin(["collect"] * 2 + ["fit"] * 6)
    for stage in ["collect"] * 2 + ["fit"] * 6:
        clock.now += 10.0
        progress.finished(stage, 10.0)
    progress.end()
    assert stream.getvalue().splitlines() == [
        "3 of 8 jobs done (38%), fit 1 of 6, about 50 s left",
        "6 of 8 jobs done (75%), fit 4 of 6, about 20 s left",
        "8 of 8 jobs done (100%), fit 6 of 6 in 80 s",
    ]


def test_on_a_terminal_the_line_is_redrawn_in_place() -> None:
    stream = Terminal()
    progress = Progress(stream, Clock())
    progress.begin(["fit", "fit"])
    progress.finished("fit", 1.0)
    progress.finished("fit", 1.0)
    progress.end()
    assert stream.getvalue().count("\r\033[K") == 3
    assert stream.getvalue().count("\n") == 1
    assert stream.getvalue().endswith("2 of 2 jobs done (100%), fit 2 of 2 in 0 s\n")


def test_the_rest_is_judged_by_what_jobs_of_its_stages_took() -> None:
    """Two jobs at a time, 40 s of jobs in 20 s; of the 4 jobs of the stage `tables` nothing is known yet."""
    clock = Clock()
    progress = Progress(io.StringIO(), clock)
    progress.begin(["collect"] * 3 + ["fit"] * 8 + ["tables"] * 4)
    clock.now += 20.0
    for stage, seconds in [("collect", 20.0)] + [("fit", 5.0)] * 4:
        progress.finished(stage, seconds)
    assert progress.remaining() == pytest.approx((2 * 20.0 + 4 * 5.0) / 2 * (10 / 6))


def test_nothing_is_said_of_the_rest_while_most_of_it_is_unknown() -> None:
    stream = Terminal()
    progress = Progress(stream, clock := Clock())
    progress.begin(["collect"] * 2 + ["fit"] * 8)
    clock.now += 20.0
    progress.finished("collect", 20.0)
    assert progress.remaining() is None
    assert stream.getvalue().endswith("1 of 10 jobs done (10%), collect 1 of 2, 20 s so far")
    progress.finished("fit", 0.2)
    assert progress.remaining() is not None


def test_while_a_long_job_runs_the_line_is_redrawn() -> None:
    stream, clock = io.StringIO(), Clock()
    progress = Progress(stream, clock)
    progress.begin(["fit"] * 3)
    for seconds in (40.0, 20.0, 9.0, 1.0, 15.0):
        clock.now += seconds
        if seconds == 40.0:
            progress.finished("fit", 40.0)
        else:
            progress.tick()
    assert stream.getvalue().splitlines() == [
        "1 of 3 jobs done (33%), fit 1 of 3, about 80 s left",
        "1 of 3 jobs done (33%), fit 1 of 3, about 50 s left",
    ]
    clock.now += 60.0
    progress.tick()
    assert stream.getvalue().splitlines()[-1] == "1 of 3 jobs done (33%), fit 1 of 3, 2 min so far"
    progress.end()


def test_a_thread_redraws_the_line_until_the_run_ends() -> None:
    clock, ticks = Clock(), threading.Event()

    class Watched(Progress):
        def tick(self) -> None:
            super().tick()
            ticks.set()

    progress = Watched(Terminal(), clock)
    progress.begin(["fit"])
    assert ticks.wait(30.0)
    progress.end()
    ticks.clear()
    assert not ticks.wait(1.5)


def test_a_run_without_jobs_says_nothing() -> None:
    stream = Terminal()
    progress = Progress(stream, Clock())
    progress.begin([])
    progress.end()
    assert stream.getvalue() == ""


@pytest.mark.parametrize(("seconds", "text"), [(4.4, "4 s"), (99, "99 s"), (100, "2 min"), (7000, "1 h 57 min")])
def test_times_in_words(seconds: float, text: str) -> None:
    assert span(seconds) == text


@pytest.mark.parametrize(
    ("log", "stage"),
    [("joblogs/fit/a_seed1.log", "fit"), ("joblogs/tables.log", "tables"), ("joblogs/a/b.c.log", "a")],
)
def test_the_stage_of_a_job(log: str, stage: str) -> None:
    assert Job("rule", {}, {}, {}, {}, log).stage == stage


def test_the_time_of_a_job_is_in_the_last_line_of_its_log(tmp_path: Path) -> None:
    took = {"start_up": 0.1, "processor": 0.5, "wall": 0.6}
    log = tmp_path / "fit.log"
    assert time_of(log) is None
    log.write_text(f"INFO a line\ntook {json.dumps(took)}\n", encoding="utf-8")
    assert time_of(log) == took
    log.write_text("took long\nnothing", encoding="utf-8")
    assert time_of(log) is None


def test_what_takes_long_is_named() -> None:
    stream = io.StringIO()
    with working_at("laying out the jobs", stream, silence=60):
        pass
    assert stream.getvalue() == ""
    with working_at("laying out the jobs", stream, silence=0.01, every=0.01):
        until = time.monotonic() + 10
        while stream.getvalue().count("\n") < 2 and time.monotonic() < until:
            time.sleep(0.01)
    assert set(stream.getvalue().splitlines()) == {"laying out the jobs, 0 s so far"}


def test_on_a_terminal_what_took_long_goes_away_again() -> None:
    stream = Terminal()
    with working_at("laying out the jobs", stream, silence=0.01):
        until = time.monotonic() + 10
        while not stream.getvalue() and time.monotonic() < until:
            time.sleep(0.01)
    assert stream.getvalue() == f"{CLEAR}laying out the jobs, 0 s so far{CLEAR}"
