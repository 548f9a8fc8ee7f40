"""Three angles past their singularity, against a quaternion."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.findings import Finding
from ..reference import data, source
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, cell, decades, simulate

END = 4.0
BOUND = 1e-6
ANGLES, BODY_RATES, QUATERNION = "three hinges, rk4", "angles by body rates, rk4", "quaternion, rk4"
NEAREST = Grid("least |cos pitch| on the way [-]", decades(1e-4, 0.3, 3), (1e-3, 0.1))
H = Grid("step h [s]", decades(2e-3, 1e-1, 5), (5e-3, 2e-2))
BODY = sf.Inertia(1.0, moments=(1.0, 3.0, 2.0))


@cache
def by_angles() -> sf.Model:
    """Yaw, pitch and roll as three hinges, two of them without mass."""
    axes = {"yaw": (0, 0, 1), "pitch": (0, 1, 0), "roll": (1, 0, 0)}
    bodies, parent = [], "world"
    for name, axis in axes.items():
        inertia = BODY if name == "roll" else sf.Inertia()
        bodies.append(sf.RigidBody(f"after_{name}", sf.Joint(name, "revolute", parent, axis=axis), inertia))
        parent = f"after_{name}"
    return sf.compile(sf.System("by_angles", tuple(bodies), gravity=(0, 0, 0)))


@cache
def by_quaternion() -> sf.Model:
    """A ball joint."""
    return sf.compile(
        sf.System("by_quaternion", (sf.RigidBody("after_roll", sf.Joint("ball", "ball"), BODY),), gravity=(0, 0, 0))
    )


def start(m: sf.Model, nearest: float) -> tuple[Array, Array]:
    """Rolled, so that a turn about the body's y axis passes the singularity at a distance."""
    roll = math.asin(nearest)
    if m.nq == 3:
        return np.array([0, 0, roll]), np.array([math.sin(roll), math.cos(roll), 0])
    return np.array([math.sin(roll / 2), 0, 0, math.cos(roll / 2)]), np.array([0.0, 1.0, 0.0])


def apart(attitude: Array, nearest: float) -> float:
    """Angle between an attitude at the end and the exact one, which is a steady turn about a principal axis [rad]."""
    c, s = math.cos(END), math.sin(END)
    tilt = math.asin(nearest)
    first = np.array([[1, 0, 0], [0, math.cos(tilt), -math.sin(tilt)], [0, math.sin(tilt), math.cos(tilt)]])
    turned = attitude.T @ first @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return math.atan2(float(np.linalg.norm(turned - turned.T)) / math.sqrt(2), float(np.trace(turned)) - 1)


def measure(model: Callable[[], sf.Model]) -> Callable[[float, float], Cell]:
    """RK4 with fixed steps."""

    def run(nearest: float, h: float) -> Cell:
        m = model()
        done = simulate(m, *start(m, nearest), END, dt=END / round(END / h), output=[0.0, END])
        return cell(done, lambda run: apart(run.frames["after_roll"][1][-1], nearest))

    return run


def textbook(nearest: float, h: float) -> Cell:
    """RK4 on Euler's equations in body rates, and on the angles' rates that follow from them."""
    moments = np.array(BODY.moments[:3], dtype=float)

    def rate(state: Array) -> Array:
        _, pitch, roll, *w = state
        turned = w[1] * np.sin(roll) + w[2] * np.cos(roll)
        with np.errstate(divide="ignore"):
            yaw_rate = turned / np.cos(pitch)
        angles = (yaw_rate, w[1] * np.cos(roll) - w[2] * np.sin(roll), w[0] + yaw_rate * np.sin(pitch))
        return np.concatenate([angles, np.cross(moments * w, w) / moments])

    state = np.array([0, 0, math.asin(nearest), 0, 1, 0], dtype=float)
    steps = round(END / h)
    step = END / steps
    for _ in range(steps):
        k1 = rate(state)
        k2 = rate(state + step / 2 * k1)
        k3 = rate(state + step / 2 * k2)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + rate(state + step * k3))
    return Cell(apart(by_angles().frame_pose("after_roll", state[:3])[1], nearest))


