"""Garbage collection of commands and servers."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from symofros.expr.garbage import collect_rarely


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
