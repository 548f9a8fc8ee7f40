"""The addresses of the server, and what answers them."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory
from typing import Any

import anyio
from anyio.to_thread import run_sync
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from symofros.description.yaml import YamlFault
from symofros.errors import Problem
from symofros.studio.editor.diagrams.native_code import ConsentError
from symofros.studio.editor.document.document import StaleError
from symofros.studio.editor.document.documentation import documented
from symofros.studio.editor.document.examples import listed
from symofros.studio.editor.document.figures.shape_curves import curves
from symofros.studio.editor.document.parts.palette import catalogue
from symofros.studio.editor.document.session import Json, Session
from symofros.studio.editor.document.storage import ConflictError
from symofros.studio.editor.document.workspace import FileError
from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.jobs.film import MEDIA_TYPES as FILM_TYPES
from symofros.studio.editor.jobs.film import film_of
from symofros.studio.editor.jobs.processes import Jobs
from symofros.studio.editor.jobs.run_table import MEDIA_TYPES, table_of
from symofros.studio.editor.server.document_viewer import DocumentViewer
from symofros.studio.editor.server.events import Events, message
from symofros.studio.editor.server.guard import Guard, error_body
from symofros.studio.editor.server.relay import Relay

IMPORT_SECONDS = 60.0
WATCH_SECONDS = 2.0
STATIC = Path(__file__).parents[1] / "static"

Answer = Callable[[Request], Awaitable[Response]]


class Editor:
    """Answers requests, one at a time where they touch the document."""

    def __init__(self, session: Session, view_token: str) -> None:
        self.session = session
        self.events = Events()
        self.view = DocumentViewer(self.events.publish)
        self.relay = Relay(self.view, view_token)
        self.jobs = Jobs(self.events.publish)
        self.turn = anyio.Lock()

    def routes(self) -> list[Route | WebSocketRoute]:
        """Address by address."""
        session = self.session
        changes: dict[str, Callable[[Json], None]] = {
            "edit": session.edit,
            "text": session.set_text,
            "undo": session.undo,
            "redo": session.redo,
            "save": session.save,
            "discard": session.discard,
            "reload": session.reload,
            "open": session.open,
            "new": session.create,
            "enter": session.enter,
            "leave": session.leave,
            "example": session.example,
            "group": session.group,
            "parts/insert": session.insert_part,
        }
        made = [Route(f"/api/{name}", self.changing(action), methods=["POST"]) for name, action in changes.items()]
        return [
            *made,
            Route("/api/schema", self.schema),
            Route("/api/document", self.document),
            Route("/api/layout", self.layout, methods=["POST"]),
            Route("/api/expression", self.expression, methods=["POST"]),
            Route("/api/shapes", self.shapes, methods=["POST"]),
            Route("/api/beam", self.beam, methods=["POST"]),
            Route("/api/inertia", self.inertia, methods=["POST"]),
            Route("/api/files", self.files),
            Route("/api/examples", self.examples),
            Route("/api/docs", self.docs),
            Route("/api/parts", self.parts),
            Route("/api/parts", self.keep_part, methods=["POST"]),
            Route("/api/import", self.import_text, methods=["POST"]),
            Route("/api/consent", self.consent, methods=["POST"]),
            Route("/api/jobs", self.start_job, methods=["POST"]),
            Route("/api/jobs/{key}", self.job),
            Route("/api/jobs/{key}/table.{suffix}", self.table),
            Route("/api/jobs/{key}/film.{suffix}", self.film),
            Route("/api/jobs/{key}", self.order_job, methods=["POST"]),
            Route("/api/jobs/{key}", self.cancel_job, methods=["DELETE"]),
            Route("/api/events", self.listen),
            Route("/api/view", self.look),
            Route("/api/pose", self.pose, methods=["POST"]),
            Route(f"{self.relay.address}page/{{key}}", self.page),
            *self.relay.routes(),
        ]

    def changing(self, action: Callable[[Json], None]) -> Answer:
        """The answer to a request that changes the document: the document. Other pages are notified."""

        async def answer(request: Request) -> Response:
            document = await self.exclusively(partial(self._changed, action, await body_of(request)))
            self.publish_document_change(request)
            return JSONResponse(document)

        return answer

    def _changed(self, action: Callable[[Json], None], body: Json) -> Json:
        action(body)
        return self.session.as_json()

    def publish_document_change(self, request: Request) -> None:
        """Publish to the pages that the document has changed, and by which client."""
        client = request.headers.get("x-client", "")[:100]
        self.events.publish("document", {**self._document_state(), "client": client})

    def _document_state(self) -> Json:
        return {"revision": self.session.document.revision, "name": self.session.document.file.name}

    async def exclusively(self, work: Callable[[], Any]) -> Any:
        """Run work on the document in another thread, while no other work on it runs."""
        async with self.turn:
            return await run_sync(work)

    async def schema(self, _: Request) -> Response:
        """The format and the palette."""
        return JSONResponse(await run_sync(catalogue))

    async def document(self, _: Request) -> Response:
        """The document as it is."""
        return JSONResponse(await self.exclusively(self.session.as_json))

    async def layout(self, request: Request) -> Response:
        """Store positions of blocks."""
        await self.exclusively(partial(self.session.place, await body_of(request)))
        return JSONResponse({"layout": self.session.storage.layout})

    async def expression(self, request: Request) -> Response:
        """Check fields, while others go on with the document: reading it with a field's text takes its time."""
        check = await self.exclusively(partial(self.session.field_checker, await body_of(request)))
        return JSONResponse(await run_sync(check))

    async def shapes(self, request: Request) -> Response:
        """Shape functions of a beam."""
        return JSONResponse(await run_sync(curves, await body_of(request)))

    async def beam(self, request: Request) -> Response:
        """Section and natural frequencies of a beam."""
        return JSONResponse(await self.exclusively(partial(self.session.beam_figures, await body_of(request))))

    async def inertia(self, request: Request) -> Response:
        """Mass, mass centre and moments of inertia of a rigid body."""
        return JSONResponse(await self.exclusively(partial(self.session.inertia_figures, await body_of(request))))

    async def files(self, _: Request) -> Response:
        """Files that can be opened."""
        workspace = self.session.workspace
        return JSONResponse({"root": str(workspace.root), "files": await run_sync(workspace.files)})

    async def examples(self, _: Request) -> Response:
        """Examples that a document can be begun from."""
        return JSONResponse({"examples": listed()})

    async def docs(self, request: Request) -> Response:
        """A page of the documentation, or a section of it."""
        return JSONResponse({"text": await run_sync(documented, request.query_params.get("page", ""))})

    async def parts(self, _: Request) -> Response:
        """Sub-assemblies that were kept."""
        return JSONResponse({"parts": await self.exclusively(self.session.library.listed)})

    async def keep_part(self, request: Request) -> Response:
        """Keep one more."""
        await self.exclusively(partial(self.session.keep_part, await body_of(request)))
        return await self.parts(request)

    async def import_text(self, request: Request) -> Response:
        """Begin a document from a description of another format: its text, or a file of the workspace."""
        body = await body_of(request)
        with TemporaryDirectory() as folder:
            file = self.session.to_import(body, Path(folder))
            job = await run_sync(partial(self.jobs.start, "import", {"file": str(file)}))
            if not await run_sync(job.over.wait, IMPORT_SECONDS):
                await run_sync(self.jobs.cancel, job.key)
        if job.error is not None or job.result is None:
            error = job.error or {
                "object": "the import took too long",
                "found": f"{IMPORT_SECONDS} s",
                "rule": "",
                "remedy": "import it with `sf.load` and `sf.save`",
            }
            return JSONResponse({"error": error}, 422)
        adopt = partial(self.session.adopt, name=file.name, text=job.result["text"])
        document = await self.exclusively(partial(self._changed, adopt, body))
        self.publish_document_change(request)
        return JSONResponse({**document, "notes": job.result["notes"]})

    async def consent(self, request: Request) -> Response:
        """Take the user's consent to run native code."""
        await self.exclusively(partial(self.session.consent, await body_of(request)))
        return JSONResponse({})

    async def start_job(self, request: Request) -> Response:
        """Start work on the document as it is now."""
        body = await body_of(request)
        # Its revision at once: others may change the document as soon as this has its turn no more.
        asked = await self.exclusively(partial(self.session.job_request, body))
        job = await run_sync(partial(self.jobs.start, *asked))
        return JSONResponse({"id": job.key}, 202)

    async def job(self, request: Request) -> Response:
        """State, progress and result of a job as JSON; for a simulated page, the result is its address and notes."""
        job = self.jobs.get(request.path_params["key"])
        stated = job.as_json()
        if job.kind == "page" and job.result is not None:
            stated["result"] = {"address": f"{self.relay.address}page/{job.key}", "notes": job.result["notes"]}
        return JSONResponse(stated)

    async def page(self, request: Request) -> Response:
        """A page that simulates by itself: kept apart from ours as that of the 3-D view is."""
        job = self.jobs.get(request.path_params["key"])
        if job.kind != "page" or job.result is None:
            raise HTTPException(404, "no page that simulates")
        return Response(job.result["page"], media_type="text/html")

    async def order_job(self, request: Request) -> Response:
        """Pause a job, continue it, or end it with its present results."""
        order = (await body_of(request)).get("order")
        return JSONResponse((await run_sync(self.jobs.order, request.path_params["key"], order)).as_json(whole=False))

    async def cancel_job(self, request: Request) -> Response:
        """Stop a job."""
        return JSONResponse((await run_sync(self.jobs.cancel, request.path_params["key"])).as_json())

    async def listen(self, _: Request) -> Response:
        """Tell whatever happens, as it happens; to a page, whose first job shall not wait for a worker's imports.

        The document may have changed since the page asked for it, and what an earlier page has started may run.
        """
        await run_sync(self.jobs.warm)
        running = [message("job", job.as_json(whole=False)) for job in self.jobs.running()]
        stream = self.events.join(message("document", self._document_state()), *running)
        return StreamingResponse(stream, media_type="text/event-stream")

    async def look(self, request: Request) -> Response:
        """The 3-D view of the present document, created or updated: its address and its sliders.

        Of a diagram, the mechanism that "block" moves.
        """
        block = request.query_params.get("block", "")
        system = await self.exclusively(partial(self.session.shown_system, block))
        # Compiling takes its time, while others go on with the document.
        shown = await run_sync(partial(self.view.follow, system))
        return JSONResponse({"address": self.relay.address, **shown})

    async def pose(self, request: Request) -> Response:
        """Move the 3-D view; with "run" and "t", to the state of a run at a time, of a diagram's "block"."""
        body = await body_of(request)
        if "run" in body:
            run = self.jobs.get(str(body["run"])).motion(str(body.get("block") or ""))
            return JSONResponse(await run_sync(partial(self.view.seek, run, body.get("t"))))
        return JSONResponse(await run_sync(partial(self.view.pose, body)))

    async def table(self, request: Request) -> Response:
        """A run's columns over time as a file: CSV or Parquet."""
        job = self.jobs.get(request.path_params["key"])
        suffix = request.path_params["suffix"]
        content = await run_sync(partial(table_of, job.kind, job.result, suffix))
        return Response(content, media_type=MEDIA_TYPES[suffix])

    async def film(self, request: Request) -> Response:
        """A motion as a film."""
        job, suffix, asked = (
            self.jobs.get(request.path_params["key"]),
            request.path_params["suffix"],
            request.query_params,
        )
        block = asked.get("block", "")
        result = job.motion(block)
        system = await self.exclusively(
            lambda: self.session.shown_system(block) if job.revision == self.session.document.revision else None
        )
        factor, speed = asked.get("exaggeration", "1"), asked.get("speed", "1")
        content = await run_sync(partial(film_of, system, result, suffix, factor, speed))
        return Response(content, media_type=FILM_TYPES[suffix])

    async def watch(self) -> None:
        """Publish a change of the file by another process, once until it is resolved."""
        notified = False
        while True:
            await anyio.sleep(WATCH_SECONDS)
            changed = await self.exclusively(self.session.storage.changed_on_disk)
            if changed and not notified:
                self.events.publish("disk", {"name": self.session.document.file.name})
            notified = changed


