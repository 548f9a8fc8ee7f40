"""M, h and Q of a geometrically exact rod beside the beam of first order of as many coordinates.

Loops in C on both sides, by turns in one run: quote the ratio, and of several runs the range (docs/theory/rods.md,
section 7).
"""

from __future__ import annotations

import ctypes
import time
from functools import partial
from typing import Any

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import symofros as sf
from tests.mechanics.beams.rods import rod
from validation.timing.contestants.arrays import Arrays, loops

STATES, ROUNDS = 1000, 200
CASES = {"3 in a plane": (3, 0, 0), "2 + 2 + 2 in space": (2, 2, 2)}


class Loop:
    """The loop of one function over random states."""

    def __init__(self, system: sf.System, options: sf.Options) -> None:
        ffi, native = loops()
        path, symbol = sf.compile_library(system, options)
        self._library = ctypes.CDLL(str(path))  # Stays loaded as long as this.
        model = ffi.cast("const sym_model *(*)(void)", ctypes.cast(self._library[symbol], ctypes.c_void_p).value)()
        entry, rng, pre = model.functions[0], np.random.default_rng(0), np.zeros(model.npre + 1)
        model.init(model.par_default, ffi.from_buffer("double[]", pre))
        given = {"pre": pre[: model.npre], "t": np.zeros(1)}
        arrays: list[Any] = [
            given.get(ffi.string(item.name).decode(), rng.uniform(-0.5, 0.5, (STATES, item.rows * item.cols)))
            for item in getattr(entry, "in")[0 : entry.n_in]
        ]
        sizes = [item.rows * item.cols for item in entry.out[0 : entry.n_out]]
        self._arrays = Arrays(arrays, sizes, (int(entry.work), 0))
        self._run, self.least = partial(native.loop_eval, model.functions + 0, self._arrays.overwritten()), np.inf

    def __call__(self) -> None:
        start = time.perf_counter_ns()
        self._run(1)
        self.least = min(self.least, (time.perf_counter_ns() - start) / STATES)


@pytest.mark.parametrize("case", CASES)
def test_time_of_a_rod_and_a_first_order_beam(benchmark: BenchmarkFixture, case: str) -> None:
    inertia = {"rhoI_y": 0.0, "rhoI_z": 0.0}
    first, exact = (
        Loop(
            sf.System("s", (rod(CASES[case], sf.Joint("base", "free"), theory=theory, **inertia),)),
            sf.Options(("dynamics",)),
        )
        for theory in ("second_order", "strain")
    )

    def by_turns() -> None:
        first()
        exact()

    benchmark.pedantic(by_turns, rounds=ROUNDS)
    ratio = exact.least / first.least
    benchmark.extra_info["ratio"] = ratio
    print(f"{case}: {exact.least:.1f} ns, first order {first.least:.1f} ns, ratio {ratio:.2f}")
