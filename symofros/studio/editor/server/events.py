"""Notifications to every page that listens: server-sent events."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

from symofros.studio.editor.editing.data_edits import EditError

MAX_LISTENERS = 50
MAX_WAITING = 1000
BEAT = 15.0  # Seconds between signs of life; a listener that has gone is noticed by them.


def message(kind: str, data: dict[str, Any]) -> str:
    """An event as the stream carries it."""
    return f"event: {kind}\ndata: {json.dumps(data)}\n\n"


class Events:
    """The listeners, each with a queue of the events it has not been sent yet."""

    def __init__(self) -> None:
        self._listeners: set[asyncio.Queue[str]] = set()
        self._loop: asyncio.AbstractEventLoop | None = None

    def publish(self, kind: str, data: dict[str, Any]) -> None:
        """Tell everybody; from any thread."""
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._put, message(kind, data))

    def _put(self, said: str) -> None:
        for queue in list(self._listeners):
            if queue.full():  # Whoever does not listen misses the oldest.
                queue.get_nowait()
            queue.put_nowait(said)

    def join(self, *present: str) -> AsyncIterator[str]:
        """Listen from now on.

        Args:
            present: Messages that say how things stand, which come first.

        Raises:
            EditError: Too many do already.
        """
        if len(self._listeners) >= MAX_LISTENERS:
            raise EditError("too many pages listen", f"{MAX_LISTENERS}", f"at most {MAX_LISTENERS}", "close some tabs")
        self._loop = asyncio.get_running_loop()
        queue: asyncio.Queue[str] = asyncio.Queue(MAX_WAITING)
        self._listeners.add(queue)
        return self._sent(queue, present)

    async def _sent(self, queue: asyncio.Queue[str], present: tuple[str, ...]) -> AsyncIterator[str]:
        try:
            yield ": listening\n\n"
            for said in present:
                yield said
            while True:
                try:
                    yield await asyncio.wait_for(queue.get(), BEAT)
                except TimeoutError:
                    yield ": still here\n\n"
        finally:
            self._listeners.discard(queue)
