"""One simulation at a time: jobs wait for their turn, and one that nobody waits for any more is ended."""

from __future__ import annotations

import multiprocessing
from collections.abc import AsyncIterator
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

import anyio
from anyio.to_thread import run_sync

from evaluation.talk.robots import RobotName, TalkError
from evaluation.talk.worker import Event, Failed, Job, Progress, work

MOST_WAITING = 8
"""So many jobs wait; a further one is refused."""
PATIENCE = 0.3
"""Seconds after which a waiting job is told its place again."""


@dataclass(frozen=True)
class Waiting:
    """A job waits; so many are done before it."""

    ahead: int


class Queue:
    """Jobs in the order in which they came, done by one process.

    Args:
        results: The folder of results.
        weights: The file of the network's weights, where the study used one of its own.
        first: The robot that people meet first.
    """

    def __init__(self, results: Path, weights: Path | None, first: RobotName) -> None:
        self._given = results, weights, first
        self._line: list[object] = []
        self._worker: tuple[BaseProcess, Connection] | None = None

    @property
    def length(self) -> int:
        """How many jobs are done or wait."""
        return len(self._line)

    def start(self) -> None:
        """Start the process, unless it runs."""
        if self._worker is None or not self._worker[0].is_alive():
            self.stop()
            context = multiprocessing.get_context("spawn")
            ours, theirs = context.Pipe()
            process = context.Process(target=work, args=(theirs, *self._given), daemon=True)
            process.start()
            theirs.close()
            self._worker = process, ours

    def stop(self) -> None:
        """End the process, whatever it does."""
        if self._worker is not None:
            process, connection = self._worker
            process.kill()
            process.join()
            connection.close()
            self._worker = None

    async def run(self, job: Job) -> AsyncIterator[Event | Waiting]:
        """Do a job; whoever stops listening ends it.

        Yields:
            Its place in the queue, again and again until it begins, and then what comes of it.

        Raises:
            TalkError: Too many wait.
        """
        if len(self._line) > MOST_WAITING:
            raise TalkError(f"{len(self._line)} others wait for the simulation: try again in a moment")
        place = object()
        self._line.append(place)
        try:
            while self._line[0] is not place:
                yield Waiting(self._line.index(place))
                await anyio.sleep(PATIENCE)
            yield Waiting(0)
            async for event in self._done(job):
                yield event
        finally:
            self._line.remove(place)

    async def _done(self, job: Job) -> AsyncIterator[Event]:
        self.start()
        assert self._worker is not None
        connection, finished = self._worker[1], False
        try:
            await run_sync(connection.send, job)
            while not finished:
                event: Event = await run_sync(connection.recv, abandon_on_cancel=True)
                finished = not isinstance(event, Progress)
                yield event
        except (EOFError, OSError):
            yield Failed("the simulation broke off; try again")
        finally:
            if not finished:
                self.stop()
                self.start()
