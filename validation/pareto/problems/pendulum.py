"""A long conservative motion: who keeps the phase of a pendulum over a thousand seconds."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from ...adapters.exudyn.steps import Solver
from ...adapters.exudyn.timed_systems import pendulum as exudyn_pendulum
from ...adapters.mujoco.motion import loaded
from ...mechanics.geometry import Array
from ...stability.rigid import energy
from ..contestants.exudyn import ExudynModel
from ..contestants.mujoco import MujocoModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Prepared, Target
from .closed_forms import swinging

END, OUTPUT, GRAVITY = 1000.0, 1.0, 9.81
TIMES = np.arange(round(END / OUTPUT) + 1, dtype=np.float64) * OUTPUT
MODEL = "1 joint"


def far(q: Array, t: Array = TIMES) -> float:
    """Largest error at times (n) of the angle from the horizontal (n) [rad]."""
    return float(np.abs(q - np.pi / 2 - swinging(-np.pi / 2, GRAVITY, t)).max())


def mjcf() -> str:
    """MuJoCo's text, with an inertia that slows no swing to be seen: 1e-9 kg m^2 is 1.6e-6 rad after 1000 s."""
    return energy.MJCF.format(h=1e-3, name="RK4").replace("1e-9 1e-9 1e-9", "1e-14 1e-14 1e-14")


def prepare(quick: bool) -> Prepared:
    """The closed form, and SciPy's DOP853 on the equation."""
    run = solve_ivp(
        lambda t, y: [y[1], GRAVITY * np.cos(y[0])], (0, END), [0.0, 0.0], "DOP853", TIMES, rtol=1e-13, atol=1e-13
    )
    given = {"q0": [0.0], "t_end": END, "output": TIMES}
    one = SymofrosModel(MODEL, energy.pendulum(), given, lambda run: far(run.q[:, 0]))
    rtols = (1e-8,) if quick else (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
    contestants: list[Contestant] = one.by("dop853", rtols)
    model = loaded(mjcf())
    mujoco = MujocoModel(
        MODEL, lambda _: model, np.zeros(1), np.zeros(1), len(TIMES) - 1, OUTPUT, lambda q: far(q[:, 0])
    )
    exudyn = ExudynModel(MODEL, exudyn_pendulum(GRAVITY), END, OUTPUT, lambda r: far(r.values[:, 0], r.t))
    if quick:
        contestants += mujoco.by("RK4", (1e-2,)) + exudyn.by(Solver("RK44"), (2e-2,))
    else:
        for method in ("dopri5", "rodas4", "cvode", "cvode_adams"):
            contestants += one.by(method, rtols if method == "dopri5" else rtols[:6])
        contestants += one.by("rk4", (0.05, 0.02, 0.01, 5e-3, 2e-3))
        for method in ("variational", "semi_implicit_euler", "generalized_alpha"):
            contestants += one.by(method, (0.02, 5e-3, 1e-3))
        contestants += one.by("euler", (1e-3,)) + one.by("implicit_euler", (1e-3,))
        contestants += mujoco.by("RK4", (0.05, 0.02, 0.01, 5e-3, 2e-3))
        for integrator in ("Euler", "implicit", "implicitfast"):
            contestants += mujoco.by(integrator, (0.01, 1e-3))
        contestants += exudyn.by(Solver("RK44"), (0.05, 0.02, 0.01))
        contestants += exudyn.by(Solver("RK67"), (0.1, 0.05, 0.04, 0.025, 0.02))
        contestants += exudyn.by(Solver("DOPRI5"), (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10))
        contestants += exudyn.by(Solver(radius=1.0), (0.02, 5e-3)) + exudyn.by(
            Solver("TrapezoidalIndex2"), (0.02, 5e-3)
        )
    origin = "the closed form, by elliptic functions; and SciPy's DOP853 at 1e-13 on the equation of the pendulum"
    return Prepared(tuple(contestants), far(run.y[0]), origin)


PROBLEM = BenchmarkProblem(
    "Long conservative motion",
    "A pendulum of 1 m swings from the horizontal for 1000 s, 422 times. Every side records its angle each second.",
    "angle, largest over the run [rad]",
    "error of the angle  [rad]",
    "MuJoCo: all of its integrators, steps from 1 to 50 ms, mj_step called once between records. Exudyn: a kinematic "
    "tree of one coordinate without constraints; its explicit RK44, RK67 and DOPRI5, its trapezoidal rule and "
    "generalised alpha without damping.",
    prepare,
    (
        Target("MuJoCo", 1e-4, 1.0),
        Target("Exudyn", 1e-4, 1.0),
        Target("MuJoCo", 1e-6, 1.0),
        Target("Exudyn", 1e-6, 1.0),
    ),
    1e-7,
    ("closed form: Whittaker, Analytical Dynamics, section 44",),
)
