"""Garbage collection of commands and servers, and while graphs grow."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from symofros.expr.garbage import collect_rarely, without_collection


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    thresholds = gc.get_threshold()
    yield
    gc.unfreeze()
    gc.set_threshold(*thresholds)


def test_collect_rarely_freezes_existing_objects_and_raises_the_threshold() -> None:
    gc.set_threshold(700, 10, 10)
    collect_rarely()
    assert gc.get_freeze_count() > 1000
    assert gc.get_threshold()[0] > 700


def test_no_cycles_are_looked_for_meanwhile_and_then_as_before() -> None:
    with without_collection():
        assert not gc.isenabled()
        with without_collection():
            pass
        assert not gc.isenabled(), "the outer one has not ended"
    assert gc.isenabled()
    with pytest.raises(ZeroDivisionError), without_collection():
        raise ZeroDivisionError
    assert gc.isenabled()
    gc.disable()
    try:
        with without_collection():
            pass
        assert not gc.isenabled(), "the caller's own choice stays"
    finally:
        gc.enable()
