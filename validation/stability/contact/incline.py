"""A block on an incline: what friction holds, by each of our forms of it, by MuJoCo's cones, by Drake and by Exudyn."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import symofros as sf

from ...adapters.exudyn import contact as exudyn_contact
from ...adapters.mujoco import motion as mujoco_motion
from ...reporting.findings import Finding
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, cell, longest, simulate
from . import drake_contact

FRICTION, GRAVITY, STIFFNESS, RADIUS = 0.5, 9.81, 1e5, 0.1
SLOW = 1e-3
SETTLED, END = 1.0, 11.0
BOUND = 1e-6
SMOOTH, BRISTLES = "smooth contact, 1 mm/s", "contact with bristles"
RIGID, HELD = "rigid contact", "joint that sticks"
ENGINES = {
    "MuJoCo, pyramids": 'cone="pyramidal"',
    "MuJoCo, cones": 'cone="elliptic"',
    "MuJoCo, cones, impratio 100": 'cone="elliptic" impratio="100"',
    "MuJoCo, pyramids, noslip": 'cone="pyramidal" noslip_iterations="10"',
}
# Name of the contact model: Drake's own name of its approximation. The first one is its default.
DRAKE = {"Drake, lagged": "kLagged", "Drake, SAP": "kSap", "Drake, TAMSI": "kTamsi"}
EXUDYN = "Exudyn, general contact"
SHARES = (0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999, 1.001, 1.01, 1.1, 1.5)
LOAD = Grid.of("load over what friction carries, tan α/μ [-]", tuple(map(str, SHARES)), ("0.5", "0.999", "1.001"))
FORMS = SMOOTH, BRISTLES, RIGID, HELD
WHO = Grid.of("friction [-]", (*FORMS, *ENGINES, *DRAKE, EXUDYN), (SMOOTH, BRISTLES, RIGID, HELD, "MuJoCo, cones"))
STEPS = (1e-3, 4e-3)
MJCF = (
    '<mujoco><option timestep="{h!r}" integrator="implicitfast" gravity="{gx!r} 0 {gz!r}" {cone}/><worldbody>'
    '<geom type="plane" size="100 1 1" friction="{mu!r} 0 0"/><body pos="0 0 {r!r}">'
    '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
    '<geom type="sphere" size="{r!r}" mass="1" friction="{mu!r} 0 0"/></body></worldbody></mujoco>'
)


@cache
def block(form: str) -> sf.Model:
    """1 kg that moves along x and z; gravity leans by run-time parameters."""
    gravity = (sf.formula("gx", "acceleration"), 0.0, sf.formula("gz", "acceleration"))
    parameters = (sf.Parameter("gx", 0.0), sf.Parameter("gz", -GRAVITY), sf.Parameter("carried", 1.0))
    bristles = {"bristle_stiffness": STIFFNESS, "bristle_damping": 2 * math.sqrt(STIFFNESS)}
    yields = {"stiffness": STIFFNESS, "exponent": 1.0, "dissipation": 5.0}
    more: dict[str, dict[str, Any]] = {
        SMOOTH: {"friction": FRICTION, "minimum_velocity": SLOW} | yields,
        BRISTLES: {"friction": FRICTION} | bristles | yields,
        RIGID: {"friction": FRICTION, "restitution": 0.0},
    }
    floor = sf.Contact("floor", ("block", None), ("world", None), radius=RADIUS, **more.get(form, yields))
    dry = (sf.Friction(sf.formula("carried", "force"), sticks=True),) if form == HELD else ()
    along = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=dry)
    upright = sf.Joint("z", "prismatic", "along", axis=(0, 0, 1))
    bodies = (sf.RigidBody("along", along, sf.Inertia()), sf.RigidBody("block", upright, sf.Inertia(1.0)))
    return sf.compile(sf.System("incline", bodies, parameters, gravity=gravity, connections=(floor,)))


def gravity(share: float) -> tuple[float, float]:
    """Parts of gravity along x and z where tan alpha is that share of the coefficient of friction [m/s^2]."""
    alpha = math.atan(share * FRICTION)
    return GRAVITY * math.sin(alpha), -GRAVITY * math.cos(alpha)


def beyond(share: float, middle: tuple[float, float], last: float) -> float:
    """Distance from Coulomb's motion at the end [m], from where the block is at SETTLED.

    Args:
        share: tan alpha over the coefficient of friction; above 1 the block slides.
        middle: Place and speed along the incline at SETTLED [m, m/s].
        last: Place at END [m].
    """
    x, v = middle
    gx, gz = gravity(share)
    time = END - SETTLED
    moved = v * time + 0.5 * (gx + FRICTION * gz) * time**2 if share > 1.0 else 0.0
    return abs(last - x - moved)


def measure(h: float) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of the map, by load and form, by steps of h."""

    def run(load: float, who: float) -> Cell:
        share, name = float(LOAD.label(load)), WHO.label(who)
        if name in ENGINES:
            return by_mujoco(name, share, h)
        if name in DRAKE:
            return by_drake(name, share, h)
        if name == EXUDYN:
            middle, last = exudyn_contact.slid(FRICTION, RADIUS, STIFFNESS, gravity(share), h, (SETTLED, END))
            return Cell(beyond(share, middle, last[0]))
        run = slid(name, share, h)
        return cell(run, lambda run: beyond(share, (float(run.q[1, 0]), float(run.v[1, 0])), float(run.q[2, 0])))

    return run


