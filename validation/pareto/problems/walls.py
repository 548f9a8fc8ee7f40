"""A ball between two walls: what each stiff, short impact costs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import symofros as sf

from ...adapters.exudyn.steps import Solver
from ...adapters.exudyn.timed_systems import between_walls
from ...adapters.mujoco.motion import loaded
from ...mechanics.geometry import Array
from ..contestants.exudyn import ExudynModel
from ..contestants.mujoco import MujocoModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Prepared, Target

STIFFNESS, GAP, SPEED, RADIUS = 1e5, 0.1, 1.0, 0.05
END, OUTPUT = 20.0, 0.1
IMPACTS = round(END / (2 * GAP / SPEED + math.pi / math.sqrt(STIFFNESS)))
TIMES = np.arange(round(END / OUTPUT) + 1, dtype=np.float64) * OUTPUT
LAW = "linear walls"
# Largest share of the constraint that MuJoCo takes: what is left of 1 softens its walls.
SOLIMP = "0.9999 0.9999 0.001 0.5 2"


def exact(times: Array) -> Array:
    """Place of the ball between the walls (n) [m]: flights of 2 GAP at SPEED, and half swings on the walls."""
    omega = math.sqrt(STIFFNESS)
    flight, touch = 2 * GAP / SPEED, math.pi / omega
    half, rest = np.divmod(times + flight / 2, flight + touch)
    depth = SPEED / omega * np.sin(omega * np.maximum(rest - flight, 0.0))
    return np.asarray(np.where(half % 2 == 0, 1.0, -1.0) * (np.minimum(rest, flight) * SPEED - GAP + depth))


def far(x: Array, times: Array = TIMES) -> float:
    """Largest distance at times (n) from where the ball should be [m]."""
    return float(np.abs(x - exact(times)).max())


def ball() -> sf.Model:
    """1 kg on a slide, with a contact at each wall."""
    walls = tuple(
        sf.Contact(name, ("ball", None), ("room", name), STIFFNESS, exponent=1.0, radius=RADIUS)
        for name in ("low", "high")
    )
    turned = {"low": sf.Rotation.rpy(0.0, 0.0, 0.0), "high": sf.Rotation.rpy(math.pi, 0.0, 0.0)}
    places = {"low": -GAP - RADIUS, "high": GAP + RADIUS}
    frames = tuple(sf.Frame(name, (0.0, 0.0, z), turned[name]) for name, z in places.items())
    body = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(1.0))
    room = sf.RigidBody("room", sf.Joint("weld", "fixed"), sf.Inertia(), frames)
    return sf.compile(sf.System("walls", (room, body), gravity=(0, 0, 0), connections=walls))


def mjcf() -> str:
    """Planes of MuJoCo with the same stiffness by `solref`, without damping and friction."""
    soft = f'condim="1" solref="-{STIFFNESS!r} 0" solimp="{SOLIMP}"'
    far_off = GAP + RADIUS
    return (
        '<mujoco><option gravity="0 0 0"/><worldbody>'
        f'<geom type="plane" size="1 1 1" pos="0 0 {-far_off!r}" {soft}/>'
        f'<geom type="plane" size="1 1 1" pos="0 0 {far_off!r}" quat="0 1 0 0" {soft}/>'
        f'<body><joint type="slide" axis="0 0 1"/><geom type="sphere" size="{RADIUS!r}" mass="1" {soft}/></body>'
        "</worldbody></mujoco>"
    )


def prepare(quick: bool) -> Prepared:
    """The closed form, and the same in parts, each from where the one before ended."""
    given: dict[str, Any] = {"q0": [0.0], "v0": [SPEED], "t_end": END, "output": TIMES}
    one = SymofrosModel(LAW, ball(), given, lambda run: far(run.q[:, 0]))
    rtols = (1e-9,) if quick else (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
    steps = (1e-4,) if quick else (2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5)
    contestants: list[Contestant] = one.by("dopri5", rtols) + one.by("rk4", steps)
    model = loaded(mjcf())
    mujoco = MujocoModel(
        LAW, lambda _: model, np.zeros(1), np.array([SPEED]), len(TIMES) - 1, OUTPUT, lambda q: far(q[:, 0])
    )
    exudyn = ExudynModel(LAW, between_walls(STIFFNESS, GAP, SPEED), END, OUTPUT, lambda r: far(r.values[:, 0], r.t))
    if quick:
        contestants += mujoco.by("Euler", steps) + exudyn.by(Solver(), (2e-4,))
    else:
        for method in ("dop853", "rodas4"):
            contestants += one.by(method, rtols)
        for method in ("semi_implicit_euler", "generalized_alpha", "variational", "implicit_euler"):
            contestants += one.by(method, steps)
        for integrator in ("Euler", "implicitfast", "RK4"):
            contestants += mujoco.by(integrator, steps[:-1])
        for solver in (Solver(), Solver(radius=1.0), Solver("TrapezoidalIndex2")):
            contestants += exudyn.by(solver, steps[:-1])
        contestants += exudyn.by(Solver("RK44"), steps[:-1]) + exudyn.by(Solver("DOPRI5"), rtols[:5])
    return Prepared(tuple(contestants), far(_in_parts()), "the closed form; and the same from impact to impact")


def _in_parts() -> Array:
    """The motion from impact to impact: instants of touch and release, one after the other."""
    omega = math.sqrt(STIFFNESS)
    x, t, side, free = 0.0, 0.0, 1.0, True
    found = []
    ends = t + GAP / SPEED
    for time in TIMES.tolist():
        while time >= ends:
            t = ends
            if free:
                x, ends = side * GAP, t + math.pi / omega
            else:
                side, ends = -side, t + 2 * GAP / SPEED
            free = not free
        found.append(
            x + side * SPEED * (time - t) if free else side * (GAP + SPEED / omega * math.sin(omega * (time - t)))
        )
    return np.array(found)


PROBLEM = BenchmarkProblem(
    "A ball between two walls",
    f"A ball of 1 kg flies between two walls, {2 * GAP:g} m apart, at {SPEED:g} m/s, which throw it back by a "
    f"stiffness of {STIFFNESS:.0e} N/m: {IMPACTS} impacts of 10 ms in {END:g} s. Every side records "
    "its place each 0.1 s.",
    "place, largest over the run [m]",
    "error of the place  [m]",
    "MuJoCo: planes and a sphere with the same stiffness by `solref`, no damping, `solimp` as hard as it takes; Euler, "
    "implicitfast, RK4. Exudyn: one coordinate, walls by one of its symbolic functions, whose force follows within a "
    "step (its limit stops switch between steps); generalised alpha, its trapezoidal rule, RK44, DOPRI5.",
    prepare,
    (Target("MuJoCo", 1e-3, 1.0), Target("Exudyn", 1e-3, 1.0)),
    1e-9,
    ("closed form: flights and half swings on a spring",),
)
