"""What keeps a page that is meant for this machine to this machine, and a busy page from keeping it busy."""

from __future__ import annotations

import time
from collections.abc import Callable

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MOST_BYTES = 8_192
"""Of what a request may send."""
RATE, BURST = 20.0, 60.0
"""So many requests in a second are answered for long, and so many at once."""

# Nothing is fetched but from here; nobody frames the page; no other page reads it.
HEADERS = {
    "content-security-policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "cross-origin-resource-policy": "same-origin",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cache-control": "no-store",
}


class Guard:
    """Refuses requests of other pages, too large ones and too many; and says in each answer what a browser may do.

    Args:
        app: What it guards.
        clock: Seconds.
    """

    def __init__(self, app: ASGIApp, clock: Callable[[], float] = time.monotonic) -> None:
        self._app, self._clock = app, clock
        self._left, self._since = BURST, clock()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or let it be answered."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        if refusal := self._refusal(Headers(scope=scope)):
            await refusal(scope, receive, with_headers)
            return
        await self._app(scope, receive, with_headers)

    def _refusal(self, headers: Headers) -> PlainTextResponse | None:
        now = self._clock()
        self._left, self._since = min(BURST, self._left + RATE * (now - self._since)), now
        if self._left < 1.0:
            return PlainTextResponse("too many requests: wait a second", 429)
        self._left -= 1.0
        origin = headers.get("origin")
        if origin is not None and origin != f"http://{headers.get('host')}":
            return PlainTextResponse("a request of another page", 403)
        if "transfer-encoding" in headers:
            return PlainTextResponse("the length of a request must be told", 411)
        length = headers.get("content-length", "0")
        if not length.isdecimal() or int(length) > MOST_BYTES:
            return PlainTextResponse(f"a request of {length} bytes (at most {MOST_BYTES:,} are read)", 413)
        return None
