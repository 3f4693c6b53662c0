"""Answers that come line by line, each a JSON object, and that end when nobody listens any more."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Mapping
from contextlib import aclosing
from typing import Any

import anyio
from starlette.responses import Response
from starlette.types import Receive, Scope, Send


class Lines(Response):
    """A response of lines; when the page is closed, what makes them is cancelled at once.

    Args:
        lines: What is sent. A ValueError in it becomes a last line, `{"error": …}`.
    """

    media_type = "application/x-ndjson"

    def __init__(self, lines: AsyncIterator[Mapping[str, Any]]) -> None:
        super().__init__()
        self._lines = lines
        del self.headers["content-length"]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the lines until they end or the page is closed."""
        await send({"type": "http.response.start", "status": 200, "headers": self.raw_headers})

        async def say(line: Mapping[str, Any]) -> None:
            body = json.dumps(line, ensure_ascii=False).encode() + b"\n"
            await send({"type": "http.response.body", "body": body, "more_body": True})

        async with anyio.create_task_group() as group:

            async def until_closed() -> None:
                while (await receive())["type"] != "http.disconnect":
                    pass
                group.cancel_scope.cancel()

            group.start_soon(until_closed)
            try:
                async with aclosing(self._lines) as lines:  # type: ignore[type-var]
                    async for line in lines:
                        await say(line)
            except ValueError as error:
                await say({"error": str(error)})
            await send({"type": "http.response.body", "body": b"", "more_body": False})
            group.cancel_scope.cancel()
