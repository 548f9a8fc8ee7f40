"""A row of N four-bar linkages, which passes a singular posture each half turn: ours, and its exact motion."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

import symofros as sf

from ...mechanics.geometry import Array

GRAVITY = 9.81
# All bars are uniform, of 1 m and 1 kg; the cranks stand upright and their ends move along x with 1 m/s.
START = np.pi / 2, -1.0
BAR = sf.Inertia(1.0, (0.5, 0, 0), (0, 1 / 12, 1 / 12))
END_OF_BAR = (sf.Frame("end", (1.0, 0, 0)),)
AXIS = (0, -1, 0)


@cache
def linkage(loops: int, spacing: float = 1.0) -> sf.Model:
    """The row of `system`, compiled."""
    return sf.compile(system(loops, spacing))


def system(loops: int, spacing: float = 1.0) -> sf.System:
    """Cranks 0 to N on pivots, coupler i from crank i - 1 to the end of crank i, closed there.

    Args:
        loops: N.
        spacing: Distance of the pivots [m]; 1 makes parallelograms.
    """
    bodies, closures = [crank(0, spacing)], []
    for i in range(1, loops + 1):
        hinge = sf.Joint(f"b{i}", "revolute", f"crank{i - 1}", "end", axis=AXIS)
        bodies += [sf.RigidBody(f"coupler{i}", hinge, BAR, END_OF_BAR), crank(i, spacing)]
        pair = (f"crank{i}", "end"), (f"coupler{i}", "end")
        closures.append(sf.Closure(f"loop{i}", *pair, ("x", "z")))
    return sf.System(f"four_bars_{loops}", tuple(bodies), constraints=tuple(closures))


def crank(i: int, spacing: float = 1.0) -> sf.RigidBody:
    """A crank of a four-bar linkage, hinged to the ground; `spacing` is the distance between cranks [m]."""
    pivot = sf.Joint(f"a{i}", "revolute", position=(i * spacing, 0, 0), axis=AXIS)
    return sf.RigidBody(f"crank{i}", pivot, BAR, END_OF_BAR)


def state(m: sf.Model, angle: float, speed: float) -> tuple[Array, Array]:
    """Cranks at an angle and speed, couplers level."""
    signs = np.array([1.0 if name.startswith("a") else -1.0 for name in m.names.v])
    return signs * angle, signs * speed


def inertia(loops: int) -> tuple[float, float]:
    """J and V of J theta'' + V cos theta = 0: cranks turn, couplers move along with their ends."""
    return (loops + 1) / 3 + loops, ((loops + 1) / 2 + loops) * GRAVITY


@cache
def exact(loops: int, times: tuple[float, ...]) -> Array:
    """Angle and speed of the cranks (2, n) at rising times from 0."""
    J, V = inertia(loops)
    run = solve_ivp(
        lambda t, y: [y[1], -V / J * np.cos(y[0])], (0, times[-1]), START, "DOP853", times, rtol=1e-13, atol=1e-13
    )
    return np.asarray(run.y)


def tip_error(loops: int, t: float, tip: Array) -> float:
    """Distance of the first crank's end (x, z) at a time from where it should be [m]."""
    angle = exact(loops, (0.0, t))[0, -1]
    return float(np.linalg.norm(tip - np.array([np.cos(angle), np.sin(angle)])))


def mjcf(loops: int, integrator: str, h: float, solref: str, solimp: str, stated_at: float = START[0]) -> str:
    """The same for MuJoCo, with `connect` for each closure.

    Args:
        loops: N.
        integrator: MuJoCo's name of it.
        h: Step [s].
        solref: Time constant [s] and damping ratio of the closures.
        solimp: Their impedance.
        stated_at: Angle of the cranks where all its coordinates are zero; its softness is scaled by inertias there.
    """
    bar = '<inertial pos="0.5 0 0" mass="1" diaginertia="1e-9 0.08333333333333333 0.08333333333333333"/>'

    def body(name: str, at: str, turned: float, joint: str, inside: str = "") -> str:
        hinge = f'<joint name="{joint}" type="hinge" axis="0 -1 0"/>'
        return f'<body name="{name}" pos="{at}" axisangle="0 -1 0 {turned!r}">{hinge}{bar}{inside}</body>'

    couplers = [body(f"coupler{i}", "1 0 0", -stated_at, f"b{i}") for i in range(1, loops + 1)]
    cranks = [
        body(f"crank{i}", f"{i} 0 0", stated_at, f"a{i}", couplers[i] if i < loops else "") for i in range(loops + 1)
    ]
    closures = "".join(
        f'<connect body1="crank{i}" body2="coupler{i}" anchor="1 0 0" solref="{solref}" solimp="{solimp}"/>'
        for i in range(1, loops + 1)
    )
    return (
        f'<mujoco><compiler angle="radian"/><option timestep="{h!r}" integrator="{integrator}" '
        f'gravity="0 0 -{GRAVITY}"><flag contact="disable"/></option><worldbody>{"".join(cranks)}</worldbody>'
        f"<equality>{closures}</equality></mujoco>"
    )


def links(loops: int) -> list[tuple[tuple[float, float], float, float]]:
    """Each bar as (position of its start, angle, angular speed) at the start, cranks first, for other engines."""
    angle, speed = START
    cranks = [((float(i), 0.0), angle, speed) for i in range(loops + 1)]
    couplers = [((float(i), 1.0), 0.0, 0.0) for i, _ in pairwise(range(loops + 1))]
    return cranks + couplers