def slid(form: str, share: float, h: float) -> sf.Trajectory:
    """Motion of the block from rest, at 0, SETTLED and END."""
    gx, gz = gravity(share)
    model = block(form).with_parameters(gx=gx, gz=gz, carried=-FRICTION * gz)
    start = [0.0, RADIUS + (gz / STIFFNESS if form != RIGID else 0.0)]
    # Bristles bent as the load asks: at 0.999 of the limit a block that has been let go stops after millimetres.
    bent = [min(gx, -FRICTION * gz) / STIFFNESS, 0.0] if form == BRISTLES else None
    given = {"method": "rk4" if form in (HELD, RIGID) else "rodas4", "adaptive": False, "output": [0.0, SETTLED, END]}
    return simulate(model, start, t_end=END, dt=h, z0=bent, **given)


def by_mujoco(name: str, share: float, h: float) -> Cell:
    """The same block as MuJoCo holds it, by its default softness."""
    gx, gz = gravity(share)
    text = MJCF.format(h=h, gx=gx, gz=gz, cone=ENGINES[name], mu=FRICTION, r=RADIUS)
    middle = mujoco_motion.move(text, np.zeros(2), np.zeros(2), SETTLED, 1)
    last = mujoco_motion.move(text, middle.q, middle.v, END - SETTLED, 1)
    if middle.warning or last.warning:
        return Cell(math.nan, "diverged", middle.warning or last.warning)
    return Cell(beyond(share, (float(middle.q[0]), float(middle.v[0])), float(last.q[0])))


def by_drake(name: str, share: float, h: float) -> Cell:
    """The same block as Drake holds it, by the properties that it has by default."""
    if not drake_contact.INSTALLED:
        return Cell(math.nan, "refused", drake_contact.MISSING)
    gravities = gravity(share)
    middle, last = drake_contact.slid(DRAKE[name], FRICTION, RADIUS, gravities, h, (SETTLED, END))
    return Cell(beyond(share, middle, last[0]))


def creep(share: float) -> float:
    """Speed at which smooth friction carries that share of what it can [m/s]: theory/rigid.md, 10.2."""
    below = longest(lambda xi: xi * (15.0 - 10.0 * xi**2 + 3.0 * xi**4) / 8.0 < share, 1e-6 * share, 1.0, 1e-14)
    return below * 15.0 / 8.0 * SLOW


