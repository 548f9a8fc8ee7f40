"""One process, many models, several threads: C runs without the interpreter lock, parameters belong to the call."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.chain import chain


@pytest.mark.slow
def test_many_models_in_threads_give_the_results_of_one_thread() -> None:
    models = [sf.compile(chain(n)) for n in range(1, 6)]
    states = [model.random_state(np.random.default_rng(i)) for i, model in enumerate(models)]

    def work(i: int) -> np.ndarray:
        model, (q, v) = models[i % 5], states[i % 5]
        return model.bias(np.repeat(q[np.newaxis], 2000, axis=0), v)

    alone = [work(i) for i in range(5)]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(work, range(40)))
    assert all(np.array_equal(found, alone[i % 5]) for i, found in enumerate(together))


def test_the_lock_is_free_while_c_runs() -> None:
    """Python counts on while one call of C takes its time."""
    model = sf.compile(chain(7))
    q = np.zeros((400_000, model.nq))
    model.mass_matrix(q[:1000])  # As many as are evaluated by vectors, whose compilation frees the lock, too.
    began, counted = threading.Event(), 0

    def work() -> None:
        began.set()
        model.mass_matrix(q)

    thread = threading.Thread(target=work)
    thread.start()
    began.wait()
    while thread.is_alive():
        counted += 1
    # With the lock held throughout, the loop would turn a few times at the ends only.
    assert counted > 1000
