"""Plain calls from Python, timed in the process of a worker."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import median

import numpy as np

import symofros as sf

from .race import pin_to_one_cpu

STATES = 4096
REPEATS, CALLS = 24, 2000


def times(path: str, floating: bool) -> dict[str, float]:
    """Median seconds of each call on one processor, all in turns; of batches those of a state.

    Args:
        path: URDF file.
        floating: Whether nothing holds its root.
    """
    pin_to_one_cpu()
    model = sf.compile(sf.load(path, floating_base=floating))
    rng = np.random.default_rng(0)
    q = model.neutral()
    Q = np.array([model.integrate(q, rng.uniform(-1.0, 1.0, model.nv)) for _ in range(STATES)])
    V = rng.standard_normal((STATES, model.nv))
    M, h = model.bind("mass_matrix", n=STATES), model.bind("bias", n=STATES)
    for bound in (M, h):
        for name, values in (("q", Q), ("v", V)):
            if name in bound.inputs:
                bound.inputs[name][:] = values

    def plain() -> None:
        model.mass_matrix(Q)
        model.bias(Q, V)

    def kernel() -> None:
        M()
        h()

    calls: dict[str, tuple[Callable[[], object], int, int]] = {
        "call": (lambda: model.mass_matrix(q), CALLS, 1),
        "batch": (plain, 1, STATES),
        "kernel": (kernel, 1, STATES),
    }
    try:
        from ..adapters.pinocchio.plain import mass_matrix_call  # Whoever lacks Pinocchio has the rest.
    except ImportError:
        pass
    else:
        calls["pinocchio"] = (mass_matrix_call(Path(path), floating), CALLS, 1)
    return _medians(calls)


def _medians(calls: Mapping[str, tuple[Callable[[], object], int, int]]) -> dict[str, float]:
    """Median seconds of each call, given with its repetitions in a turn and its states, all in turns."""
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(REPEATS):
        for name, (call, count, states) in calls.items():
            start = time.perf_counter()
            for _ in range(count):
                call()
            taken[name].append((time.perf_counter() - start) / (count * states))
    return {name: median(seconds) for name, seconds in taken.items()}
