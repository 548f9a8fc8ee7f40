"""Light and massless bodies: a last link that weighs nothing, and a cross between two hinges."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import mpmath
import numpy as np
import scipy.linalg

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.findings import Finding
from ..reference import data, source
from ..study import (
    Cell,
    Grid,
    Limit,
    Maps,
    ParameterStudy,
    Subject,
    Verdict,
    cell,
    decades,
    simulate,
)

STEPS = 2000
STIFFNESS = 100.0
SPRING, FREE = "on a spring, rk4", "hanging free, rk4"
IMPLICIT = "on a spring, rodas4 with fixed steps"
MASS = Grid("mass of the last link over the first [-]", decades(1e-12, 1.0, 1), (1e-12, 1e-6, 1.0))
H = Grid("step h [s]", decades(1e-8, 1e-1, 3), (1e-7, 1e-6, 1e-4, 5e-4, 0.05, 0.1))
ANGLE = Grid("angle between the axes [deg]", decades(1e-6, 90.0, 2), (1e-4, 1.0, 90.0))
CROSS = Grid("inertia of the cross over that of the body [-]", (0.0, *decades(1e-12, 1.0, 1)), (0.0, 1e-6), log=False)


@cache
def pendulum(stiffness: float) -> sf.Model:
    """Two links of 1 m; the second has mass "m2", and a spring against the first."""
    spring = (sf.Spring(stiffness),) if stiffness else ()
    rod = sf.Inertia(1.0, (0, 0, -0.5), (1 / 12, 1 / 12, 0))
    light = sf.Inertia(sf.formula("m2", "mass"), (0, 0, -0.5), (sf.formula("m2/12", "moment"),) * 2 + (0.0,))
    first = sf.RigidBody("first", sf.Joint("q1", "revolute", axis=(0, 1, 0)), rod, (sf.Frame("end", (0, 0, -1)),))
    joint = sf.Joint("q2", "revolute", "first", "end", axis=(0, 1, 0), elements=spring)
    last = sf.RigidBody("last", joint, light)
    return sf.compile(sf.System("light_link", (first, last), parameters=(sf.Parameter("m2", 1.0),)))


def swing(mass: float, h: float, stiffness: float, method: str) -> sf.Trajectory:
    """Swing of the double pendulum from a small angle, under gravity and a spring; `mass` is that of the last link."""
    # A mass of zero is one of the points, whose verdict is the subject.
    m = pendulum(stiffness).with_parameter_checks(False).with_parameters(m2=mass)
    return simulate(m, [0.02, 0.02], t_end=STEPS * h, method=method, dt=h, adaptive=False, every=10)


def growth(run: sf.Trajectory) -> float:
    """Largest angle of either link over that at the start."""
    return float(np.abs(run.q).max() / np.abs(run.q[0]).max())


def measure(stiffness: float, method: str) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of the map, by mass and step."""
    return lambda mass, h: cell(swing(mass, h, stiffness, method), growth)


def fastest(mass: float, stiffness: float) -> float:
    """Higher frequency of small motions, from M and K by hand [rad/s]."""
    g = 9.81
    coupled = mass * (1 / 3 + 1 / 2)
    M = np.array([[1 / 3 + mass * (1 + 1 / 3 + 1), coupled], [coupled, mass / 3]])
    K = np.array([[g * (0.5 + 1.5 * mass), 0.5 * mass * g], [0.5 * mass * g, 0.5 * mass * g + stiffness]])
    scale = np.diag([1.0, 1.0 / math.sqrt(mass)])
    return float(np.sqrt(scipy.linalg.eigh(scale @ K @ scale, scale @ M @ scale, eigvals_only=True)[-1]))


def massless() -> sf.System:
    """A link without mass at the end."""
    first = sf.RigidBody(
        "first",
        sf.Joint("q1", "revolute", axis=(0, 1, 0)),
        sf.Inertia(1.0, (0, 0, -1.0)),
        (sf.Frame("end", (0, 0, -1)),),
    )
    last = sf.RigidBody("last", sf.Joint("q2", "revolute", "first", "end", axis=(0, 1, 0)))
    return sf.System("massless", (first, last))


