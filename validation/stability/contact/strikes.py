"""Rods and boxes that strike the ground with friction: ours, Routh's closed form, and engines as steps get shorter."""

from __future__ import annotations

import math

import numpy as np

from ...mechanics.geometry import Array
from ...mechanics.touching_body import TouchingBody
from ...reporting.findings import Finding
from ..study import Maps, ParameterStudy, Subject, Verdict
from . import bullet_contact, dart_contact, drake_contact
from .motions import BOUND, BULLET, DART, EXUDYN, LAGGED, METHODS, MUJOCO, STEP, WHO, measure, reference

_ABOVE, _HALF, _TIP = 0.01, 0.4, 0.02
_EDGES, _ROUND = (0.3, 0.2, 0.12), 0.01
SAP = "Drake, SAP"


def _rod(tilt: float, friction: float, slip: float, spin: float = 0.0, restitution: float = 0.0) -> TouchingBody:
    """A rod of 1 kg and 0.8 m, leaning, whose lower tip comes down at 1 m/s."""
    place = (0.0, 0.0, _ABOVE + _TIP + _HALF * math.cos(tilt))
    moments, points = (0.05, 0.05, 1e-3), ((0.0, 0.0, -_HALF),)
    way, turn = ((slip, 0.0, -1.0), (0.0, spin, 0.0)), (0.0, tilt, 0.0)
    law = {"restitution": restitution, "strikes": True}
    return TouchingBody(1.0, moments, friction, place, *way, 0.15, _TIP, turn, points=points, **law)  # type: ignore[arg-type]


def _box() -> TouchingBody:
    """A box of 2 kg, leaning, whose lower edge comes down at 1 m/s: two of its corners strike at once."""
    mass, tilt = 2.0, 0.6
    a, b, c = _EDGES
    place = (0.0, 0.0, _ABOVE + _ROUND + 0.5 * (a * math.sin(tilt) + c * math.cos(tilt)))
    moments = (mass / 12 * (b * b + c * c), mass / 12 * (a * a + c * c), mass / 12 * (a * a + b * b))
    corners = tuple((x * a / 2, y * b / 2, z * c / 2) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))
    way, turn = ((1.2, 0.0, -1.0), (0.0, 0.0, 0.0)), (0.0, tilt, 0.0)
    return TouchingBody(mass, moments, 0.3, place, *way, 0.1, _ROUND, turn, points=corners, strikes=True)


SLIDES, STICKS, TURNS = "a rod slides on", "a rod sticks", "a rod whose slip turns round"
EDGE, THROWN = "a box slides on an edge", "a rod is thrown back, e = 0.5"
BODIES = {
    SLIDES: _rod(0.5, 0.2, 1.5, 1.0),
    STICKS: _rod(0.3, 0.8, 0.4),
    TURNS: _rod(0.9, 0.2, 0.2),
    EDGE: _box(),
    THROWN: _rod(0.5, 0.2, 2.5, 1.0, restitution=0.5),
}
# Those of one direction of slip, where all laws of friction in a plastic impact agree.
_AGREED = (SLIDES, STICKS)


def routh(W: Array, u: Array, friction: float, restitution: float = 0.0) -> Array:
    """Impulse along x and z of a strike in a plane (2) [N s]: friction along the normal impulse as it grows.

    Args:
        W: Inverse inertia at the point that strikes, along x and z (2, 2) [1/kg].
        u: Its velocity before (2) [m/s].
        friction: Coefficient.
        restitution: Where the slip does not stop: all coefficients of restitution agree there.
    """
    h = np.array([-math.copysign(friction, u[0]), 1.0])
    slip, rise = W @ h
    ends, stops = -(1.0 + restitution) * u[1] / rise, -u[0] / slip if slip * u[0] < 0.0 else math.inf
    if ends <= stops:
        return np.asarray(ends * h)
    held = -W[0, 1] / W[0, 0]
    then = np.array([held if abs(held) <= friction else math.copysign(friction, held), 1.0])
    return np.asarray(stops * h - (u[1] + stops * rise) / float((W @ then)[1]) * then)


