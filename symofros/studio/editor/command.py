"""`symofros edit`: open the server on this machine, and a browser on it."""

from __future__ import annotations

import secrets
import socket
import webbrowser
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal

import uvicorn

import symofros
from symofros.description import YAML_SUFFIXES, resolved
from symofros.description.yaml import write_yaml
from symofros.expr import collect_rarely
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import FileError, Workspace
from symofros.studio.editor.server.app import application

HOST = "127.0.0.1"
# Of the 3-D view; the package comes with viser, and without it there is nothing to connect to.
SOCKETS: Literal["websockets-sansio", "none"] = "websockets-sansio" if find_spec("websockets") else "none"


def serve(
    file: Path | None,
    port: int,
    token: str | None,
    browser: bool,
    tell: Callable[[str], object],
    reading: Mapping[str, Any] | None = None,
) -> None:
    """Serve the editor until it is interrupted.

    Args:
        file: File to open, whose folder is the workspace; None: an empty document in the current folder.
        port: Port to listen at; 0: any that is free.
        token: Token that requests must carry; None: drawn at random.
        browser: Whether to open the page.
        tell: Receives the page's address once the server listens.
        reading: Arguments of `load` for a file of another format.

    Raises:
        FileError: The file can't be opened.
        DescriptionError: A file of another format can't be read.
        OSError: The port is taken.
    """
    session = _opened(file, reading or {})
    token = token or secrets.token_urlsafe(32)
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((HOST, port))
        port = listener.getsockname()[1]
        config = uvicorn.Config(
            application(session, token, port),
            log_level="warning",
            access_log=False,
            server_header=False,
            timeout_graceful_shutdown=1,
            lifespan="on",
            ws=SOCKETS,
            ws_per_message_deflate=False,
        )
        collect_rarely()
        server = _Server(config, lambda: _ready(f"http://{HOST}:{port}/?token={token}", browser, tell))
        server.run(sockets=[listener])


def _opened(file: Path | None, reading: Mapping[str, Any]) -> Session:
    """A native file as it stands; of another format, a new document that says the same."""
    if file is None:
        return Session(Workspace(Path.cwd()))
    path = resolved(file)
    if not path.parent.is_dir():
        raise FileError(f"'{file}' can't be opened", "no such folder", "its folder exists", "make it first")
    workspace = Workspace(path.parent)
    if path.suffix.lower() in YAML_SUFFIXES:
        return Session(workspace, path)
    text = write_yaml(symofros.load(path, **reading))
    session = Session(workspace)
    session.storage.adopt(path.name, text)
    return session


def _ready(url: str, browser: bool, tell: Callable[[str], object]) -> None:
    tell(url)
    if browser:
        webbrowser.open(url)


class _Server(uvicorn.Server):
    """One that says when it listens."""

    def __init__(self, config: uvicorn.Config, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self.ready = ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, then say so."""
        await super().startup(sockets)
        if not self.should_exit:
            self.ready()
