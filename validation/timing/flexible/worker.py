"""Times the planar flexible robot, ours and Exudyn's in turn, in the process of a worker."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from statistics import median
from time import thread_time_ns

import numpy as np

from ...adapters.exudyn.planar import smallest
from ...adapters.exudyn.system import Part
from ...mechanics.assembly import assemble
from ..race import pin_to_one_cpu, summary
from .equal_accuracy import Pair, pairs, robot
from .loop import GeneratedLoop
from .race import FlexibleTiming

# Elastic coordinates of the states: the strips bend by some 3 % of their lengths [m].
_DEFLECTION = 0.01

# What is timed: our functions, and the parts of Exudyn's model that hold the same.
JOBS: dict[str, tuple[tuple[str, ...], tuple[Part, ...]]] = {
    "M": (("mass_matrix",), ("mass_matrix",)),
    "M + h": (("mass_matrix", "bias"), ("mass_matrix", "forces")),
    "M + h + Q": (("dynamics",), ("mass_matrix", "forces")),
    "M + h + Q, joints": (("dynamics",), ("mass_matrix", "forces", "joints")),
}
Times = list[float]


def measure(repeats: int, counts: Iterable[int], calls: int) -> Iterator[FlexibleTiming]:
    """Time in this process, which is pinned to one processor; arguments as for `run_flexible`.

    Raises:
        NotTheSameError: The two sides are not models of one robot.
    """
    pin_to_one_cpu()
    for pair in pairs(counts):
        yield from _timed(pair, repeats, calls)


def _timed(pair: Pair, repeats: int, calls: int) -> list[FlexibleTiming]:
    system, rng = robot(pair.functions), np.random.default_rng(0)
    nv, n = assemble(system).nv, pair.tree.coordinates
    q, v = _DEFLECTION * rng.standard_normal((calls, nv)), rng.standard_normal((calls, nv))
    loop = GeneratedLoop(system, ("mass_matrix", "bias", "dynamics"), q, v)
    engine_time, empty = pair.tree.evaluated, smallest()
    engine_time.at(_DEFLECTION * rng.standard_normal(n), rng.standard_normal(n))
    times: dict[str, tuple[Times, Times, Times]] = {quantity: ([], [], []) for quantity in JOBS}
    for _ in range(repeats):
        for quantity, (functions, parts) in JOBS.items():
            runs = (
                partial(loop.run, functions),
                partial(engine_time.repeat, parts, calls),
                partial(empty.repeat, parts, calls),
            )
            for run, collected in zip(runs, times[quantity], strict=True):
                collected.append(_nanoseconds(run) / calls)
    return [_row(quantity, pair, nv, *collected) for quantity, collected in times.items()]


def _row(quantity: str, pair: Pair, nv: int, generated_time: Times, engine_time: Times, calls: Times) -> FlexibleTiming:
    triples = list(zip(generated_time, engine_time, calls, strict=True))
    sizes = nv, pair.tree.coordinates, pair.tree.equations
    return FlexibleTiming(
        quantity,
        pair.functions,
        pair.elements,
        sizes,
        pair.error,
        summary(generated_time),
        summary(engine_time),
        summary(calls),
        median(b / a for a, b, _ in triples),
        median((b - c) / a for a, b, c in triples),
    )


def _nanoseconds(run: Callable[[], None]) -> int:
    start = thread_time_ns()
    run()
    return thread_time_ns() - start
