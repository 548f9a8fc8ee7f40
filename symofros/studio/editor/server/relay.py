"""The viewer under the editor's own address: viser's page and its web socket, behind the same guard.

Its page, framed by ours, finds its socket beside its own address; viser's own port and token stay on this side.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from contextlib import suppress

import anyio
from anyio.to_thread import run_sync
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from symofros.studio.editor.server.document_viewer import DocumentViewer

MAX_SOCKETS = 20
GOING_AWAY, TRY_LATER = 1001, 1013


class Relay:
    """Relays messages between browsers and the viewer."""

    def __init__(self, view: DocumentViewer, token: str) -> None:
        self.view, self.token = view, token
        self._open = 0

    @property
    def address(self) -> str:
        """The path of the page in the iframe."""
        return f"/view/{self.token}/"

    def routes(self) -> list[Route | WebSocketRoute]:
        """The page, and the socket that it opens: its own address without the last slash."""
        return [Route(self.address, self.page), WebSocketRoute(self.address.rstrip("/"), self.socket)]

    async def page(self, _: Request) -> Response:
        """The page of viser."""
        page = await run_sync(self.view.page)
        if page is None:
            raise HTTPException(404, "nothing is shown")
        return Response(page, media_type="text/html", headers={"Content-Encoding": "gzip"})

    async def socket(self, browser: WebSocket) -> None:
        """One browser's connection, until either side ends it."""
        address = self.view.socket
        if address is None or self._open >= MAX_SOCKETS:
            await browser.close(TRY_LATER)
            return
        self._open += 1
        try:
            await _joined(browser, address)
        finally:
            self._open -= 1


async def _joined(browser: WebSocket, address: str) -> None:
    from websockets.asyncio.client import connect  # Comes with viser; the editor starts without either.
    from websockets.exceptions import WebSocketException  # As above.
    from websockets.typing import Subprotocol  # As above.

    offered = [Subprotocol(name) for name in browser.scope["subprotocols"]]
    try:
        async with connect(
            address, subprotocols=offered or None, compression=None, max_size=None, proxy=None
        ) as viewer:
            await browser.accept(viewer.subprotocol)

            async def outward() -> None:
                while (message := await browser.receive())["type"] != "websocket.disconnect":
                    data = message.get("bytes")
                    await viewer.send(message["text"] if data is None else data)

            async def inward() -> None:
                async for message in viewer:
                    await (browser.send_text(message) if isinstance(message, str) else browser.send_bytes(message))
                await browser.close(GOING_AWAY)

            async with anyio.create_task_group() as tasks:

                async def until_it_ends(hand_on: Callable[[], Awaitable[None]]) -> None:
                    with suppress(WebSocketException, WebSocketDisconnect, RuntimeError):
                        await hand_on()
                    tasks.cancel_scope.cancel()

                tasks.start_soon(until_it_ends, outward)
                tasks.start_soon(until_it_ends, inward)
    except (OSError, WebSocketException):
        with suppress(RuntimeError):  # It was accepted, and has gone.
            await browser.close(TRY_LATER)
