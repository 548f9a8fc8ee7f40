"""viser, loaded when it is needed and kept quiet: the web server that shows scenes in browsers."""

from __future__ import annotations

import logging
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from symofros.errors import SymofrosError
from symofros.studio.viewer.page.viewer_guard import ViewerGuard

_STARTING = threading.Lock()
LOOPBACK = "127.0.0.1"
PORT = 8080


def load_viser() -> Any:
    """The package viser.

    Raises:
        SymofrosError: It is not installed.
    """
    try:
        return import_module("viser")
    except ImportError:
        raise SymofrosError.of_extra(
            "view: viser is not installed", "no module viser", "the viewer is an extra", "view"
        ) from None


def start_server(
    host: str,
    port: int,
    token: str,
    title: str = "SYMOFROS",
    on_colours: Callable[[bool], None] | None = None,
    panel: bool = True,
) -> Any:
    """A viser server that serves, to whoever knows the token.

    Args:
        host: Address to bind to; LOOPBACK is seen from this machine only.
        port: 0 for any free one. One that is taken is an error: browsers would be sent to what else is there.
        token: First part of the path of its page and of its socket.
        title: Title of the page, which its tab shows.
        on_colours: Called with whether the system of who opens the page first shows dark colours.
        panel: Whether the page has a panel of controls.

    Raises:
        SymofrosError: viser is not installed, or the address can't be bound to.
    """
    viser = load_viser()
    if not 0 <= port <= 65535:
        _refuse(host, port, "no such port", "a port is a whole number, 0 to 65535")
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((host, port))
        except OSError as error:
            _refuse(host, port, error.strerror or str(error), "the address is one of this machine's, the port is free")
    # It logs every connection that ends before its handshake, such as a browser's spare ones.
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)
    guard = ViewerGuard(host, token, title, on_colours, panel)
    with _quiet(), _guarded(guard):
        server = viser.ViserServer(host=host, port=port, verbose=False)
    if not guard.is_asked:
        stop_server(server)
        what, rule = "view: viser can't be guarded", "its server asks before it answers, by `websockets`"
        raise SymofrosError.of_extra(what, f"viser {viser.__version__}", rule, "view")
    return server


def stop_server(server: Any) -> None:
    """Stop it, and wait for its thread."""
    with _quiet():
        server.stop()


def _refuse(host: str, port: int, found: str, rule: str) -> None:
    raise SymofrosError(
        f"view: can't serve at {host}:{port}", found, rule, "choose another port, or 0 for any that is free"
    )


@contextmanager
def _guarded(guard: ViewerGuard) -> Iterator[None]:
    """Have the server that viser starts meanwhile ask a guard first: viser leaves no other place for one."""
    serving: Any = import_module("websockets.asyncio.server")
    with _STARTING:
        serve = serving.serve

        def serve_guarded(*given: Any, process_request: Any = None, **named: Any) -> Any:
            return serve(*given, process_request=guard.before(process_request), **named)

        serving.serve = serve_guarded
        try:
            yield
        finally:
            serving.serve = serve


@contextmanager
def _quiet() -> Iterator[None]:
    """Viser announces itself through rich's console whatever it is asked; that console is silent meanwhile."""
    console = import_module("rich").get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
