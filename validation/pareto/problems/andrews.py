"""Andrews' squeezing mechanism: seven links in three loops, fast."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

import symofros as sf

from ... import references
from ...adapters.exudyn.steps import Solver
from ...adapters.exudyn.timed_systems import joint_angles, looped
from ...mechanics.geometry import Array
from ...reporting.references import References
from ..contestants.exudyn import ExudynModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Prepared, Target
from .four_bar import CLOSED

END, OUTPUT = 0.03, 1e-3
TIMES = np.linspace(0.0, END, round(END / OUTPUT) + 1)
TORQUE = 0.033


@cache
def known() -> dict[str, dict[str, float]]:
    """Angles of the hinges at the start and the end, of the IVP test set."""
    solution: dict[str, dict[str, float]] = References(Path(__file__).parents[1] / "data").data("andrews")
    return solution


def system() -> sf.System:
    """The mechanism."""
    return references.MODELS["andrews_squeezer"]


def far(q: Array, names: tuple[str, ...]) -> float:
    """Largest error of the angles at the end [rad]."""
    return float(np.abs(q - np.array([known()["end"][name] for name in names])).max())


def prepare(quick: bool) -> Prepared:
    """Published angles; a second way to solve for the accelerations at a tight tolerance."""
    rtols = (1e-4, 1e-8) if quick else (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
    steps = (1e-4,) if quick else (2e-4, 1e-4, 5e-5, 2e-5, 1e-5)
    contestants: list[Contestant] = []
    agreement = 0.0
    for option, label in CLOSED.items():
        m = sf.compile(system(), sf.Options(constraints=option))  # type: ignore[arg-type]
        q0 = np.array([known()["start"][name] for name in m.names.q])
        given = {"q0": q0, "t_end": END, "output": TIMES}
        one = SymofrosModel(f"{label}, projected", m, given, lambda run, m=m: far(run.q[-1], m.names.q))  # type: ignore[misc]
        agreement = max(agreement, one.measured(method="dop853", rtol=1e-12, atol=1e-13).error)
        contestants += one.by("dop853", rtols) + one.by("rk4", steps)
        if quick:
            continue
        held = SymofrosModel(f"{label}, Baumgarte", m, given | {"stabilisation": "baumgarte"}, one.judge)
        contestants += one.by("dopri5", rtols) + held.by("dop853", rtols)
        if label == "multipliers":
            contestants += one.by("rodas4", rtols[:6]) + one.by("generalized_alpha", steps) + held.by("cvode", rtols)
            contestants += one.by("semi_implicit_euler", steps) + one.by("implicit_euler", steps)
    start = known()["start"]
    order = m.names.q
    exudyn = ExudynModel(
        "absolute coordinates",
        looped(system(), start, TORQUE),
        END,
        OUTPUT,
        lambda r: far(joint_angles(system(), start, r.values)[-1], order),
    )
    coarse = (5e-5,) if quick else (1e-4, 5e-5, 2e-5, 1e-5, 5e-6)
    contestants += exudyn.by(Solver(radius=0.9, tolerance=1e-8), coarse)
    if not quick:
        contestants += exudyn.by(Solver(radius=0.9, tolerance=1e-8, full=False), coarse)
        contestants += exudyn.by(Solver(radius=1.0, tolerance=1e-8), coarse) + exudyn.by(Solver("RK44"), (1e-5,))
        contestants += exudyn.by(Solver("TrapezoidalIndex2", tolerance=1e-8, bisecting=True), coarse)
    origin = (
        "the angles published with the IVP test set; and our dop853 at 1e-12, by multipliers and partitioned, of which "
        "the worse counts"
    )
    return Prepared(tuple(contestants), agreement, origin)


PROBLEM = BenchmarkProblem(
    "Andrews' squeezing mechanism",
    "Seven links in three loops, driven by a torque against a spring, for 0.03 s, in which the crank turns 2.5 times. "
    "Every side records each millisecond.",
    "hinges at the end [rad]",
    "error of the hinges at the end  [rad]",
    "Exudyn: rigid bodies in absolute coordinates, hinges as joints; generalised alpha with spectral radii 0.9 and 1, "
    "the trapezoidal rule of index 2, full and modified Newton iterations, steps from 5 to 100 µs; its explicit "
    "solvers refuse joints. MuJoCo is left out: its closures are soft.",
    prepare,
    (Target("Exudyn", 1e-2, 1.0), Target("Exudyn", 1e-4, 1.0)),
    1e-6,
    ("IFToMM benchmark library, A03; IVP test set (Mazzia and Magherini)",),
)
