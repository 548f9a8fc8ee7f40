"""A four-bar through its singular posture: multipliers or partitioning, projection or Baumgarte's gains."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import symofros as sf

from ...adapters.exudyn.steps import Solver
from ...adapters.exudyn.timed_systems import bars
from ...adapters.mujoco.motion import loaded
from ...mechanics.geometry import Array
from ...stability.closed_loops import four_bars
from ...stability.closed_loops.singular import DEFAULT, SOLIMP
from ..contestants.exudyn import ExudynModel
from ..contestants.mujoco import MujocoModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Prepared, Target
from .closed_forms import turning

END, OUTPUT = 10.0, 0.1
TIMES = np.arange(round(END / OUTPUT) + 1, dtype=np.float64) * OUTPUT
HINGES = ((0, 1.0, 2, 0.0), (2, 1.0, 1, 1.0))
CLOSED = {"multipliers": "multipliers", "null_space": "partitioned"}


@cache
def reference() -> Array:
    """The crank's angle from the horizontal (n) [rad]; it turns backwards."""
    J, V = four_bars.inertia(1)
    return -np.pi / 2 - turning(-four_bars.START[1], V / J, TIMES) + 2 * np.pi


def far(angle: Array) -> float:
    """Largest distance of the crank's end from where it should be [m]."""
    return float(np.abs(2.0 * np.sin((angle - reference()) / 2.0)).max())


def symofros_all(quick: bool) -> list[Contestant]:
    """Our models with both ways to solve, and both ways to hold constraints."""
    steps = (1e-2, 5e-3) if quick else (2e-2, 1e-2, 5e-3, 2e-3, 1e-3)
    rtols = (1e-6,) if quick else (1e-4, 1e-6, 1e-8, 1e-10)
    contestants: list[Contestant] = []
    for option, label in CLOSED.items():
        m = sf.compile(four_bars.system(1), sf.Options(constraints=option))  # type: ignore[arg-type]
        q, v = four_bars.state(m, *four_bars.START)
        given: dict[str, Any] = {"q0": q, "v0": v, "t_end": END, "output": TIMES}
        one = SymofrosModel(f"{label}, projected", m, given, lambda run: far(run["a0"]))
        contestants += one.by("rk4", steps) + one.by("dop853", rtols)
        if quick:
            continue
        contestants += one.by("dopri5", rtols) + one.by("generalized_alpha", steps)
        held = SymofrosModel(f"{label}, Baumgarte", m, given | {"stabilisation": "baumgarte"}, one.judge)
        contestants += held.by("rk4", steps) + held.by("dop853", rtols)
        if label == "multipliers":
            contestants += (
                one.by("rodas4", rtols) + one.by("semi_implicit_euler", steps) + one.by("implicit_euler", steps)
            )
    return contestants


def mujoco_all(quick: bool) -> list[Contestant]:
    """Soft closures as stated by default, and as stiff as a step allows."""
    m = four_bars.linkage(1)
    _, v = four_bars.state(m, *four_bars.START)
    start = four_bars.START[0]

    def side(label: str, stiff: bool) -> MujocoModel:
        def model(h: float) -> Any:
            solref, solimp = (f"{2 * h!r} 1", SOLIMP) if stiff else DEFAULT
            return loaded(four_bars.mjcf(1, "RK4", h, solref, solimp))

        return MujocoModel(label, model, np.zeros(m.nq), v, len(TIMES) - 1, OUTPUT, lambda q: far(start + q[:, 0]))

    steps = (1e-3, 5e-4) if quick else (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
    contestants = side("stiff closures", True).by("RK4", steps)
    if quick:
        return contestants
    for integrator in ("Euler", "implicit", "implicitfast"):
        contestants += side("stiff closures", True).by(integrator, steps[1:5])
    return contestants + side("default closures", False).by("RK4", steps[:4])


def exudyn_all(quick: bool) -> list[Contestant]:
    """Bodies in absolute coordinates."""
    made = bars(four_bars.links(1), HINGES, (0, 1))
    one = ExudynModel(
        "absolute coordinates", made, END, OUTPUT, lambda r: far(np.arctan2(r.values[:, 1], r.values[:, 0]))
    )
    steps = (5e-3,) if quick else (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)
    contestants = one.by(Solver(tolerance=1e-8, bisecting=True), steps)
    if not quick:
        for solver in (
            Solver(tolerance=1e-8),
            Solver(tolerance=1e-8, radius=1.0, bisecting=True),
            Solver(tolerance=1e-8, full=False, bisecting=True),
            Solver("TrapezoidalIndex2", tolerance=1e-8, bisecting=True),
        ):
            contestants += one.by(solver, steps)
        contestants += one.by(Solver("RK44"), (1e-3,))
    return contestants


def prepare(quick: bool) -> Prepared:
    """The closed form, and SciPy's DOP853 on the reduced equation."""
    solved = four_bars.exact(1, tuple(TIMES.tolist()))[0]
    origin = (
        "the closed form of the motion as a parallelogram, by elliptic functions; and SciPy's DOP853 at 1e-13 on its "
        "reduced equation"
    )
    return Prepared((*symofros_all(quick), *mujoco_all(quick), *exudyn_all(quick)), far(solved), origin)


PROBLEM = BenchmarkProblem(
    "Four-bar through its singular posture",
    "Three bars of 1 m and 1 kg on the ground, upright at the start; they turn over 10 s through the posture in which "
    "all lie on a line. Every side records its crank each 0.1 s.",
    "end of the crank, largest over the run [m]",
    "error of the crank  [m]",
    "MuJoCo: its closures are soft; their time constant is two steps, the shortest it takes, and its default; all "
    "integrators, steps from 0.1 to 5 ms. Exudyn: hinges as joints between bodies in absolute coordinates, generalised "
    "alpha with spectral radii 0.9 and 1, the trapezoidal rule of index 2, full and modified Newton iterations, steps "
    "from 0.2 to 10 ms, which may be cut into 32 parts; its explicit solvers refuse joints.",
    prepare,
    (Target("MuJoCo", 1e-4, 1.0), Target("Exudyn", 1e-4, 1.0)),
    1e-8,
    ("IFToMM benchmark library, A02 with one loop",),
)
