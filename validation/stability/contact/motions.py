"""Bodies that slide, stick, roll, bounce and strike: ours, and those of engines as their steps get shorter."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import symofros as sf

from ...adapters.exudyn import contact as exudyn_contact
from ...adapters.mujoco import motion as mujoco_motion
from ...mechanics.geometry import Array
from ...mechanics.touching_body import GRAVITY, Pose, TouchingBody
from ...reporting.findings import Finding
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, cell, simulate
from . import bullet_contact, dart_contact, drake_contact

BOUND = 1e-3
STEP = Grid("step [s]", (1.25e-4, 2.5e-4, 5e-4, 1e-3), (2.5e-4, 5e-4))
METHODS, LAGGED, MUJOCO, EXUDYN = ("rk4", "rodas4"), "Drake, lagged", "MuJoCo", "Exudyn"
# Name of the contact model: Drake's own name of its approximation.
DRAKE = {LAGGED: "kLagged", "Drake, SAP": "kSap"}
BULLET, DART = "PyBullet", "DART"
WHO = Grid.of("method or engine [-]", (*METHODS, *DRAKE, MUJOCO, EXUDYN, BULLET, DART))
# Engines that are no part of the validation extra.
_EXTRAS = dict.fromkeys(DRAKE, drake_contact) | {BULLET: bullet_contact, DART: dart_contact}
_SLOW = 1e-4  # Speed over which friction of compliant contacts grows, as Drake's does by its default [m/s].
_LIES = math.pi / 2


def _stool() -> tuple[tuple[float, float, float], ...]:
    return tuple((0.2 * math.cos(angle), 0.2 * math.sin(angle), -0.1) for angle in (0.3, 2.3, 4.6))


def _stick() -> TouchingBody:
    """Tilted by half a radian, as rolling along the log leaves it."""
    angle, radius, log = 0.5, 0.05, (0.2, 0.6)
    c, s, top = math.cos(angle), math.sin(angle), log[0] + radius
    p = (top * s - log[0] * angle * c, 0.0, top * c + log[0] * angle * s)
    turn, still = (0.0, _LIES + angle, 0.0), (0.0, 0.0, 0.0)
    moments = (0.05, 0.05, 1e-3)
    return TouchingBody(1.0, moments, 5.0, p, still, still, 0.8, radius, turn, "capsule", half=0.4, log=log)


def _cylinder() -> TouchingBody:
    """Tilted, on its lower rim, which rolls."""
    mass, radius, half, w = 0.5, 0.08, 0.03, (1.0, -8.0, 12.0)
    turn = (0.9, 0.0, 0.0)
    a = Rotation.from_rotvec(turn).as_matrix()[:, 2]
    upwards = np.array([0.0, 0.0, 1.0]) - a[2] * a
    low = -radius * upwards / np.linalg.norm(upwards) - half * a
    v = tuple((-np.cross(w, low)).tolist())
    across = mass * (radius**2 / 4 + half**2 / 3)
    moments = (across, across, mass * radius**2 / 2)
    return TouchingBody(mass, moments, 5.0, (0.0, 0.0, -float(low[2])), v, w, 0.2, radius, turn, "cylinder", half=half)


def _ball(
    friction: float,
    height: float,
    v: tuple[float, float, float],
    w: tuple[float, float, float],
    end: float,
    **more: Any,
) -> TouchingBody:
    return TouchingBody(1.0, (4e-3,) * 3, friction, (0.0, 0.0, 0.1 + height), v, w, end, 0.1, **more)


_BOUNCES = (0.05, (3.0, 0.5, 0.0), (3.0, 5.0, 4.0), 1.0)
BODIES = {
    "a ball slides, then rolls": _ball(0.3, 0.0, (2.0, 0.5, 0.0), (3.0, -10.0, 4.0), 0.8),
    "a stool of three feet spins to rest": TouchingBody(
        2.0, (0.03, 0.05, 0.04), 0.4, (0, 0, 0.12), (1.5, 0.4, 0), (0, 0, 8.0), 1.0, 0.02, points=_stool()
    ),
    "a stick rocks across a log": _stick(),
    "a tilted cylinder rolls on its rim": _cylinder(),
    "a compliant ball bounces": _ball(0.02, *_BOUNCES, stiffness=1e5),
    "a compliant ball bounces and loses": _ball(0.0, *_BOUNCES, stiffness=1e5, dissipation=0.3),
}


@cache
def model(body: TouchingBody) -> sf.Model:
    """A body and what it touches, as we state it."""
    law: dict[str, Any] = {"restitution": body.restitution, "friction": body.friction}
    if body.stiffness:
        law = {"stiffness": body.stiffness, "exponent": 1.0, "dissipation": body.dissipation}
        law |= {"friction": body.friction, "minimum_velocity": _SLOW}
    log = sf.Frame("log", rotation=sf.Rotation.axis_angle((1, 0, 0), _LIES))
    base = sf.RigidBody("base", sf.Joint("base", "fixed"), frames=(log,))
    shapes: dict[str, dict[str, Any]] = {
        "balls": {"radius": body.radius, "points": body.points},
        "cylinder": {"rim": body.radius, "points": ((0, 0, -body.half), (0, 0, body.half))},
        "capsule": {
            "radius": body.radius,
            "segment": 2 * body.half,
            "surface": "capsule",
            "surface_radius": body.log[0],
            "length": body.log[1],
        },
    }
    moves = sf.RigidBody("body", sf.Joint("free", "free"), sf.Inertia(body.mass, moments=body.moments))
    contact = sf.Contact(
        "contact", ("body", None), ("base", "log" if body.shape == "capsule" else None), **shapes[body.shape], **law
    )
    return sf.compile(sf.System("touching", (base, moves), gravity=(0, 0, -GRAVITY), connections=(contact,)))


def run(body: TouchingBody, **given: Any) -> sf.Trajectory:
    """Our motion, at its start and end."""
    start, speeds = np.r_[body.p, body.xyzw], np.r_[body.R.T @ body.v, body.R.T @ body.w]
    return simulate(model(body), start, speeds, t_end=body.end, output=[0.0, body.end], **given)


def pose(body: TouchingBody, moved: sf.Trajectory) -> Pose:
    """Pose of the body at the end of a run."""
    return Pose(*map(np.asarray, model(body).frame_pose("body", moved.q[-1])))


@cache
def reference(body: TouchingBody) -> sf.Trajectory:
    """Our motion by steps that choose themselves."""
    return run(body, method="dop853", rtol=1e-12, atol=1e-13)


def measure(body: TouchingBody) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of a body's map, by step and method or engine."""

    def measured(h: float, who: float) -> Cell:
        by, known = WHO.label(who), pose(body, reference(body))
        if by in METHODS:
            moved = run(body, method=by, adaptive=False, dt=h)
            return cell(moved, lambda moved: pose(body, moved).far(known))
        refusal = _refusal(body, by)
        return Cell(math.nan, "refused", refusal) if refusal else Cell(_by_engine(by, body, h).far(known))

    return measured