def refusal() -> tuple[str, str]:
    """Compiler's message on a massless last link, and kind of outcome of a run whose mass parameter is zero."""
    try:
        sf.compile(massless())
        said = ""
    except sf.DescriptionError as error:
        said = str(error).splitlines()[0]
    return said, swing(0.0, 1e-3, 0.0, "rk4").outcome.kind


def judge(maps: Maps) -> Verdict:
    """Verdict on the longest step on a spring against 2.83/omega, and on the refusal of zero mass."""
    missed = maps[SPRING].miss("y", lambda m2: 2.8284271 / fastest(m2, STIFFNESS))
    free = maps[FREE]
    said, kind = refusal()
    light, heavy = (2.8284 / fastest(m2, STIFFNESS) for m2 in (1e-12, 1.0))
    findings = (
        Finding(
            f"{SPRING}: factor by which 2.828/ω_max misses the edge of the map",
            missed,
            1.01,
            reason="the grid can't tell them apart",
        ),
        Finding(
            f"{FREE}: share of the map that is bounded",
            float(free.good.mean()),
            1.0,
            1.0,
            "no frequency grows with lightness",
        ),
        Finding(f"{IMPLICIT}: the same", float(maps[IMPLICIT].good.mean()), 1.0, 1.0, "L-stable"),
        Finding("a massless last link is refused (1: yes)", float(bool(said)), 1.0, 1.0),
        Finding(
            "a mass set to zero at run time ends the run as singular (1: yes)",
            float(kind == "singular"),
            1.0,
            1.0,
            "nothing is silently wrong",
        ),
    )
    statement = (
        "Lightness by itself does no harm: hanging free, a last link of 1e-12 of the first swings as a light one "
        "does (far, for both links have one frequency). On a spring its frequency grows as 1/√m, and RK4's longest "
        f"step shrinks from {heavy:.3f} s to {light:.1e} s, where 2.828/ω_max says ({maps[SPRING].stopped} of "
        f"{maps[SPRING].values.size} runs diverge); rodas4 holds everywhere. No mass at all is refused: “{said}”; a "
        f"mass that a parameter sets to zero ends the run at once with outcome “{kind}”."
    )
    see = (
        "The edge of the first map has slope one half in the mass and lies on the dashed line down to 1e-12; the "
        "other two maps have none."
    )
    return Verdict(statement, see, findings)


@cache
def cross() -> sf.Model:
    """A body of unit moments on two hinges at an angle "a", with a cross of inertia "J" between them."""
    between = sf.RigidBody(
        "cross",
        sf.Joint("q1", "revolute", axis=(1, 0, 0)),
        sf.Inertia(0.0, moments=(sf.formula("J", "inertia"), 0, 0)),
        waive=("nonphysical_inertia",),
    )
    axis = (sf.formula("cos(a)", "axis"), sf.formula("sin(a)", "axis"), 0.0)
    body = sf.RigidBody(
        "body", sf.Joint("q2", "revolute", "cross", axis=axis, actuated=True), sf.Inertia(1.0, moments=(1.0, 1.0, 1.0))
    )
    parameters = (sf.Parameter("a", 1.0), sf.Parameter("J", 0.0))
    return sf.compile(sf.System("cross", (between, body), gravity=(0, 0, 0), parameters=parameters))


def acceleration(angle: float, inertia: float) -> Cell:
    """Relative error of the accelerations under a unit torque on the second hinge, against fifty digits."""
    a = math.radians(angle)
    m = cross().with_parameters(a=a, J=inertia)
    accelerations = m.forward_dynamics(np.zeros(2), np.zeros(2), np.ones(1))
    with mpmath.workdps(50):
        c, s, J = mpmath.cos(a), mpmath.sin(a), mpmath.mpf(inertia)
        determinant = J + s * s
        exact = np.array([float(-c / determinant), float((1 + J) / determinant)])
    if not np.isfinite(accelerations).all():
        return Cell(math.nan, "singular", "accelerations are not finite")
    return Cell(float(np.abs(accelerations - exact).max() / np.abs(exact).max()))


