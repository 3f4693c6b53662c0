"""The server without a browser: what is refused, whose turn it is, and what ends with a page."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Mapping
from pathlib import Path
from typing import Any

import anyio
import pytest
from starlette.types import Message

from evaluation.talk.guard import BURST, MOST_BYTES, Guard
from evaluation.talk.questions import RobotQuestion
from evaluation.talk.queue import MOST_WAITING, Queue, Waiting
from evaluation.talk.robots import RobotName, TalkError
from evaluation.talk.scenes import SceneName
from evaluation.talk.server import application
from evaluation.talk.streaming import Lines
from evaluation.talk.worker import Done, Draw, Event, Job

NAME = RobotName("simulator", "default", "proposed", "published", 6, 0, 1)
JOB = Draw(NAME, SceneName(1))


class NobodyToTalkTo:
    """A study of which nothing is asked."""

    def robots(self) -> dict[str, Any]:
        return {"robots": [], "first": 0}

    async def robot(self, question: RobotQuestion) -> dict[str, Any]:
        return {}


class InstantQueue(Queue):
    """A queue whose jobs are done by nobody: each lasts until it is let go."""

    def __init__(self) -> None:
        super().__init__(Path(), None, NAME)
        self.done: list[Job] = []
        self.ended: list[Job] = []
        self.go = anyio.Event()

    def start(self) -> None:
        """There is no process to start."""

    async def _done(self, job: Job) -> AsyncIterator[Event]:
        try:
            await self.go.wait()
            self.done.append(job)
            yield Done(0, "grasp", {})
        finally:
            self.ended.append(job)


def asked(method: str, path: str, body: bytes = b"", headers: Mapping[str, str] | None = None) -> tuple[int, Any]:
    """The status of an answer of the server, and its headers."""
    app = application(NobodyToTalkTo(), InstantQueue())
    given = {"host": "127.0.0.1:8321", "content-length": str(len(body))} | dict(headers or {})
    answers: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": body, "more_body": False}

    async def send(message: Message) -> None:
        answers.append(message)

    raw = [(key.encode(), value.encode()) for key, value in given.items()]
    scope = {"type": "http", "method": method, "path": path, "headers": raw, "query_string": b""}
    anyio.run(app, scope, receive, send)
    return answers[0]["status"], {key.decode(): value.decode() for key, value in answers[0]["headers"]}


@pytest.mark.parametrize("path", ["/", "/page.css", "/page.js", "/robots"])
def test_the_page_may_fetch_from_here_only(path: str) -> None:
    status, headers = asked("GET", path)
    assert status == 200
    policy = headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; script-src 'self'; style-src 'self'")
    assert "unsafe" not in policy
    assert "http" not in policy


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"host": "localhost:9"}, 200),
        ({"host": "evil.example"}, 400),
        ({"host": "127.0.0.1.evil.example:8321"}, 400),
        ({"host": ""}, 400),
        ({"origin": "http://127.0.0.1:8321"}, 200),
        ({"origin": "http://evil.example"}, 403),
        ({"origin": "null"}, 403),
        ({"content-length": str(MOST_BYTES + 1)}, 413),
        ({"content-length": "-1"}, 413),
        ({"transfer-encoding": "chunked"}, 411),
    ],
)
def test_only_this_machine_is_answered(headers: dict[str, str], status: int) -> None:
    assert asked("GET", "/robots", headers=headers)[0] == status


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"[]",
        b"nonsense",
        b'{"robot": "0"}',
        b'{"robot": -1}',
        b'{"robot": 0, "more": 1}',
        b'{"robot": 1e999}',
        b'{"robot": NaN}',
        b"[" * 5000,
    ],
)
def test_a_question_that_is_none_is_refused(body: bytes) -> None:
    assert asked("POST", "/robot", body)[0] == 400


def test_a_question_is_answered() -> None:
    assert asked("POST", "/robot", b'{"robot": 0}')[0] == 200


def test_other_paths_and_methods_are_not_there() -> None:
    assert asked("GET", "/../pyproject.toml")[0] == 404
    assert asked("GET", "/act")[0] == 405
    assert asked("POST", "/")[0] == 405


def test_too_many_requests_wait_a_second() -> None:
    answered: list[int] = []
    now = 0.0

    async def app(scope: Any, receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message: Message) -> None:
        if message["type"] == "http.response.start":
            answered.append(message["status"])

    async def ask(times: int) -> None:
        for _ in range(times):
            await guard({"type": "http", "headers": []}, None, send)

    guard = Guard(app, clock=lambda: now)
    anyio.run(ask, int(BURST) + 1)
    assert answered == [200] * int(BURST) + [429]
    now = 1.0
    anyio.run(ask, 1)
    assert answered[-1] == 200


def test_jobs_are_done_in_their_order_one_at_a_time() -> None:
    async def main() -> None:
        queue, told = InstantQueue(), {1: [], 2: [], 3: []}  # type: ignore[var-annotated]
        jobs = {n: Draw(NAME, SceneName(n)) for n in told}

        async def page(n: int) -> None:
            async for event in queue.run(jobs[n]):
                told[n].append(event)

        async with anyio.create_task_group() as group:
            for n in told:
                group.start_soon(page, n)
                await anyio.sleep(0.01)
            assert queue.length == 3
            assert [events[-1] for events in told.values()] == [Waiting(0), Waiting(1), Waiting(2)]
            queue.go.set()
        assert queue.done == list(jobs.values())
        assert [events[-1] for events in told.values()] == [Done(0, "grasp", {})] * 3
        assert queue.length == 0

    anyio.run(main)


def test_a_full_queue_refuses() -> None:
    async def main() -> None:
        queue = InstantQueue()

        async def page() -> None:
            async for _ in queue.run(JOB):
                pass

        async with anyio.create_task_group() as group:
            for _ in range(MOST_WAITING + 1):
                group.start_soon(page)
            await anyio.sleep(0.01)
            with pytest.raises(TalkError, match="9 others wait"):
                await anext(queue.run(JOB))
            queue.go.set()

    anyio.run(main)


@pytest.mark.parametrize("ahead", [0, 1])
def test_a_closed_page_ends_its_job_and_leaves_the_queue(ahead: int) -> None:
    """The page that closes is the one whose job is done, or one that waits."""

    async def main() -> None:
        queue = InstantQueue()
        closed, sent = anyio.Event(), []

        async def receive() -> Message:
            await closed.wait()
            return {"type": "http.disconnect"}

        async def send(message: Message) -> None:
            sent.append(message)

        async def lines(job: Job) -> AsyncIterator[dict[str, Any]]:
            async for event in queue.run(job):
                yield {"event": str(event)}

        async def other() -> None:
            async for _ in queue.run(JOB):
                pass

        mine = Draw(NAME, SceneName(2))
        async with anyio.create_task_group() as group:
            if ahead:
                group.start_soon(other)
                await anyio.sleep(0.01)
            group.start_soon(Lines(lines(mine)), {}, receive, send)
            await anyio.sleep(0.01)
            assert queue.length == 1 + ahead
            closed.set()
            await anyio.sleep(0.01)
            assert queue.length == ahead
            assert queue.ended == ([] if ahead else [mine])
            queue.go.set()
        assert queue.done == ([JOB] if ahead else [])
        assert len(sent) >= 2

    anyio.run(main)


def test_what_is_wrong_is_said_in_the_last_line() -> None:
    sent: list[Message] = []

    async def lines() -> AsyncIterator[dict[str, Any]]:
        yield {"one": 1}
        raise TalkError("there is no more")

    async def receive() -> Message:
        await anyio.sleep_forever()
        raise AssertionError

    async def send(message: Message) -> None:
        sent.append(message)

    anyio.run(Lines(lines()), {}, receive, send)
    told = b"".join(message.get("body", b"") for message in sent).splitlines()
    assert [json.loads(line) for line in told] == [{"one": 1}, {"error": "there is no more"}]
    assert sent[-1]["more_body"] is False
