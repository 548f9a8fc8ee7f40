"""The spin-up of Simo and Vu-Quoc's beam: modes and steps of ours against elements and steps of Exudyn's."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

import symofros as sf

from ...adapters.exudyn.ancf import SlenderBeam
from ...adapters.exudyn.steps import Recorded, Solver
from ...adapters.exudyn.timed_systems import spinning
from ...mechanics.geometry import Array
from ..contestants.exudyn import ExudynModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Prepared, Target

ROD = SlenderBeam(length=10.0, EI=1.4e4, EA=2.8e7, rhoA=1.2, duration=15.0, rate=6.0)
RHO_I = 6e-4  # Moment of inertia of sections per length [kg m].
END, OUTPUT = 15.0, 0.1
TIMES = np.arange(round(END / OUTPUT) + 1, dtype=np.float64) * OUTPUT
# Forces of EA 2.8e7 N round off near 1e-7 N; below that Newton's method has nothing to find.
TOLERANCE = 3e-6
FINE, FINE_STEP = 32, 2.5e-3
_K, _SHARE = 2.0 * math.pi / ROD.duration, ROD.rate / ROD.duration
DRIVE = {
    "hub": f"{_SHARE!r}*(t^2/2 + (cos({_K!r}*t) - 1)/{_K * _K!r})",
    "dhub": f"{_SHARE!r}*(t - sin({_K!r}*t)/{_K!r})",
    "ddhub": f"{_SHARE!r}*(1 - cos({_K!r}*t))",
}


def model(modes: int, **changed: Any) -> sf.Model:
    """The beam with so many functions."""
    hub = sf.Joint("hub", "revolute", prescribed=True)
    given: dict[str, Any] = {"family": "clamped_free", "EI_z": ROD.EI, "rhoI_z": RHO_I} | changed
    beam = sf.Beam("b", hub, ROD.length, ROD.rhoA, bend_y=modes, **given)
    return sf.compile(sf.System("spin_up", (beam,), gravity=(0, 0, 0)))


def exact_rod(count: int, stretch: int = 0) -> sf.Model:
    """The beam as a geometrically exact rod with so many functions of curvature and of stretch."""
    return model(count, theory="strain", family="legendre", stretch=stretch, **({"EA": ROD.EA} if stretch else {}))


def seen_from_hub(position: Array) -> Array:
    """Positions of the tip in the world (n, 2) -> its displacement along and across the hub's x [m]."""
    angle = ROD.angle(TIMES)
    c, s = np.cos(angle), np.sin(angle)
    x, y = position[:, 0], position[:, 1]
    return np.stack([c * x + s * y - ROD.length, c * y - s * x], axis=-1)


def far(one: Array, other: Array) -> float:
    """Largest distance over the run, as a share of the largest deflection."""
    return float(np.linalg.norm(one - other, axis=1).max() / np.abs(reference()[:, 1]).max())


@cache
def reference() -> Array:
    """Exudyn's tip (n, 2) of a fine mesh, extrapolated from two steps of a method of second order."""
    solver = Solver(full=False, tolerance=TOLERANCE, sparse=True)
    fine, coarse = (spinning(ROD, FINE).run(solver, step, END, OUTPUT) for step in (FINE_STEP / 2, FINE_STEP))
    return np.asarray((4.0 * seen_from_hub(fine.values) - seen_from_hub(coarse.values)) / 3.0)


def judged_model(label: str, m: sf.Model) -> SymofrosModel:
    """A model of ours, to be judged by its tip."""
    given = {"t_end": END, "u": DRIVE, "output": TIMES}
    return SymofrosModel(label, m, given, lambda run: far(seen_from_hub(run.frames["tip"][0]), reference()))


def modes(n: int) -> str:
    """A count for people."""
    return f"{n} mode{'s' * (n > 1)}"


def symofros_all(quick: bool) -> list[Contestant]:
    """Modes, families, what is left out; every method on three modes."""
    steps = (0.05, 0.02) if quick else (0.1, 0.05, 0.04, 0.03, 0.025, 0.02, 0.01)
    rtols = (1e-4,) if quick else (1e-2, 1e-3, 1e-4, 1e-5, 1e-7)
    contestants: list[Contestant] = []
    counts = (1, 3) if quick else (1, 2, 3, 4)
    for n in counts:
        one = judged_model(modes(n), model(n))
        contestants += one.by("rk4", steps) + one.by("semi_implicit_euler", steps[-3:] + (5e-3, 2.5e-3)[: 3 - quick])
        contestants += one.by("generalized_alpha", steps) + one.by("dopri5", rtols)
        if n == 3 and not quick:
            contestants += one.by("dop853", rtols) + one.by("cvode", rtols) + one.by("cvode_adams", rtols)
            contestants += one.by("rodas4", rtols) + one.by("implicit_euler", (0.02, 5e-3, 1e-3))
            contestants += one.by("euler", (1e-3, 2e-4)) + one.by("variational", (0.02,))
    if quick:
        return contestants
    for family in ("spline", "legendre", "polynomial", "hermite"):
        n = 2 if family == "hermite" else 3
        contestants += judged_model(f"{modes(n)}, {family}", model(n, family=family)).by("rk4", (0.02, 0.01, 5e-3))
    changes: dict[str, dict[str, Any]] = {
        "3 modes, zeroth order": {"retain": "zeroth_order"},
        "3 modes, all terms": {"retain": "all"},
        "3 modes, rotary inertia": {"rotary_inertia": True},
        "3 modes, not foreshortened": {"foreshortening": False, "retain": "all"},
    }
    for label, change in changes.items():
        contestants += judged_model(label, model(3, **change)).by("rk4", (0.025, 0.02, 0.01))
    for count, stretch in ((2, 0), (3, 0), (4, 0), (3, 1), (4, 1), (4, 2), (5, 2), (6, 2)):
        label = f"rod of {count}{f' + {stretch}' * (stretch > 0)} strains"
        one = judged_model(label, exact_rod(count, stretch))
        contestants += one.by("rodas4", (*rtols, 1e-6)) + one.by("generalized_alpha", (0.02, 0.01, 5e-3, 2e-3))
        contestants += one.by("rk4", (0.02, 0.01) if not stretch else (2e-3,)) + one.by("dop853", rtols[2:4])
    return contestants