def effort(m: sf.Model, nearest: float) -> int:
    """Evaluations of DOP853 at a tolerance of 1e-8."""
    run = simulate(m, *start(m, nearest), END, method="dop853", rtol=1e-8, atol=1e-8)
    return run.statistics.evaluations


def judge(maps: Maps) -> Verdict:
    """Verdict from the maps, and from the cost of adaptive steps."""
    angles, quaternion = maps[ANGLES], maps[QUATERNION]
    rows = [row for row in data("euler_angles")["rows"] if row["min_cos_pitch"] in (0.3, 0.1, 0.01)]
    factors = []
    for row in rows:
        error = textbook(row["min_cos_pitch"], 0.01).value
        factors.append(max(error / row["err_rk4_h0p01"], row["err_rk4_h0p01"] / error))
    far, near = effort(by_angles(), 0.3), effort(by_angles(), 1e-4)
    steady = effort(by_quaternion(), 0.3), effort(by_quaternion(), 1e-4)
    spread = float(np.ptp(np.log10(np.maximum(quaternion.values, 1e-16)), axis=1).max())
    findings = (
        Finding(
            "angles by body rates: factor between known and found errors at h = 10 ms",
            max(factors),
            3.0,
            reason="another program, Euler's equations with zyx angles",
        ),
        Finding(
            "quaternion: largest error on the map over h⁴ [rad/s⁴]",
            float((quaternion.values / quaternion.y[:, None] ** 4).max()),
            1.0,
            reason="its order, whatever the attitude",
        ),
        Finding(
            "three angles, 1e-4 from the singularity: evaluations over those at 0.3",
            near / far,
            10.0,
            2.0,
            "adaptive steps feel it",
        ),
        Finding("quaternion: the same", steady[1] / steady[0], 1.1, 0.9, "there is nothing to feel"),
    )
    edge = angles.good.mean()
    rates = maps[BODY_RATES]
    statement = (
        "The angles' rates grow as 1/|cos pitch|, so fixed steps jump across: with three hinges, whose rates are "
        f"the speeds, {edge:.0%} of the map is good, {angles.stopped} of {angles.values.size} runs stop as "
        f"diverged, and {angles.wrong} come to their end and miss the attitude by up to "
        f"{np.nanmax(angles.values):.1f} rad. Angles that follow from body rates, as textbooks have it, are gentler "
        f"({rates.good.mean():.0%}) and miss silently ({rates.wrong} runs). Adaptive DOP853 stays right and pays "
        f"{near / far:.1f} times the evaluations of a passage at 0.3 ({near} against {far}). The quaternion does "
        f"not know of the posture: it needs {steady[1]} evaluations at any distance, its map varies along a row by "
        f"rounding only ({spread:.1f} decades), and it is exact, because its steps turn the body and this turn is "
        "steady."
    )
    see = (
        "In the first two maps the edge rises with the distance from the singularity; below it the step is short "
        "against the passage. The last, the same body on a ball joint, is level."
    )
    return Verdict(statement, see, findings)


STUDY = ParameterStudy(
    "What happens when Euler angles pass their singularity?",
    "A free body of moments 1, 3, 2 kg m² turns about its second axis at 1 rad/s for 4 s, past a pitch of 90 "
    "degrees at a distance; the exact motion is a steady turn.",
    NEAREST,
    H,
    "angle from the exact attitude after 4 s [rad]",
    BOUND,
    (Subject(ANGLES, measure(by_angles)), Subject(BODY_RATES, textbook), Subject(QUATERNION, measure(by_quaternion))),
    judge,
    "a ball or free joint, whose quaternion has no singularity and costs less. Where three hinges are real, as in a "
    "wrist, adaptive steps.",
    (source("euler_angles"),),
)
