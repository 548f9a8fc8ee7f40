"""Access to the server: by the page that it served itself, from this machine, with the token it was given."""

from __future__ import annotations

import hmac
import json
import re
from collections.abc import Iterable
from http import HTTPStatus
from urllib.parse import parse_qs

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from symofros.errors import Problem
from symofros.studio.editor.editing.data_edits import four_parts

# Four times the largest text: JSON escapes some of it.
MAX_BODY = 4 << 20
API = "/api/"
# viser's page and socket, pages that simulate: their token is in the address, and good for nothing else.
VIEW = "/view/"
# Only here may the token stand in the address: a browser's event source sends no headers of ours.
EVENTS = "/api/events"

# The token, and what it opens: viser's page and socket, or the page of a job.
_VIEWED = re.compile(r"([^/]*)(?:/|/page/[0-9]{1,9})?")
_LENGTH = re.compile(r"[0-9]{1,15}")
_READING = frozenset({"GET", "HEAD"})
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
        "font-src 'self'; connect-src 'self'; frame-src 'self'; worker-src 'self'; base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'self'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "SAMEORIGIN",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
}
# Somebody else's page: it is kept apart from ours (its origin is none), and talks to its socket only. It is one file of
# inline scripts that compiles parts of itself; so is a page that simulates.
_VIEW_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; "
    "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; worker-src data:; "
    "connect-src data: blob: {sockets}; base-uri 'none'; form-action 'none'; frame-ancestors {pages}"
)


class TooLargeError(Exception):
    """A request's body goes on beyond the limit."""


