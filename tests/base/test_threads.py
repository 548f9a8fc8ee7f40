"""Work that threads share."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from symofros.base import threads
from symofros.base.threads import beside_each_other, ended_by, ending_together, submit


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


@pytest.mark.parametrize("nested", [False, True])
def test_waits_in_threads_end_with_the_work_that_an_interrupt_leaves(nested: bool) -> None:
    """Ctrl-C reaches the main thread alone; compilers in others were waited for, up to an hour."""
    waiting, ended = threading.Barrier(3, timeout=30.0), threading.Event()

    def wait(_: int = 0) -> bool:
        with ended_by(ended.set):
            waiting.wait()
            return ended.wait(30.0)

    def part() -> bool:
        if nested:
            beside_each_other(wait, [0, 1])
            return True
        return wait()

    with ThreadPoolExecutor(2) as pool, pytest.raises(KeyboardInterrupt), ending_together():
        parts = [submit(pool, part) for _ in range(1 if nested else 2)]
        waiting.wait()
        raise KeyboardInterrupt
    assert all(each.result() for each in parts) and ended.is_set()


def test_a_part_that_fails_ends_the_others_and_none_outside() -> None:
    apart, ends = threading.Event(), {1: threading.Event(), 2: threading.Event()}

    def work(item: int) -> None:
        if item == 0:
            raise KeyError(item)
        with ended_by(ends[item].set):
            assert ends[item].wait(30.0)

    with ending_together(), ended_by(apart.set):
        with pytest.raises(KeyError):
            beside_each_other(work, [0, 1, 2])
        assert not apart.is_set()
    with pytest.raises(KeyError), ending_together() as end:
        end()
        with ended_by(apart.set):  # It begins too late.
            raise KeyError
    assert apart.is_set()