def _refusal(body: TouchingBody, by: str) -> str:
    """Why an engine does not move a body; "": it does."""
    if by in _EXTRAS and not _EXTRAS[by].INSTALLED:
        return str(_EXTRAS[by].MISSING)
    balls_alone = by in (EXUDYN, BULLET, DART)
    if (
        (balls_alone and body.shape != "balls")
        or (by in (BULLET, DART) and body.stiffness)
        or (by not in DRAKE and body.dissipation)
    ):
        return "no such shape, or another law of losses"
    return "no coefficient of restitution" if body.restitution and by not in (BULLET, DART) else ""


def _by_engine(by: str, body: TouchingBody, h: float) -> Pose:
    if by in DRAKE:
        return drake_contact.moved(DRAKE[by], body, h)
    move = {MUJOCO: by_mujoco, EXUDYN: exudyn_contact.moved, BULLET: bullet_contact.moved, DART: dart_contact.moved}
    return move[by](body, h)


def by_mujoco(body: TouchingBody, h: float) -> Pose:
    """Pose by MuJoCo's soft contacts: rigid ones as stiff as a step of h allows, by its elliptic cones.

    A strike at the critical rate of damping bounces by what a step has missed, thrice that rate does not.
    """
    stiff = f'solref="{-body.stiffness!r} 0" solimp="0.9999 0.9999 0.001 0.5 2"'
    soft = stiff if body.stiffness else f'solref="{2 * h!r} {3 if body.strikes else 1}" solimp="0.999 0.9999 1e-5"'
    soft = f'{soft} friction="{body.friction!r} 0 0" condim="3"'
    solid = f'<geom type="{body.shape}" size="{body.radius!r} {body.half!r}" {soft}/>'
    ground = f'<geom type="plane" size="5 5 1" {soft}/>'
    if body.shape == "balls":
        solid = "".join(
            f'<geom type="sphere" size="{body.radius!r}" pos="{x!r} {y!r} {z!r}" {soft}/>' for x, y, z in body.points
        )
    elif body.shape == "capsule":
        radius, length = body.log
        ground = f'<geom type="capsule" size="{radius!r} {length / 2!r}" euler="90 0 0" {soft}/>'
    text = (
        f'<mujoco><option timestep="{h!r}" gravity="0 0 {-GRAVITY!r}" cone="elliptic" impratio="1000" '
        f'tolerance="1e-14" integrator="{"Euler" if body.stiffness else "implicitfast"}"/><worldbody>{ground}<body>'
        f'<freejoint/><inertial pos="0 0 0" mass="{body.mass!r}" diaginertia="{" ".join(map(repr, body.moments))}"/>'
        f"{solid}</body></worldbody></mujoco>"
    )
    wxyz = np.roll(body.xyzw, 1)
    moved = mujoco_motion.move(text, np.r_[body.p, wxyz], np.r_[body.v, body.R.T @ body.w], body.end, 1)
    return Pose(moved.q[:3], np.asarray(Rotation.from_quat(np.roll(moved.q[3:], -1)).as_matrix()))