def condition(degrees: float) -> float:
    """Condition number of the mass matrix of the cross without mass, by the angle in degrees."""
    mass_matrix: Array = cross().with_parameters(a=math.radians(degrees), J=0.0).mass_matrix(np.zeros(2))
    return float(np.linalg.cond(mass_matrix))


def judge_cross(maps: Maps) -> Verdict:
    """Errors against the condition."""
    (runs,) = maps.values()
    apart = max(abs(condition(row["axis_angle_deg"]) / row["cond"] - 1) for row in data("massless")["cross"])
    bare = runs.at(y=0.0)
    first = max((float(x) for x, ok in zip(runs.x, runs.good[0], strict=True) if not ok), default=0.0)
    scaled = float((bare * np.radians(runs.x) ** 2)[~np.isnan(bare)].max())
    findings = (
        Finding("condition of M against the known one, relative", apart, 1e-6, reason="(1 + cos a)/(1 - cos a)"),
        Finding("massless cross: largest error times a²", scaled, 1e-14, reason="rounding times the condition, 4/a²"),
        Finding("right angle, massless cross: error", float(runs.at(x=90.0, y=0.0)[0]), 1e-14, reason="rounding"),
    )
    statement = (
        "A massless cross is legal: the body behind it bears both hinges. As they become parallel the mass matrix "
        f"degenerates as 4/a², and digits go with it: at 1 degree, a condition of {condition(1.0):.0f}, nothing is "
        f"lost that matters; {'from ' + format(first, '.1e') + ' degrees down' if first else 'nowhere on the map'} "
        f"the error passes {runs.bound:g}. A cross of 1e-6 of the body's inertia bounds it to "
        f"{float(np.nanmax(runs.at(y=float(CROSS.values.index(1e-6))))):.0e} at any angle."
    )
    see = "Bottom row, no mass: errors grow to the left as 1/a². Every row above is level left of a = √J."
    return Verdict(statement, see, findings)


def boundary(stiffness: float) -> Limit:
    """2.83 over the higher frequency."""
    return Limit(
        "2.828/ω_max",
        np.array(MASS.values),
        lambda masses: np.array([2.8284271 / fastest(m, stiffness) for m in masses]),
    )


STUDY = ParameterStudy(
    "May a body be almost massless?",
    f"A double pendulum whose last link gets lighter, free or on a spring of {STIFFNESS:g} N m/rad, {STEPS} steps.",
    MASS,
    H,
    "largest angle over that at the start [-]",
    1e3,
    (
        Subject(SPRING, measure(STIFFNESS, "rk4"), (boundary(STIFFNESS),)),
        Subject(FREE, measure(0.0, "rk4")),
        Subject(IMPLICIT, measure(STIFFNESS, "rodas4")),
    ),
    judge,
    "leave out light bodies on stiff springs, or use rodas4 or implicit_euler. A massless body may stand between "
    "others; at the end of a chain it needs an inertia or a closure.",
    ("linear stability theory; frequencies from M and K by hand",),
)
CROSS_STUDY = ParameterStudy(
    "How parallel may two hinges be with a massless cross between them?",
    "A body of unit moments on two hinges with a light cross between, under a unit torque on the second.",
    ANGLE,
    Grid.of(CROSS.name, tuple(f"{J:g}" for J in CROSS.values), ("0", "1e-06")),
    "relative error of the accelerations [-]",
    1e-6,
    (Subject("symofros", lambda angle, row: acceleration(angle, CROSS.values[int(row)])),),
    judge_cross,
    "one hinge where two are parallel; a ball joint where all three directions are free; or the cross's own small "
    "inertia.",
    (source("massless"), "exact accelerations with fifty digits (mpmath)"),
)