def judge(maps: Maps) -> Verdict:
    """Verdict on who holds, who creeps, and by how much."""
    first = next(iter(maps.values()))
    shares = np.array([float(LOAD.label(x)) for x in first.x])
    rows = {WHO.label(y): k for k, y in enumerate(first.y)}
    stuck = shares < 1.0

    def worst(name: str, chosen: np.ndarray) -> float:
        return max(float(one.values[rows[name]][chosen].max()) for one in maps.values())

    held = {name: worst(name, stuck) for name in rows}
    crept = [
        one.values[rows[SMOOTH]][k] / (creep(share) * (END - SETTLED)) - 1.0
        for one in maps.values()
        for k, share in enumerate(shares)
        if share < 0.995
    ]
    slides = (END - SETTLED) ** 2 / 2 * GRAVITY
    findings = (
        Finding("rigid contact: creep in 10 s [m]", held[RIGID], 0.0, reason="a mode: the slip is bound to zero"),
        Finding("joint that sticks: creep in 10 s [m]", held[HELD], 0.0, reason="a mode: the rate is bound to zero"),
        Finding(
            "bristles: creep in 10 s, loads up to 0.999 of what friction carries [m]",
            held[BRISTLES],
            1e-9,
            reason="bristles hold",
        ),
        Finding(
            "smooth contact: creep against its closed form, relative",
            float(np.abs(crept).max()),
            1e-3,
            reason="the speed at which the polynomial carries the load",
        ),
        Finding(
            "ours, sliding: distance from the closed form in 10 s over g t²/2",
            max(worst(name, ~stuck) for name in FORMS) / slides,
            1e-4,
            reason="friction lags while bristles bend, by micrometres of speed times 10 s",
        ),
    )
    asked = (name for name in rows if name in (*ENGINES, EXUDYN) or (name in DRAKE and drake_contact.INSTALLED))
    others = ", ".join(f"{name} {held[name]:.1g} m" for name in asked)
    statement = (
        f"Below the limit of friction Coulomb's block stays. In 10 s a rigid contact creeps by {held[RIGID]:.1g} m, "
        f"a joint that sticks by {held[HELD]:.1g} m, a contact with bristles by {held[BRISTLES]:.1g} m, smooth "
        f"friction by {held[SMOOTH]:.1g} m, at the speed of its closed form. At most "
        f"over the loads: {others}: constraints are soft there, "
        "and friction is regularised: by `impratio`, or over a speed. Above the limit ours slide at the closed form's "
        "acceleration."
    )
    see = (
        "Columns left of 1 should be blue: the block stays there. Rows of smooth friction, of MuJoCo's soft cones, "
        "of Drake and of Exudyn are orange: the block creeps, the faster the nearer to the limit."
    )
    return Verdict(statement, see, findings)


STUDY = ParameterStudy(
    "Does friction hold on an incline?",
    f"A block of 1 kg rests on an incline, μ = {FRICTION:g}; after {SETTLED:g} s for settling its motion over "
    f"{END - SETTLED:g} s is compared with Coulomb's: none up to tan α = μ, the closed form beyond. MuJoCo by its "
    "default softness, implicitfast; Drake by its default contact, lagged, and two others that it offers; Exudyn by "
    "its general contact, as stiff as ours.",
    LOAD,
    WHO,
    "distance from Coulomb's motion after 10 s [m]",
    BOUND,
    tuple(Subject(f"steps of {1e3 * h:g} ms", measure(h)) for h in STEPS),
    judge,
    "rigid contacts, or bristles for compliant ones, `sticks=True` for joints; smooth friction only where what matters "
    "moves much faster than "
    "its `minimum_velocity`. In MuJoCo elliptic cones with a large impratio, or noslip iterations.",
    ("Coulomb's law; polynomial of smooth friction in docs/theory/rigid.md, 10.2",),
)
