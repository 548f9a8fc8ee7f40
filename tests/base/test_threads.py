"""Work that threads share."""

from __future__ import annotations

import threading

import pytest

from symofros.base import threads
from symofros.base.threads import beside_each_other


def test_items_are_worked_on_at_the_same_time() -> None:
    everybody, done = threading.Barrier(3, timeout=30.0), []

    def work(item: str) -> None:
        everybody.wait()
        done.append(item)

    beside_each_other(work, ["a", "b", "c"])
    assert sorted(done) == ["a", "b", "c"]
    beside_each_other(work, [])


def test_without_threads_items_follow_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "try_to_start", lambda thread: False)
    done: list[str] = []
    beside_each_other(done.append, ["a", "b", "c"])
    assert done == ["a", "b", "c"]


def test_an_exception_is_raised_after_all_threads_have_ended() -> None:
    done: list[int] = []

    def work(item: int) -> None:
        if item == 1:
            raise KeyError(item)
        done.append(item)

    with pytest.raises(KeyError):
        beside_each_other(work, [0, 1, 2])
    assert sorted(done) == [0, 2]
