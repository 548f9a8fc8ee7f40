"""A rigid arm under control: every method of ours, MuJoCo's integrators, Exudyn's, Pinocchio in SciPy's and in RK4."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import TypeVar

import numpy as np

import symofros as sf

from ...adapters.exudyn.steps import Solver
from ...adapters.exudyn.timed_systems import held as exudyn_held
from ...adapters.mujoco import motion as mujoco_steps
from ...adapters.mujoco import tree as mujoco
from ...adapters.pinocchio import steps as pinocchio_steps
from ...adapters.pinocchio import tree as pinocchio
from ...contract.interface import Subject, Unsupported
from ...mechanics.geometry import Array
from ...timing.models import DAMPING, STIFFNESS, TARGET, panda7
from ..contestants.exudyn import ExudynModel
from ..contestants.mujoco import MujocoModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Measured, Prepared, Target

END, OUTPUT = 10.0, 0.1
TIMES = np.arange(round(END / OUTPUT) + 1, dtype=np.float64) * OUTPUT
MODEL = "7 joints"


@cache
def system() -> sf.System:
    """The arm without friction in joints, which engines have each in their own way."""
    panda = panda7()
    bodies = [
        body if body.joint is None else replace(body, joint=replace(body.joint, elements=())) for body in panda.bodies
    ]
    return replace(panda, bodies=tuple(bodies))


E = TypeVar("E")


def possible(made: E | Unsupported) -> E:
    """An engine's model of the arm.

    Raises:
        ValueError: It can't hold it.
    """
    if isinstance(made, Unsupported):
        raise ValueError(made.reason)
    return made


def subject() -> Subject:
    """The arm as a subject, from which engines build their models."""
    return Subject("panda7", system())


@cache
def held() -> pinocchio_steps.Held:
    """Pinocchio's right-hand side."""
    made = possible(pinocchio.build(subject()))
    return pinocchio_steps.Held(made, np.full(7, TARGET), STIFFNESS, DAMPING)


@cache
def motion() -> Callable[[Array], Array]:
    """Times (n) -> joints (n, 7), by Pinocchio and SciPy's DOP853."""
    return held().motion(1e-12, start(), END)


@cache
def reference() -> Array:
    """Joints (n, 7) at the times of all records."""
    return motion()(TIMES)


@cache
def start() -> Array:
    """Joints at the start, at rest."""
    return np.asarray(sf.compile(system()).neutral())


def far(q: Array) -> float:
    """Largest joint error over the run [rad]."""
    return float(np.abs(q - reference()).max())


def judged_model() -> SymofrosModel:
    """Our side, with the law as formulas that are compiled."""
    m = sf.compile(system())
    joints = dict(zip(m.names.u, m.names.q, strict=True))
    law = {u: f"{STIFFNESS}*({TARGET} - {q}) - {DAMPING}*d{q}" for u, q in joints.items()}
    return SymofrosModel(MODEL, m, {"q0": start(), "t_end": END, "u": law, "output": TIMES}, lambda run: far(run.q))


