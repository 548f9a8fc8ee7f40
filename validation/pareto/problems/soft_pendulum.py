"""A soft rod on a hinge, let go of: strain functions and steps of ours against elements and steps of Exudyn's."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import symofros as sf

from ...adapters.exudyn.ancf import SlenderBeam
from ...adapters.exudyn.steps import Solver
from ...adapters.exudyn.timed_systems import swinging_rod
from ...mechanics.geometry import Array
from ..contestants.exudyn import ExudynModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Prepared, Target

ROD = SlenderBeam(length=1.0, EI=1.0, EA=4e6, rhoA=1.0, duration=0.0, rate=0.0)
# Without damping, waves that the release starts have fronts, which neither side resolves to 1e-5.
GRAVITY, DAMPING = 9.81, 0.01
END, OUTPUT = 2.0, 0.02
TIMES = np.arange(round(END / OUTPUT) + 1, dtype=np.float64) * OUTPUT
# Forces of EA round off near 1e-9 N.
TOLERANCE = 1e-6
FINE, FINE_STEP = 32, 2.5e-4


def model(count: int, stretch: int = 0, **changed: Any) -> sf.Model:
    """The rod with so many functions of curvature and of stretch, which moves the tip by 2e-5 of the length."""
    given: dict[str, Any] = {"theory": "strain", "family": "legendre", "damping": DAMPING, "stretch": stretch}
    given |= ({"EA": ROD.EA} if stretch else {}) | changed
    beam = sf.Beam("rod", sf.Joint("pin", "revolute"), ROD.length, ROD.rhoA, EI_z=ROD.EI, bend_y=count, **given)
    return sf.compile(sf.System("soft_pendulum", (beam,), gravity=(0, -GRAVITY, 0)))


def far(tip: Array) -> float:
    """Largest distance of tips (n, 2) from the reference's over the run, as a share of the length."""
    return float(np.linalg.norm(tip - reference(), axis=1).max()) / ROD.length


def exudyn(elements: int) -> ExudynModel:
    """Exudyn's model."""
    rod = swinging_rod(ROD, GRAVITY, DAMPING, elements)
    return ExudynModel(f"{elements} elements", rod, END, OUTPUT, lambda recorded: far(recorded.values[:, :2]))


@cache
def reference() -> Array:
    """Exudyn's tip (n, 2) of a fine mesh, extrapolated from two steps of a method of second order [m]."""
    solver = Solver(full=False, tolerance=TOLERANCE, sparse=True)
    fine, coarse = (exudyn(FINE).system.run(solver, step, END, OUTPUT) for step in (FINE_STEP / 2, FINE_STEP))
    return np.asarray((4.0 * fine.values[:, :2] - coarse.values[:, :2]) / 3.0)


def judged_model(label: str, m: sf.Model) -> SymofrosModel:
    """A model of ours, to be judged by its tip."""
    given = {"q0": m.neutral(), "t_end": END, "output": TIMES, "beam_limit": np.inf}
    return SymofrosModel(label, m, given, lambda run: far(run.frames["tip"][0][:, :2]))


def prepare(quick: bool) -> Prepared:
    """Contestants, with the agreement of two independent references and the floors of second-order beams."""
    mine = judged_model("rod", model(7, 2)).measured(method="rodas4", rtol=1e-7, atol=1e-9).error
    floors = {
        name: judged_model(name, model(5, theory="second_order", retain=retain)).measured(method="dop853", rtol=1e-9)
        for name, retain in (("first order", "first_order"), ("all terms", "all"))
    }
    contestants: list[Contestant] = []
    rtols = (1e-3, 1e-5) if quick else (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
    for count in (3,) if quick else (1, 2, 3, 4, 5):
        one = judged_model(f"rod of {count} strain{'s' * (count > 1)}", model(count))
        contestants += one.by("rodas4", rtols) + one.by("dop853", rtols[:4]) + one.by("generalized_alpha", (0.01, 2e-3))
        contestants += [] if quick else one.by("rk4", (0.01, 5e-3, 2e-3)) + one.by("dopri5", rtols[:4])
    for count, stretch in () if quick else ((4, 1), (5, 1), (6, 1), (7, 2)):
        one = judged_model(f"rod of {count} + {stretch} strains", model(count, stretch))
        contestants += one.by("rodas4", rtols) + one.by("generalized_alpha", (5e-3, 2e-3, 1e-3))
    for elements in (4,) if quick else (2, 3, 4, 6, 8, 12, 16):
        theirs = exudyn(elements)
        steps = (0.01, 2e-3) if quick else (0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
        contestants += theirs.by(Solver(tolerance=TOLERANCE), steps[:5])
        if not quick:
            contestants += theirs.by(Solver(tolerance=TOLERANCE, full=False), steps[1:])
            contestants += theirs.by(Solver(tolerance=TOLERANCE, full=False, sparse=True), steps[2:])
            contestants += theirs.by(Solver(tolerance=TOLERANCE, full=False, radius=0.6), steps[2:6])
    origin = (
        f"Exudyn, {FINE} ANCFCable2D elements, extrapolated from steps of {1e3 * FINE_STEP:g} and "
        f"{500 * FINE_STEP:g} ms; and, sharing no code with it, our rod of 7 functions of curvature and 2 of stretch "
        "by rodas4 at 1e-7"
    )
    return Prepared(tuple(contestants), mine, origin, {name: run.error for name, run in floors.items()})


PROBLEM = BenchmarkProblem(
    "Soft pendulum",
    "A rod of 1 m, EI 1 N m^2, EA 4 MN, 1 kg, hinged at one end, is let go of from the horizontal; damping against "
    "bending of 10 ms; 2 s. Every side records its tip each 20 ms.",
    "distance of the tip, largest over the run, as a share of the length",
    "error of the tip / length  [1]",
    "Exudyn: ANCFCable2D, 2 to 16 elements; generalised alpha with spectral radii 0.6 and 0.9, full and modified "
    "Newton iterations, dense and sparse; steps from 0.25 to 20 ms. Its explicit solvers refuse joints.",
    prepare,
    (
        Target("Exudyn", 1e-2, 20.0),
        Target("Exudyn", 1e-3, 20.0),
        Target("Exudyn", 1e-4, 20.0),
        Target("Exudyn", 1e-5, 20.0),
    ),
    5e-6,
    ("parameters of this study",),
)
