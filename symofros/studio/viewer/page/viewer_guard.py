"""Access to a viewer, and to its motion: by its address, with the token in it; from no page of another server.

viser answers anyone. A web page elsewhere can make a browser send requests to this machine: a rebound domain name shows
in Host, a foreign page in Origin, and neither knows the token.
"""

from __future__ import annotations

import gzip
import hmac
from collections.abc import Callable
from dataclasses import replace
from http import HTTPStatus
from importlib import import_module
from threading import Thread
from typing import Any
from urllib.parse import urlsplit

from symofros.errors import Problem
from symofros.studio.viewer.page.page_head import VISER_TITLE, page_head

LOOPBACK_NAMES = frozenset({"127.0.0.1", "localhost", "::1"})
# What asks for a page or a socket: a request of the package websockets, whose types viser brings.
Answerer = Callable[[Any, Any], Any]
_HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",  # The address has the token.
    "X-Content-Type-Options": "nosniff",
}


# Where the page says which colours its reader's system shows, and whether these are dark.
_COLOURS = {"/colours/dark": True, "/colours/light": False}
_ASK = '<script>fetch("colours/" + (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));</script>'


class ViewerGuard:
    """Refuses a wrong Host, Origin or token before viser sees the request.

    Args:
        host: Address that the server is bound to.
        token: First part of the path of every address.
        title: Title of the page.
        on_colours: Called, in a thread of its own, with whether the system of who opens the page first shows dark
            colours; nobody is asked without it.
        panel: Whether the page has a panel of controls.

    Attributes:
        is_asked: Whether the server asks it.
    """

    def __init__(
        self,
        host: str,
        token: str,
        title: str = "SYMOFROS",
        on_colours: Callable[[bool], None] | None = None,
        panel: bool = True,
    ) -> None:
        self.token, self.title, self._panel = token, title, panel
        self._on_colours, self._asks = on_colours, on_colours is not None
        # Bound to another address, the server is known by names that it can't tell itself.
        self._names = LOOPBACK_NAMES | {host.lower()} if is_loopback(host) else None
        self.is_asked = False

    def before(self, answer: Answerer | None) -> Answerer:
        """A handler that asks the guard, then forwards the request without its token."""
        self.is_asked = True

        def guarded(connection: Any, request: Any) -> Any:
            refused = self.refusal(request.path, request.headers.get_all("Host"), request.headers.get_all("Origin"))
            if refused is not None:
                return _response(*refused)
            path = request.path.partition("?")[0].removeprefix(f"/{self.token}") or "/"
            if path in _COLOURS:
                self._take_colours(_COLOURS[path])
                return _empty()
            response = answer(connection, replace(request, path=path)) if answer is not None else None
            if response is not None:
                head = page_head(self.title, self._panel) + (_ASK if self._asks else "")
                _put_head(response, head.encode())
                response.headers.update(_HEADERS)
            return response

        return guarded

    def _take_colours(self, dark: bool) -> None:
        """The first answer counts: all pages show the same colours."""
        take, self._on_colours = self._on_colours, None
        if take is not None:
            Thread(target=take, args=(dark,), daemon=True).start()

    def refusal(self, path: str, hosts: list[str], origins: list[str]) -> tuple[HTTPStatus, Problem] | None:
        """Why a request is refused by its head.

        Args:
            path: Path of the address, and its query.
            hosts: Values of the header Host.
            origins: Values of the header Origin: none where no page asks.
        """
        if len(hosts) != 1 or not self._is_own(hosts[0]):
            return HTTPStatus.FORBIDDEN, _problem(
                "the request names another host", ", ".join(hosts), "a viewer on this machine answers to its names only"
            )
        foreign = [origin for origin in origins if _authority(origin) != hosts[0].lower()]
        if foreign:
            rule = "only the viewer's own page may use its server"
            return HTTPStatus.FORBIDDEN, _problem("the request comes from another page", foreign[0], rule)
        given = path.partition("?")[0].split("/")[1:2]
        if not given or not hmac.compare_digest(given[0].encode(), self.token.encode()):
            rule = "the address begins with the token of this viewer"
            return HTTPStatus.UNAUTHORIZED, _problem("the token is missing or wrong", "another address", rule)
        return None

    def _is_own(self, host: str) -> bool:
        try:
            name = urlsplit(f"//{host}").hostname
        except ValueError:
            return False
        return name is not None and (self._names is None or name in self._names)


def _put_head(response: Any, head: bytes) -> None:
    """Put a title, and what follows it, in the place of viser's own title, if the response is its page."""
    is_packed = response.headers.get("Content-Encoding") == "gzip"
    if not response.body or "text/html" not in response.headers.get("Content-Type", ""):
        return
    page = gzip.decompress(response.body) if is_packed else response.body
    page = page.replace(VISER_TITLE.encode(), head, 1)
    response.body = gzip.compress(page, 6, mtime=0) if is_packed else page
    if "Content-Length" in response.headers:
        del response.headers["Content-Length"]
        response.headers["Content-Length"] = str(len(response.body))


def is_loopback(host: str) -> bool:
    """Whether an address is seen from this machine only."""
    return host in LOOPBACK_NAMES or host.startswith("127.")


def _authority(origin: str) -> str:
    """Host and port of an origin; "" where it is none, as of a page in a sandbox."""
    scheme, _, authority = origin.lower().partition("://")
    return authority if scheme in ("http", "https") else ""


def _problem(what: str, found: str, rule: str) -> Problem:
    return Problem(f"view: {what}", found[:100] or "none", rule, "open the address that the viewer printed: Viewer.url")


def _empty() -> Any:
    headers = import_module("websockets.datastructures").Headers({**_HEADERS, "Content-Length": "0"})
    return import_module("websockets.http11").Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, headers, b"")


def _response(status: HTTPStatus, problem: Problem) -> Any:
    body = f"{problem}\n".encode()
    headers = import_module("websockets.datastructures").Headers(
        {**_HEADERS, "Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))}
    )
    return import_module("websockets.http11").Response(status.value, status.phrase, headers, body)