def judge(maps: Maps) -> Verdict:
    """Verdict on whether engines come to our motions as their steps get shorter, and on our implicit method."""
    rows = {WHO.label(y): k for k, y in enumerate(next(iter(maps.values())).y)}

    def finest(who: str, chosen: Callable[[TouchingBody], bool] = lambda _: True) -> float:
        return max(float(np.nan_to_num(one.values[rows[who]][0])) for name, one in maps.items() if chosen(BODIES[name]))

    def falls(who: str, name: str) -> float:
        values: Array = maps[name].values[rows[who]]
        return float((values[-1] / values[0]) ** (1.0 / (len(values) - 1)))

    rigid = [name for name, body in BODIES.items() if not body.stiffness]
    rolling = [name for name in rigid if BODIES[name].friction > 1.0]
    findings = [
        Finding(f"{who}: distance from ours at its shortest step [m]", finest(who, chosen), BOUND, reason=reason)
        for who, chosen, reason in (
            # In its continuous plant forces act midway between the two surfaces.
            (LAGGED, lambda body: not (body.stiffness and body.friction), "proportional to the step"),
            (EXUDYN, lambda _: True, "as stiff as steps follow"),
        )
        if who == EXUDYN or drake_contact.INSTALLED
    ]
    near = ", ".join(f"{finding.quantity.split(':')[0]} {finding.value:.1g} m" for finding in findings)
    halved = [falls(MUJOCO, name) for name in rolling]
    halved += [falls(LAGGED, name) for name in rigid] if drake_contact.INSTALLED else []
    least, ours = min(halved), finest("rodas4", lambda body: not body.stiffness)
    findings += [
        Finding("rodas4, rigid: distance from dop853 at the shortest step [m]", ours, 1e-6, reason="order 4"),
        Finding("rodas4, compliant: the same [m]", finest("rodas4"), 1e-3, reason="steps across the surface"),
        Finding("engines, rigid: least factor by which halving a step brings them nearer", least, math.inf, 1.7),
    ]
    sliding = max(maps[name].values[rows[MUJOCO]][0] for name in rigid if name not in rolling)
    statement = (
        f"Engines come to our motions as their steps get shorter. At the shortest they are off by at most: {near}; of "
        f"rigid bodies {least:.2g} times as much or more at twice the step. Our rodas4 is off by {ours:.0e} m there. "
        "Bodies that roll move so in MuJoCo, too; one that begins to slide is lifted there by its convex cones, and "
        f"off by {100 * sliding:.1g} cm at any step, as in Drake's SAP. Compliant balls that slip differ in Drake by "
        "2 mm: there friction acts midway between the two surfaces, here at the one of the ground."
    )
    see = (
        "Rows of ours and of engines with Coulomb's friction get bluer to the left. MuJoCo and SAP stay orange where "
        "bodies slide: their cones are those of a convex problem, which gives a slip a normal speed."
    )
    return Verdict(statement, see, tuple(findings))


STUDY = ParameterStudy(
    "Do bodies that touch move as in other engines?",
    "Rigid: a ball of 1 kg that slides and spins until it rolls, a stool of three feet, a stick of 1 kg that rocks "
    "across a log, a tilted cylinder that rolls on its rim. Compliant, 1e5 N/m: a ball that slips as it bounces, and "
    "one without friction that loses energy by Hunt and Crossley's law. Each engine's contacts are as stiff as its "
    "step allows, or as stiff as ours; Exudyn's general contact has balls alone, and neither it nor MuJoCo this loss.",
    STEP,
    WHO,
    "distance from our motion by dop853 at 1e-12 [m]",
    BOUND,
    tuple(Subject(name, measure(body)) for name, body in BODIES.items()),
    judge,
    "steps that choose themselves; with fixed ones rk4, rodas4. In Drake the lagged approximation where bodies slide.",
    ("ours by dop853; each engine's limit",),
)
