"""The page on which people talk to the robots of a study, served to this machine alone."""

from __future__ import annotations

import socket
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

import uvicorn
from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from evaluation.talk.guard import Guard
from evaluation.talk.questions import ActQuestion, HearQuestion, RobotQuestion, SceneQuestion
from evaluation.talk.queue import Queue
from evaluation.talk.robots import TalkError
from evaluation.talk.streaming import Lines
from evaluation.talk.study import TalkStudy

HOST = "127.0.0.1"
PAGE = Path(__file__).parent / "page"
FILES = {
    "/": ("page.html", "text/html"),
    "/page.css": ("page.css", "text/css"),
    "/page.js": ("page.js", "text/javascript"),
}


def application(study: TalkStudy, queue: Queue) -> Starlette:
    """The page and what it asks for.

    Args:
        study: Whose robots are talked to.
        queue: Where they act.
    """

    def static(file: str, kind: str) -> Callable[[Request], Awaitable[Response]]:
        async def answer(request: Request) -> Response:
            return Response((PAGE / file).read_bytes(), media_type=kind)

        return answer

    async def robots(request: Request) -> Response:
        return JSONResponse(study.robots())

    async def robot(request: Request) -> Response:
        return JSONResponse(await study.robot(RobotQuestion.model_validate_json(await request.body())))

    async def hear(request: Request) -> Response:
        return JSONResponse(await study.hear(HearQuestion.model_validate_json(await request.body())))

    async def scene(request: Request) -> Response:
        return Lines(study.scene(SceneQuestion.model_validate_json(await request.body()), queue))

    async def act(request: Request) -> Response:
        return Lines(study.act(ActQuestion.model_validate_json(await request.body()), queue))

    async def refused(request: Request, error: Exception) -> Response:
        reason = "what was asked is not as expected" if isinstance(error, ValidationError) else str(error)
        return JSONResponse({"error": reason}, 400)

    @asynccontextmanager
    async def running(app: Starlette) -> AsyncIterator[None]:
        queue.start()
        try:
            yield
        finally:
            queue.stop()

    asked = {"/robot": robot, "/hear": hear, "/scene": scene, "/act": act}
    routes = [Route(path, static(*file), methods=["GET"]) for path, file in FILES.items()]
    routes += [Route("/robots", robots, methods=["GET"])]
    routes += [Route(path, answer, methods=["POST"]) for path, answer in asked.items()]
    hosts = Middleware(TrustedHostMiddleware, allowed_hosts=[HOST, "localhost"], www_redirect=False)
    return Starlette(
        routes=routes,
        middleware=[Middleware(Guard), hosts],
        exception_handlers={ValueError: refused},
        lifespan=running,
    )


def serve(results: Path, port: int, weights: Path | None) -> int:
    """Serve the page until it is interrupted; 0.

    Args:
        results: Output folder of a finished study.
        port: Of 127.0.0.1; 0 takes any free one.
        weights: The file of the network's weights, where the study used one of its own.

    Raises:
        TalkError: The folder has no robots, or the port is taken.
    """
    study = TalkStudy(results, weights)
    with socket.socket() as listening:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((HOST, port))
        except OSError as error:
            raise TalkError(
                f"port {port} of {HOST} cannot be had ({error.strerror}): choose another, --port N"
            ) from error
        listening.listen()
        app = application(study, Queue(results, weights, study.names[study.first]))
        config = uvicorn.Config(
            app, log_level="warning", access_log=False, server_header=False, limit_concurrency=64,
            timeout_keep_alive=5, timeout_graceful_shutdown=1,
        )  # fmt: skip
        sys.stdout.write(f"http://{HOST}:{listening.getsockname()[1]}/  (Ctrl-C ends it)\n")
        sys.stdout.flush()
        with suppress(KeyboardInterrupt):  # it has ended as it was asked to
            uvicorn.Server(config).run(sockets=[listening])
    return 0