def exudyn_all(quick: bool) -> list[Contestant]:
    """Meshes, steps, both kinds of Newton's method, and both of its implicit solvers."""
    contestants: list[Contestant] = []
    if quick:
        return ExudynModel("4 elements", spinning(ROD, 4), END, OUTPUT, judged).by(
            Solver(tolerance=TOLERANCE), (0.025, 5e-3)
        )
    for elements in (2, 3, 4, 6, 8, 16):
        one = ExudynModel(f"{elements} elements", spinning(ROD, elements), END, OUTPUT, judged)
        steps = (0.05, 0.025, 0.02, 0.0125, 0.01, 5e-3, 2.5e-3)
        contestants += one.by(Solver(tolerance=TOLERANCE), steps[:5] if elements < 8 else steps[2:6])
        contestants += one.by(Solver(tolerance=TOLERANCE, full=False), steps[2:])
        contestants += one.by(Solver(tolerance=TOLERANCE, full=False, sparse=True), steps[3:]) if elements >= 8 else []
    for elements in (8, 12, 16):  # For errors of 1e-4 and 1e-5 of the deflection.
        one = ExudynModel(f"{elements} elements", spinning(ROD, elements), END, OUTPUT, judged)
        contestants += one.by(Solver(tolerance=TOLERANCE, full=False, sparse=True), (1.25e-3, 6.25e-4, 3.125e-4))
        contestants += one.by(Solver(tolerance=TOLERANCE, full=False), (2.5e-3, 1.25e-3, 6.25e-4))
    four = ExudynModel("4 elements", spinning(ROD, 4), END, OUTPUT, judged)
    for radius in (0.5, 0.7):
        contestants += four.by(Solver(tolerance=TOLERANCE, radius=radius), (0.05, 0.025, 0.0125, 5e-3))
    contestants += four.by(Solver("TrapezoidalIndex2", tolerance=TOLERANCE), (5e-3,))
    return contestants + four.by(Solver("RK44"), (1e-3,))


def judged(recorded: Recorded) -> float:
    """Error of Exudyn's tip positions, as recorded by its sensor, relative to the largest deflection."""
    return far(seen_from_hub(recorded.values), reference())


def prepare(quick: bool) -> Prepared:
    """References first: everything is judged by them."""
    mine = judged_model("rod", exact_rod(7, 3)).measured(method="rodas4", rtol=1e-9, atol=1e-11).error
    floors = {
        name: judged_model(name, model(5, retain=retain)).measured(method="dop853", rtol=1e-9, atol=1e-11).error
        for name, retain in (("first order", "first_order"), ("all terms", "all"))
    }
    origin = (
        f"Exudyn, {FINE} ANCFCable2D elements, extrapolated from steps of {1e3 * FINE_STEP:g} and "
        f"{500 * FINE_STEP:g} ms; and, sharing no code with it, our rod of 7 functions of curvature and 3 of stretch "
        "by rodas4 at 1e-9. A rod of rigid links with springs between them, a program of its own, agrees to 1.5e-4"
    )
    return Prepared((*symofros_all(quick), *exudyn_all(quick)), mine, origin, floors)


PROBLEM = BenchmarkProblem(
    "Spin-up of a flexible beam",
    "A cantilever of 10 m on a hub that turns faster and faster, to 6 rad/s in 15 s; it lags by 0.57 m. "
    "Every side records its tip each 0.1 s.",
    "distance of the tip, largest over the run, as a share of the largest deflection",
    "error of the tip / deflection  [1]",
    "Exudyn: ANCFCable2D, the element that errs least on the elastica with so few coordinates; 2 to 16 of them; steps "
    "from 0.3 to 50 ms; generalised alpha with spectral radii 0.5 to 0.9; full and modified Newton iterations with a "
    "tolerance of 3e-6 N, above rounding (1e-3 N gains a few percent); dense and sparse matrices; the hub's angle by a "
    "symbolic function in C++ instead of one in Python. Its trapezoidal rule of index 2 has no such driven joint, and "
    "its explicit solvers refuse joints. It is the build that checks ranges, as installed; the one that does not, "
    "which a process has to choose before it loads Exudyn, gained up to a fifth when tried.",
    prepare,
    (
        Target("Exudyn", 1e-2, 200.0),
        Target("Exudyn", 2e-3, 200.0),
        Target("Exudyn", 1e-3, 20.0),
        Target("Exudyn", 1e-4, 20.0),
        Target("Exudyn", 1e-5, 20.0),
    ),
    5e-6,
    ("Simo & Vu-Quoc, CMAME 66 (1988) 125; J. Appl. Mech. 53 (1986) 855, parameters as commonly quoted",),
    percent=True,
)
