"""Drift of loops that accelerations alone keep: it grows with the number of loops, and falls with the step's power."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.findings import Finding, exponent
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, cell, decades, simulate
from . import four_bars

# Parallelograms would not drift: errors of all cranks are the same. Pivots are a little nearer than bars are long.
SPACING = 0.95
# Before the first flat posture.
END = 0.5
BOUND = 1e-6
ORDERS = {"semi_implicit_euler": 1, "rk4": 4, "dopri5": 5}
PROJECTED = "rk4, projection"
H = Grid("step h [s]", decades(1e-3, 1e-1, 6), (5e-3, 1e-2, 2e-2))
LOOPS = Grid("number of four-bars in a row [-]", (1.0, 2.0, 4.0, 8.0), (1.0, 2.0, 4.0))


@cache
def ready(loops: int) -> tuple[sf.Model, Array, Array]:
    """Assembled, first crank upright."""
    m = four_bars.linkage(loops, SPACING)
    assembled = sf.assemble(m, *four_bars.state(m, *four_bars.START), held=("a0",))
    return m, assembled.q, assembled.v


def measure(method: str, kind: str) -> Callable[[float, float], Cell]:
    """Largest |phi| on the way."""

    def run(h: float, loops: float) -> Cell:
        m, q, v = ready(int(loops))
        return cell(
            simulate(m, q, v, END, method=method, dt=END / round(END / h), adaptive=False, stabilisation=kind),
            lambda done: float(np.abs(m.constraint(done.q)).max()),
        )

    return run


def slope(maps: Maps, method: str) -> float:
    """Exponent of the drift in h, over all numbers of loops, where it stands clear of rounding and of order one."""
    runs = maps[method]
    slopes = []
    for row in runs.values:
        clear = (row > 1e-11) & (row < 1e-2)
        if clear.sum() >= 2:
            slopes.append(-exponent(runs.x[clear], row[clear]))
    return float(np.mean(slopes))


def judge(maps: Maps) -> Verdict:
    """Exponents in the step, growth with the number of loops."""
    slopes = {method: slope(maps, method) for method in ORDERS}
    rk4 = maps["rk4"]
    growth = -exponent(rk4.y, rk4.at(x=1e-2))
    kept = float(np.nanmax(maps[PROJECTED].values))
    findings = [
        Finding(f"{method}: exponent of the drift in h", slopes[method], order + 0.6, order - 0.6, "its order")
        for method, order in ORDERS.items()
    ] + [Finding(f"{PROJECTED}: largest violation [m]", kept, 1e-9, reason="what projection is asked for")]
    longest = {}
    for method, runs in maps.items():
        held = np.asarray(runs.good).all(axis=0)
        longest[method] = float(runs.x[held].max(initial=0.0))
    statement = (
        f"Kept by accelerations alone, loops drift as h to the power {slopes['semi_implicit_euler']:.1f} with "
        f"semi-implicit Euler, {slopes['rk4']:.1f} with RK4, {slopes['dopri5']:.1f} with Dormand-Prince. With RK4 "
        f"at 10 ms the drift grows with the number of loops to the power {growth:.1f}. The longest step of the map "
        f"that keeps all rows within {BOUND:g} m is {longest['rk4']:.3g} s for RK4, {longest['dopri5']:.3g} s for "
        "Dormand-Prince and "
        f"{'none' if not longest['semi_implicit_euler'] else format(longest['semi_implicit_euler'], '.3g') + ' s'} "
        f"for semi-implicit Euler; projection keeps {kept:.0e} m at every step."
    )
    see = (
        "Going right along a row, decades grow in equal steps: that is the order. Going up, each doubling of the "
        f"loops multiplies the drift by about {2**growth:.0f}. The map with projection is level at rounding."
    )
    return Verdict(statement, see, tuple(findings))


STUDY = ParameterStudy(
    "How do long loops drift without stabilisation?",
    f"N four-bars in a row, on pivots {SPACING} m apart, fall from upright for {END} s, before they are flat; their "
    "closures are kept by accelerations alone, or by projection.",
    H,
    LOOPS,
    "largest violation |φ| of the closures [m]",
    BOUND,
    (
        *(Subject(method, measure(method, "none")) for method in ORDERS),
        Subject(PROJECTED, measure("rk4", "projection")),
    ),
    judge,
    "projection. Without it, a method of high order and a run so short that t h^k stays below what the loop may open.",
    ("order of convergence of a method is that of its drift: Hairer and Wanner II, VII.2",),
)
