"""The addresses of the server, and what answers them."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path
from typing import Any

import anyio
from anyio.to_thread import run_sync
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from symofros.description.native.schema import json_schema
from symofros.description.native.yaml_nodes import YamlFault
from symofros.errors import Problem
from symofros.gui.document import StaleError
from symofros.gui.guard import Guard, error_body
from symofros.gui.plain import EditError
from symofros.gui.session import ConflictError, Json, Session
from symofros.gui.workspace import FileError

STATIC = Path(__file__).with_name("static")

Answer = Callable[[Request], Awaitable[Response]]


class Editor:
    """Answers requests, one at a time where they touch the document."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.turn = anyio.Lock()

    def routes(self) -> list[Route]:
        """Address by address."""
        session = self.session
        posts: dict[str, Callable[[Json], None]] = {
            "edit": session.edit, "text": session.set_text, "undo": session.undo, "redo": session.redo,
            "save": session.save, "discard": lambda _: session.discard(),
        }  # fmt: skip
        made = [Route(f"/api/{name}", self.changing(action), methods=["POST"]) for name, action in posts.items()]
        return [
            *made,
            Route("/api/schema", self.schema),
            Route("/api/document", self.document),
            Route("/api/layout", self.layout, methods=["POST"]),
        ]

    def changing(self, action: Callable[[Json], None]) -> Answer:
        """The answer to a request that changes the document: the document."""

        async def answer(request: Request) -> Response:
            return JSONResponse(await self.exclusively(partial(self._changed, action, await body_of(request))))

        return answer

    def _changed(self, action: Callable[[Json], None], body: Json) -> Json:
        action(body)
        return self.session.as_json()

    async def exclusively(self, work: Callable[[], Any]) -> Any:
        """Do work on the document in a thread of its own, while nobody else does."""
        async with self.turn:
            return await run_sync(work)

    async def schema(self, _: Request) -> Response:
        """The format."""
        return JSONResponse({"schema": json_schema()})

    async def document(self, _: Request) -> Response:
        """The document as it is."""
        return JSONResponse(await self.exclusively(self.session.as_json))

    async def layout(self, request: Request) -> Response:
        """Remember positions."""
        await self.exclusively(partial(self.session.place, await body_of(request)))
        return JSONResponse({})


async def body_of(request: Request) -> Json:
    """The JSON mapping that a request carries.

    Raises:
        EditError: It is not one.
    """
    data = await request.body()
    try:
        found = json.loads(data) if data else {}
    except (ValueError, RecursionError) as error:
        found = str(error)
    if not isinstance(found, dict):
        raise EditError(Problem("the body is not a JSON mapping", f"{found!r:.100}", "bodies are JSON mappings",
                                "reload the page"))  # fmt: skip
    return found


def application(session: Session, token: str, port: int) -> ASGIApp:
    """The server's application, guarded.

    Args:
        session: What it works on.
        token: What every request must carry.
        port: Where it listens: Host and Origin must name it.
    """
    editor = Editor(session)

    async def refused(_: Request, error: Exception) -> Response:
        assert isinstance(error, (EditError, FileError, YamlFault))
        return JSONResponse(error_body(error.problem), 422)

    async def stale(_: Request, error: Exception) -> Response:
        problem = Problem("the document has changed meanwhile", str(error), "an edit is of the document as it is",
                          "it is done again on the new one")  # fmt: skip
        return JSONResponse({**error_body(problem), "document": session.as_json()}, 409)

    async def conflict(_: Request, error: Exception) -> Response:
        assert isinstance(error, ConflictError)
        both = {"disk": error.disk, "over": error.over, "text": session.document.text}
        return JSONResponse({**error_body(error.problem), **both, "document": session.as_json()}, 409)

    handlers = {EditError: refused, FileError: refused, YamlFault: refused, StaleError: stale, ConflictError: conflict}
    pages = [Mount("/", StaticFiles(directory=STATIC, html=True))] if STATIC.is_dir() else []
    inner = Starlette(routes=[*editor.routes(), *pages], exception_handlers=handlers)  # type: ignore[arg-type]
    return Guard(inner, token, port)