def beyond(body: TouchingBody) -> float:
    """Largest distance of our velocity after the strike from Routh's [m/s, rad/s]."""
    event = reference(body).events[0]
    angle = 2.0 * math.atan2(event.q[4], event.q[6])
    x, z = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]]) @ min(
        ((x, z) for x, _, z in body.points), key=lambda at: at[1] * math.cos(angle) - at[0] * math.sin(angle)
    )
    z, inverse = z - body.radius, 1.0 / body.moments[1]
    # Velocity of the centre along x and z of the world, and angular velocity about y, before and after.
    turn = np.array([[math.cos(angle), math.sin(angle), 0], [-math.sin(angle), math.cos(angle), 0], [0, 0, 1.0]])
    before, after = (turn @ np.asarray(v)[[0, 2, 4]] for v in (event.v, event.v_after))
    J = np.array([[1.0, 0.0, z], [0.0, 1.0, -x]])
    to_speeds = np.diag([1.0 / body.mass, 1.0 / body.mass, inverse]) @ J.T
    known = before + to_speeds @ routh(J @ to_speeds, J @ before, body.friction, body.restitution)
    return float(np.abs(after - known).max())


def judge(maps: Maps) -> Verdict:
    """Verdict on whether engines come to a plastic strike as their steps get shorter."""
    rows = {WHO.label(y): k for k, y in enumerate(next(iter(maps.values())).y)}

    def finest(who: str, *names: str) -> float:
        return max(float(np.nan_to_num(maps[name].values[rows[who]][0])) for name in names)

    ours = max(finest(who, *maps) for who in METHODS)
    exact = max(beyond(body) for body in BODIES.values())
    installed = {DART: dart_contact.INSTALLED, BULLET: bullet_contact.INSTALLED}
    installed |= dict.fromkeys((SAP, LAGGED), drake_contact.INSTALLED) | dict.fromkeys((EXUDYN, MUJOCO), True)

    def far(name: str, *engines: str) -> str:
        return "; ".join(f"{who} {1e3 * finest(who, name):.2g} mm" for who in engines if installed[who])

    findings = (
        Finding("ours: speeds after a strike, against Routh's closed form", exact, 1e-9, reason="rounding"),
        Finding("rk4, rodas4: distance from dop853 at the shortest step [m]", ours, 1e-6, reason="order 4"),
        *(
            Finding(f"{who}: distance from ours where slips do not turn round [m]", finest(who, *_AGREED), BOUND)
            for who in (EXUDYN, MUJOCO, SAP, BULLET)
            if installed[who]
        ),
    )
    agreed = max(finding.value for finding in findings[2:])
    statement = (
        f"Our speeds after a strike are Routh's to {exact:.0e}. Where the slip of a rod does not turn round, Exudyn, "
        f"MuJoCo, Drake's SAP and PyBullet come to our motion, to {agreed:.0e} m at the shortest step. Where it turns "
        "round in the strike, so does friction on the way; engines that take a strike in one step have friction "
        "against the last slip alone, and in Exudyn it is of the elastic part of the force, which comes late: off by "
        f"{far(TURNS, EXUDYN, MUJOCO, SAP, BULLET)} at any step. A box on its edge: "
        f"{far(EDGE, EXUDYN, BULLET, MUJOCO, SAP, LAGGED, DART)}. MuJoCo and SAP lift it by friction times its slip, "
        "as their cones are convex; Drake's lagged friction is of the force a step before, and DART's of a normal "
        "force that is found without friction. With e = 0.5, which only these state, "
        f"{far(THROWN, BULLET, DART) or 'none here'}: PyBullet slows the rod before it touches, and then does not "
        "throw it back."
    )
    see = "Rows of engines get bluer to the left where the slip keeps its direction, and stay as they are elsewhere."
    return Verdict(statement, see, findings)


STUDY = ParameterStudy(
    "Do strikes with friction end as in other engines?",
    "A leaning rod of 1 kg, or a box of 2 kg on its edge, comes down at 1 m/s with a slip along the ground, without "
    "restitution: friction lets it slide on, stops it, or turns its slip round. Engines that state no restitution damp "
    "their contacts beyond the critical rate: MuJoCo thrice (`solref`), Drake's SAP by a relaxation over four steps, "
    "its lagged approximation by Hunt and Crossley's dissipation, Exudyn by a damper. One rod more is thrown back, "
    "with e = 0.5.",
    STEP,
    WHO,
    "distance from our motion by dop853 at 1e-12 [m]",
    BOUND,
    tuple(Subject(name, measure(body)) for name, body in BODIES.items()),
    judge,
    "in engines, several steps a strike, and a look at where slips turn round; a strike with friction has no law that "
    "all share.",
    ("E. J. Routh, Dynamics of a system of rigid bodies; ours by dop853",),
)
