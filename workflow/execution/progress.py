"""The line of progress of a run: jobs done, the stage, and about how long the rest takes.

A thread redraws it, so that the run looks alive during long jobs.
"""

from __future__ import annotations

import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from threading import Event, Lock, Thread
from typing import TextIO

from workflow.execution.job import CLEAR

EVERY = 30.0  # seconds between lines that cannot be redrawn in place
SILENCE = 5.0  # seconds after which what takes longer is named


class Progress:
    """Shows how far a run is: on a terminal one line that is redrawn in place, elsewhere a line now and then.

    Args:
        stream: Where to write.
        clock: Gives the time in seconds.
    """

    def __init__(self, stream: TextIO | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream = stream or sys.stderr
        self._clock = clock
        self._left: Counter[str] = Counter()
        self._done: Counter[str] = Counter()
        self._seconds: defaultdict[str, float] = defaultdict(float)
        self._began = self._told = self._latest = clock()
        self._stage = ""
        self._ended, self._lock = Event(), Lock()
        self._alive: Thread | None = None

    def begin(self, stages: Iterable[str]) -> None:
        """Begin a run.

        Args:
            stages: The stage of each job to be made.
        """
        self._left = Counter(stages)
        self._began = self._told = self._latest = self._clock()
        if self._left:
            if self._stream.isatty():
                self._write()
            self._alive = Thread(target=self._redraw, daemon=True)
            self._alive.start()

    def finished(self, stage: str, seconds: float) -> None:
        """Count a job that has succeeded.

        Args:
            stage: Its stage.
            seconds: How long it took.
        """
        with self._lock:
            self._stage, self._latest = stage, self._clock()
            self._left[stage] -= 1
            self._done[stage] += 1
            self._seconds[stage] += max(seconds, 1e-3)
            if not self._tell_if_due() and not self._left.total():
                self._write()

    def tick(self) -> None:
        """Let time pass in which no job ended."""
        with self._lock:
            if self._left.total():
                self._tell_if_due()

    @property
    def done(self) -> int:
        """The number of jobs that have succeeded."""
        return self._done.total()

    def end(self) -> None:
        """End the run, successful or not, and the line."""
        self._ended.set()
        if self._alive is not None:
            self._alive.join()
        if self._stream.isatty() and self._done.total() + self._left.total():
            self._stream.write("\n")
            self._stream.flush()

    def remaining(self) -> float | None:
        """The seconds left, if jobs take as long as others of their stage did; None while too little is known.

        Stages differ a hundredfold, so most remaining jobs must be of known stages. Between jobs the estimate counts
        down, and becomes None when it has reached zero.
        """
        means = {stage: self._seconds[stage] / count for stage, count in self._done.items()}
        known = sum(self._left[stage] for stage in means)
        if 2 * known < self._left.total():
            return None
        ahead = sum(self._left[stage] * mean for stage, mean in means.items()) * self._left.total() / max(known, 1)
        left = (self._latest - self._began) * ahead / sum(self._seconds.values()) - (self._clock() - self._latest)
        return left if left > 0 else None

    def _redraw(self) -> None:
        while not self._ended.wait(1.0):
            self.tick()

    def _tell_if_due(self) -> bool:
        now = self._clock()
        due = self._stream.isatty() or now - self._told >= EVERY
        if due:
            self._told = now
            self._write()
        return due

    def _write(self) -> None:
        stage = self._stage
        done, total = self._done.total(), self._done.total() + self._left.total()
        line = f"{done} of {total} jobs done ({done / total:.0%})"
        if stage:
            line += f", {stage} {self._done[stage]} of {self._done[stage] + self._left[stage]}"
        if done < total:
            seconds = self.remaining() if done else None
            passed = f", {span(self._clock() - self._began)} so far"
            line += passed if seconds is None else f", about {span(seconds)} left"
        else:
            line += f" in {span(self._clock() - self._began)}"
        self._stream.write(f"{CLEAR}{line}" if self._stream.isatty() else f"{line}\n")
        self._stream.flush()


@contextmanager
def working_at(
    what: str, stream: TextIO | None = None, silence: float = SILENCE, every: float = EVERY
) -> Iterator[None]:
    """Say what is being done while the block lasts, if it lasts long: on a terminal one line that goes away again.

    Args:
        what: In words, as in `comparing 30,000 files`.
        stream: Where to write.
        silence: Seconds before the first line.
        every: Seconds between further lines where they cannot be redrawn in place.
    """
    stream, began, ended = stream or sys.stderr, time.monotonic(), Event()

    def tell() -> None:
        pause = silence
        while not ended.wait(pause):
            line = f"{what}, {span(time.monotonic() - began)} so far"
            stream.write(f"{CLEAR}{line}" if stream.isatty() else f"{line}\n")
            stream.flush()
            pause = 1.0 if stream.isatty() else every
        if pause != silence and stream.isatty():
            stream.write(CLEAR)
            stream.flush()

    teller = Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield
    finally:
        ended.set()
        teller.join()


def span(seconds: float) -> str:
    """A duration in words."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
