"""Events reach all listeners, and no listener delays another."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

import pytest

from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.server import events as events_module
from symofros.studio.editor.server.events import Events


async def next_of(stream: AsyncIterator[str]) -> str:
    return await asyncio.wait_for(anext(stream), 10)


def test_all_listeners_receive_events_in_order_from_any_thread() -> None:
    async def scene() -> None:
        events = Events()
        events.publish("lost", {})  # Nobody listens yet.
        first, second = events.join(), events.join()
        assert [await next_of(stream) for stream in (first, second)] == [": listening\n\n"] * 2
        await asyncio.to_thread(events.publish, "job", {"id": 1})
        events.publish("job", {"id": "a\nb"})
        for stream in (first, second):
            assert await next_of(stream) == 'event: job\ndata: {"id": 1}\n\n'
            assert await next_of(stream) == 'event: job\ndata: {"id": "a\\nb"}\n\n'

    asyncio.run(scene())


def test_slow_listeners_lose_the_oldest_events(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events_module, "MAX_WAITING", 2)

    async def scene() -> None:
        events = Events()
        stream = events.join()
        await next_of(stream)
        for i in range(5):
            events.publish("job", {"id": i})
        await asyncio.sleep(0)
        assert ["3" in await next_of(stream), "4" in await next_of(stream)] == [True, True]

    asyncio.run(scene())


def test_signs_of_life_and_who_leaves_makes_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events_module, "BEAT", 0.01)
    monkeypatch.setattr(events_module, "MAX_LISTENERS", 1)

    async def scene() -> None:
        events = Events()
        stream = events.join()
        assert await next_of(stream) == ": listening\n\n" and await next_of(stream) == ": still here\n\n"
        with pytest.raises(EditError, match="too many pages"):
            events.join()
        await stream.aclose()  # type: ignore[attr-defined]
        await next_of(events.join())

    asyncio.run(scene())
