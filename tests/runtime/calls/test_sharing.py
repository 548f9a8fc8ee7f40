"""Batches in threads: the same bits, every row once, errors that arrive."""

from __future__ import annotations

import os
import threading

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.runtime.calls.sharing import LEAST, share


@pytest.mark.parametrize("n", [0, 1, 1023, 2048, 2049, 8000])
@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_every_row_is_processed_once(n: int, threads: int) -> None:
    seen, workers = np.zeros(n, dtype=int), set()

    def work(first: int, end: int) -> None:
        seen[first:end] += 1
        workers.add(threading.get_ident())

    share(n, threads, work)
    assert (seen == 1).all() and 1 <= len(workers) <= max(1, min(threads, n // LEAST))


def test_exceptions_in_threads_reach_the_caller() -> None:
    def work(first: int, end: int) -> None:
        raise ValueError(f"rows from {first}")

    with pytest.raises(ValueError, match="rows from"):
        share(8000, 4, work)
    share(8000, 4, lambda first, end: None)  # And leave the threads as they were.


@pytest.mark.parametrize("name", ["cart_pole", "space_arm", "four_bar"])
def test_threads_change_no_bit(name: str) -> None:
    m = sf.compile(MODELS[name])
    rng = np.random.default_rng(0)
    q, v = map(np.array, zip(*(m.random_state(rng) for _ in range(4099)), strict=True))
    u = rng.normal(size=(4099, m.nu))
    for function in (lambda m: m.dynamics(q, v, u), lambda m: (m.forward_dynamics(q, v, u),)):
        expected = function(m)
        for threads in (2, 3, 4):
            for found, wanted in zip(function(m.with_threads(threads)), expected, strict=True):
                assert np.array_equal(found, wanted, equal_nan=True)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork.*:DeprecationWarning")
def test_threads_work_after_a_fork() -> None:
    share(8000, 2, lambda first, end: None)
    child = os.fork()
    if child == 0:
        share(8000, 2, lambda first, end: None)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