async def body_of(request: Request) -> Json:
    """The JSON mapping in the body of a request.

    Raises:
        EditError: It is not one.
    """
    data = await request.body()
    try:
        body = json.loads(data) if data else {}
    except (ValueError, RecursionError) as error:
        body = str(error)
    if not isinstance(body, dict):
        raise EditError(
            "the body is not a JSON mapping", f"{body!r:.100}", "bodies are JSON mappings", "reload the page"
        )
    return body


def application(session: Session, token: str, port: int) -> ASGIApp:
    """The server's application, guarded.

    Args:
        session: Session that requests act on.
        token: Token that every request must carry.
        port: Port that it listens at: Host and Origin must name it.
    """
    view_token = token_urlsafe(32)
    editor = Editor(session, view_token)

    async def refused(_: Request, error: Exception) -> Response:
        assert isinstance(error, (EditError, FileError, YamlFault))
        return JSONResponse(error_body(error.problem), 422)

    async def unasked(_: Request, error: Exception) -> Response:
        assert isinstance(error, ConsentError)
        return JSONResponse({**error_body(error.problem), "native": error.files}, 428)

    async def stale(_: Request, error: Exception) -> Response:
        problem = Problem(
            "the document has changed meanwhile",
            str(error),
            "an edit is of the document as it is",
            "it is done again on the new one",
        )
        return JSONResponse({**error_body(problem), "document": session.as_json()}, 409)

    async def conflict(_: Request, error: Exception) -> Response:
        assert isinstance(error, ConflictError)
        both = {"disk": error.disk, "over": error.over, "text": session.document.text}
        return JSONResponse({**error_body(error.problem), **both, "document": session.as_json()}, 409)

    async def not_found(_: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        problem = Problem("no such address", str(error.detail), "addresses are those of the page", "reload the page")
        return JSONResponse(error_body(problem), error.status_code)

    async def unforeseen(_: Request, error: Exception) -> Response:
        problem = Problem(
            "the server met a fault of its own",
            type(error).__name__,
            "this should not happen",
            "please report it, with what the terminal shows; the document is as it was",
        )
        return JSONResponse(error_body(problem), 500)

    handlers: dict[Any, Any] = {
        HTTPException: not_found,
        Exception: unforeseen,
        ConsentError: unasked,
        EditError: refused,
        FileError: refused,
        YamlFault: refused,
        StaleError: stale,
        ConflictError: conflict,
    }
    pages = [Mount("/", StaticFiles(directory=STATIC, html=True))] if STATIC.is_dir() else []

    @asynccontextmanager
    async def running(_: Starlette) -> AsyncIterator[None]:
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(editor.watch)
            yield
            tasks.cancel_scope.cancel()
        await run_sync(editor.view.close)
        await run_sync(editor.jobs.close)

    inner = Starlette(routes=[*editor.routes(), *pages], exception_handlers=handlers, lifespan=running)
    return Guard(inner, token, port, view_token)