class Guard:
    """Wraps the application: refuses a wrong Host, Origin, token or size before anything is read or done.

    A web page elsewhere can make a browser send requests here, so being on this machine proves nothing; a rebound
    domain name shows in Host, a foreign page in Origin, and neither knows the token.
    """

    def __init__(self, app: ASGIApp, token: str, port: int, view_token: str, max_body: int = MAX_BODY) -> None:
        self.app, self.token, self.view_token, self.max_body = app, token, view_token, max_body
        self.hosts = frozenset(f"{name}:{port}" for name in ("127.0.0.1", "localhost"))
        self.origins = frozenset(f"http://{host}" for host in self.hosts)
        sockets = " ".join(f"ws://{host}/view/" for host in sorted(self.hosts))
        policy = _VIEW_POLICY.format(sockets=sockets, pages=" ".join(sorted(self.origins)))
        self._own = _encoded(HEADERS)
        self._view_own = _encoded({**HEADERS, "Content-Security-Policy": policy})

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """One request."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        refused = self.refusal(scope)
        if refused is not None and scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": ""})  # Answered with 403.
            return
        if refused is not None:
            await _answer(send, self._own, *refused)
            return
        if scope["type"] == "websocket":
            await self.app(scope, receive, send)
            return
        await self._pass(scope, receive, send)

    def refusal(self, scope: Scope) -> tuple[int, Problem] | None:
        """Why a request is refused by its head alone."""
        headers = _headers(scope["headers"])
        host = headers.get("host", [])
        if len(host) != 1 or host[0].lower() not in self.hosts:
            return 403, Problem(
                "the request names another host",
                ", ".join(host)[:100] or "none",
                "this server answers to 127.0.0.1 and localhost at its own port only",
                "open the address that `symofros edit` printed",
            )
        if scope["path"].startswith(VIEW) or scope["type"] == "websocket":
            return self._refusal_of_view(scope, headers)
        if not scope["path"].startswith(API):
            return None if scope["method"] in _READING else (405, _method(scope["method"]))
        foreign = self._foreign(headers)
        if foreign:
            return 403, _from_elsewhere(foreign)
        if not self._knows(headers, scope):
            return 401, _unknown_token()
        length = headers.get("content-length", ["0"])[0]
        if not _LENGTH.fullmatch(length) or int(length) > self.max_body:
            return 413, _too_large(self.max_body)
        if scope["method"] not in _READING | {"DELETE"}:
            kind = headers.get("content-type", [""])[0].partition(";")[0].strip().lower()
            if kind != "application/json":
                return 415, Problem(
                    "the body is not JSON", kind[:100] or "no type", "bodies are application/json", "set Content-Type"
                )
        return None

    def _refusal_of_view(self, scope: Scope, headers: dict[str, list[str]]) -> tuple[int, Problem] | None:
        """The same for pages that ours frames, and for the socket of viser's: of a page whose origin is none."""
        is_socket = scope["type"] == "websocket"
        if is_socket:
            allowed = self.origins | {"null"}
            foreign = [origin for origin in headers.get("origin", ["missing"]) if origin.lower() not in allowed]
        else:
            foreign = [origin for origin in (self._foreign(headers),) if origin]
        if foreign:
            return 403, _from_elsewhere(foreign[0])
        stated = _VIEWED.fullmatch(scope["path"].removeprefix(VIEW))
        given = stated[1] if stated is not None else ""
        if not (scope["path"].startswith(VIEW) and hmac.compare_digest(given.encode(), self.view_token.encode())):
            return 401, _unknown_token()
        return None if is_socket or scope["method"] in _READING else (405, _method(scope["method"]))

    def _foreign(self, headers: dict[str, list[str]]) -> str:
        """The page that a browser says the request comes from, if it is not ours."""
        wrong = [origin for origin in headers.get("origin", []) if origin.lower() not in self.origins]
        site = [site for site in headers.get("sec-fetch-site", []) if site not in ("same-origin", "none")]
        return (wrong + site + [""])[0]

    def _knows(self, headers: dict[str, list[str]], scope: Scope) -> bool:
        given = headers.get("authorization", [""])
        token = given[0].removeprefix("Bearer ") if given[0].startswith("Bearer ") else ""
        if not token and scope["path"] == EVENTS:
            token = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        return len(given) == 1 and hmac.compare_digest(token.encode(), self.token.encode())

    async def _pass(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Hand a request on; count its body as it comes, and put our headers on the answer."""
        taken, begun = 0, False

        async def counted() -> Message:
            nonlocal taken
            message = await receive()
            taken += len(message.get("body", b""))
            if taken > self.max_body:
                raise TooLargeError
            return message

        async def marked(message: Message) -> None:
            nonlocal begun
            if taken > self.max_body and not begun:
                return  # What the application makes of the error is not the answer.
            if message["type"] == "http.response.start":
                begun = True
                fresh = [(b"cache-control", b"no-store")] if scope["path"].startswith((API, VIEW)) else []
                own = self._view_own if scope["path"].startswith(VIEW) else self._own
                message["headers"] = [*message["headers"], *own, *fresh]
            await send(message)

        try:
            await self.app(scope, counted, marked)
        except TooLargeError:
            if not begun:
                await _answer(send, self._own, 413, _too_large(self.max_body))


def _encoded(headers: dict[str, str]) -> list[tuple[bytes, bytes]]:
    return [(name.lower().encode(), value.encode()) for name, value in headers.items()]


def _from_elsewhere(page: str) -> Problem:
    return Problem(
        "the request comes from another page",
        page[:100],
        "only the editor's own page may use this server",
        "open the address that `symofros edit` printed",
    )


def _unknown_token() -> Problem:
    return Problem(
        "the token is missing or wrong",
        "another token, or none",
        "every request carries the token of this run of the server",
        "open the address that `symofros edit` printed last",
    )


def _headers(raw: Iterable[tuple[bytes, bytes]]) -> dict[str, list[str]]:
    headers_by_name: dict[str, list[str]] = {}
    for name, value in raw:
        headers_by_name.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
    return headers_by_name


def _too_large(limit: int) -> Problem:
    return Problem(
        "the request is too large",
        f"more than {limit} bytes",
        "a text of 1 MiB fits in a request",
        "open a smaller file",
    )


def _method(method: str) -> Problem:
    return Problem("the page is only read", method[:20], "GET", "use the addresses under /api/")


def error_body(problem: Problem) -> dict[str, dict[str, str]]:
    """A problem as answers carry it."""
    return {"error": four_parts(problem)}


async def _answer(send: Send, own: list[tuple[bytes, bytes]], status: int, problem: Problem) -> None:
    body = json.dumps(error_body(problem)).encode()
    headers = [
        *own,
        (b"content-type", b"application/json"),
        (b"content-length", str(len(body)).encode()),
        (b"connection", b"close"),
    ]
    await send({"type": "http.response.start", "status": HTTPStatus(status), "headers": headers})
    await send({"type": "http.response.body", "body": body})