def symofros_all(quick: bool) -> list[Contestant]:
    """Our contestants, by every method unless quick; some in single precision."""
    one = judged_model()
    rtols = (1e-5, 1e-8) if quick else (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
    contestants = one.by("dop853", rtols)
    # Finer bounds of the error than floats can tell make steps shorter, not better.
    contestants += one.in_single_precision("dop853", (1e-4,) if quick else (1e-3, 1e-4, 1e-5, 1e-6))
    if not quick:
        contestants += one.in_single_precision("rk4", (1e-2, 5e-3, 2e-3, 1e-3, 5e-4))
    if quick:
        return contestants
    for method in ("dopri5", "rodas4", "cvode", "cvode_adams"):
        contestants += one.by(method, rtols if method != "rodas4" else rtols[:6])
    contestants += one.by("rk4", (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2.5e-4))
    for method in ("euler", "semi_implicit_euler", "implicit_euler", "generalized_alpha", "variational"):
        contestants += one.by(method, (5e-3, 1e-3, 2e-4))
    return contestants


def in_mujoco() -> MujocoModel:
    """MuJoCo's model of the arm, held by springs and dampers in its joints."""
    made = possible(mujoco.build(subject()))
    m = mujoco_steps.held(made, np.full(7, TARGET), STIFFNESS, DAMPING)
    q0 = made.chart.coordinates(start()[None])[0]
    # Coordinates of hinges are those of the speeds: the chart's transform reorders both.
    order = made.chart.transform(start()[None])[0]
    return MujocoModel(MODEL, lambda _: m, q0, np.zeros(7), len(TIMES) - 1, OUTPUT, lambda q: far(q @ order))


def mujoco_all(quick: bool) -> list[Contestant]:
    """Contestants that run MuJoCo's four integrators at several steps."""
    one = in_mujoco()
    if quick:
        return one.by("RK4", (2e-3, 1e-3))
    contestants = one.by("RK4", (1e-2, 5e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4))
    for integrator in ("Euler", "implicit", "implicitfast"):
        contestants += one.by(integrator, (5e-3, 1e-3, 2e-4))
    return contestants


def pinocchio_all(quick: bool) -> list[Contestant]:
    """The same Runge-Kutta methods around its articulated-body algorithm."""
    side = held()

    def rk4(*steps: float) -> list[Contestant]:
        def run(h: float) -> Measured:
            q, seconds = side.rk4(h, start(), len(TIMES) - 1, round(OUTPUT / h))
            return Measured(far(q), seconds)

        return Contestant.swept(("Pinocchio", MODEL, "RK4 in Python"), run, steps, adapts=False)

    def scipy(method: str, *rtols: float) -> list[Contestant]:
        def run(rtol: float) -> Measured:
            q, seconds = side.solved(method, rtol, start(), TIMES)
            return Measured(far(q), seconds)

        return Contestant.swept(("Pinocchio", MODEL, f"SciPy's {method}"), run, rtols, adapts=True)

    if quick:
        return scipy("DOP853", 1e-6)
    rtols = (1e-4, 1e-6, 1e-8, 1e-10)
    return [*rk4(5e-3, 2e-3), *(one for method in ("RK45", "DOP853", "LSODA") for one in scipy(method, *rtols))]


def exudyn_all(quick: bool) -> list[Contestant]:
    """A kinematic tree, which has no constraints, by explicit and implicit solvers."""
    made = exudyn_held(system(), start(), np.full(7, TARGET), STIFFNESS, DAMPING)
    one = ExudynModel(
        MODEL, made, END, OUTPUT, lambda r: float(np.abs(r.values - motion()(np.minimum(r.t, END))).max())
    )
    if quick:
        return one.by(Solver("RK67"), (5e-3,))
    contestants = one.by(Solver("RK44"), (1e-2, 5e-3, 2e-3, 1e-3)) + one.by(
        Solver("RK67"), (1e-2, 5e-3, 4e-3, 2e-3, 1e-3)
    )
    contestants += one.by(Solver("DOPRI5"), (1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10))
    for solver in (Solver(), Solver(full=False), Solver("TrapezoidalIndex2"), Solver(radius=1.0)):
        contestants += one.by(solver, (5e-3, 1e-3))
    return contestants


def prepare(quick: bool) -> Prepared:
    """Contestants, with the agreement of two independent references."""
    h = 2.5e-4 if quick else 1e-4
    (tiny,) = in_mujoco().by("RK4", (h,))
    agreement = tiny.run().error
    origin = f"Pinocchio's articulated bodies in SciPy's DOP853 at 1e-12; and MuJoCo's RK4 with steps of {1e3 * h:g} ms"
    return Prepared(
        (*symofros_all(quick), *mujoco_all(quick), *exudyn_all(quick), *pinocchio_all(quick)), agreement, origin
    )


PROBLEM = BenchmarkProblem(
    "Rigid arm under control",
    "A Panda with seven joints falls from its neutral posture into springs of 20 N m/rad and dampers of 1 N m s/rad at "
    "0.4 rad on each joint; 10 s. Every side records its joints each 0.1 s.",
    "joint angles, largest over the run [rad]",
    "error of the joints  [rad]",
    "MuJoCo: contacts off, the law as springs and dampers of its joints, in its C and known to its implicit "
    "integrators, all of its integrators at steps from 0.2 to 10 ms, mj_step called once between records. Exudyn: its "
    "kinematic tree with the law inside; RK44, RK67, DOPRI5, generalised alpha, trapezoidal rule. Pinocchio has no "
    "integrator: its aba from Python in RK4 and in SciPy's, whose time is mostly Python's. "
    '"Floats" are ours with accelerations in single precision and states in double, as a batch of one: code in floats '
    "is for batches, so that a motion alone takes one of its lanes and the time of all; its error shows how far it "
    "goes.",
    prepare,
    (Target("MuJoCo", 1e-6, 5.0), Target("Exudyn", 1e-6, 1.0)),
    1e-7,
    ("Franka Emika Panda, example-robot-data",),
)
