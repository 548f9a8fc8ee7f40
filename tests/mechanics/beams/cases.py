"""Trees with beams, each stated twice: for the generator, and for the Lagrangian oracle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

import symofros as sf
from tests.mechanics.beams import rods
from tests.mechanics.beams.rods import GRAVITY as GRAVITY
from validation.adapters.lagrangian.beam import Flexible
from validation.adapters.lagrangian.beam import rotation_about as about
from validation.adapters.lagrangian.tree import Node, Solid
from validation.mechanics import shape_functions as shapes

L = 1.3
XI = (0.0, 0.2, 0.45, 0.7, 1.0)
SAMPLES = (0.0, 0.05, 0.3, 0.6, 1.1)
SECTION: dict[str, Any] = rods.SECTION | {"damping": 0.03}


@dataclass(frozen=True)
class Case:
    """One mechanism, as the generator and as the oracle sees it; `driven` is of a prescribed motion."""

    system: sf.System
    nodes: tuple[Node, ...]
    driven: tuple[tuple[float, ...], ...] = ((), (), ())

    def retaining(self, retain: str) -> sf.System:
        """The system with every beam of this order."""
        bodies = [replace(b, retain=retain) if isinstance(b, sf.Beam) else b for b in self.system.bodies]
        return replace(self.system, bodies=tuple(bodies))


def functions(family: str, v: int, w: int, twist: int) -> dict[str, Any]:
    """The oracle's shape functions of a family, and where they are not smooth."""
    if family == "spline":
        breaks = {b for first, n in ((2, v), (2, w), (1, twist)) if n for b in shapes.spline_breaks(first, n, L)}
        made = shapes.splines(2, v, L), shapes.splines(2, w, L), shapes.splines(1, twist, L)
        return dict(zip(("v", "w", "twist"), made, strict=True)) | {"breaks": tuple(sorted(breaks))}
    make: Callable[..., Any] = {"polynomial": shapes.monomials, "legendre": shapes.legendre}[family]
    return {"v": make(2, v, L), "w": make(2, w, L), "twist": make(1, twist, L)}


def pair(
    name: str,
    joint: sf.Joint,
    parent: int,
    motion: Any,
    counts: tuple[int, int, int],
    family: str = "legendre",
    **more: Any,
) -> tuple[sf.Beam, Node]:
    """A beam as the generator and as the oracle sees it; `motion` is (count, function) of its joint."""
    given = SECTION | more
    bend_y, bend_z, twist = counts
    beam = sf.Beam(name, joint, L, bend_y=bend_y, bend_z=bend_z, twist=twist, family=family, retain="all", **given)
    return beam, Node(parent, Flexible(L, **given, **functions(family, *counts)), *motion)


def vector(*values: float) -> Any:
    return ca.SX(np.array(values, dtype=float))


def hub(axis: tuple[float, float, float] = (0, 0, 1), position: tuple[float, float, float] = (0.2, 0.0, 0.0)) -> Any:
    return 1, lambda q: (vector(*position), about(axis, q[0]))


def six(q: Any) -> Any:
    return q[:3], about((0, 0, 1), q[5]) @ about((0, 1, 0), q[4]) @ about((1, 0, 0), q[3])


FREE = sf.Joint(
    "base",
    "general",
    coordinates=("X", "Y", "Z", "a", "b", "c"),
    moving_position=("X", "Y", "Z"),
    moving_rotation=sf.Rotation.rpy("a", "b", "c"),
)
HUB = sf.Joint("hub", "revolute", position=(0.2, 0, 0))
BODY = sf.Inertia(0.7, (0.1, -0.05, 0.08), (0.02, 0.03, 0.025))
SOLID = Solid(0.7, (0.1, -0.05, 0.08), (0.02, 0.03, 0.025))


def system(*bodies: sf.Beam | sf.RigidBody, **more: Any) -> sf.System:
    return sf.System("s", bodies, gravity=GRAVITY, **more)


def one(*args: Any, **more: Any) -> Case:
    """A single beam."""
    beam, node = pair("beam", *args, **more)
    return Case(system(beam), (node,))


def two_in_series(second: sf.Joint, motion: Any) -> Case:
    inner, first = pair("one", HUB, -1, hub(), (2, 1, 1))
    outer, node = pair("two", second, 0, motion, (1, 2, 1), "polynomial")
    return Case(system(inner, outer), (first, node))


def branching() -> Case:
    """Two beams side by side on the tip of a beam without shape functions; a body on one of them."""
    stem, first = pair("stem", HUB, -1, hub(), (0, 0, 0))
    joint = sf.Joint("wrist", "revolute", "stem", "tip", axis=(1, 0, 0))
    left, second = pair("left", joint, 0, hub((1, 0, 0), (0, 0, 0)), (1, 1, 1))
    weld = sf.Joint("weld", "fixed", "stem", "tip", (0, 0.1, 0), sf.Rotation.rpy(0, 0, 1.2))
    placed = 0, lambda q: (vector(0, 0.1, 0), about((0, 0, 1), ca.SX(1.2)))
    right, third = pair("right", weld, 0, placed, (2, 1, 0), foreshortening=False)
    load = sf.RigidBody("load", sf.Joint("clamp", "fixed", "left", "tip"), BODY)
    return Case(system(stem, left, load, right), (first, second, Node(1, SOLID), third))


def with_tip_body(joint: sf.Joint, motion: Any, **more: Any) -> Case:
    beam, node = pair(
        "beam", sf.Joint("hub", "revolute", axis=(0, 1, 0)), -1, hub((0, 1, 0), (0, 0, 0)), (2, 2, 1), **more
    )
    body = sf.RigidBody("load", joint, BODY)
    return Case(system(beam, body), (node, Node(0, SOLID, *motion)))


def tapered(rotary: bool = False) -> Case:
    """Sections by formula, of the station and of parameters; with rotary inertia, that changes along the beam, too."""
    stated = {
        "rhoA": "rho*(1 - 0.4*x/L)",
        "EI_z": "EI*(1 - 0.5*x/L)^3",
        "EI_y": "2*EI*(1 - 0.5*x/L)^3",
        "GJ": "EI*exp(-x)",
        "rhoJ": "0.02*rho*(1 + x)",
    }
    rho, EI = 2.0, 3.0
    known: dict[str, Any] = {
        "rhoA": lambda x: rho * (1 - 0.4 * x / L),
        "EI_z": lambda x: EI * (1 - 0.5 * x / L) ** 3,
        "EI_y": lambda x: 2 * EI * (1 - 0.5 * x / L) ** 3,
        "GJ": lambda x: EI * np.exp(-x),
        "rhoJ": lambda x: 0.02 * rho * (1 + x),
    }
    if rotary:
        stated |= {"rhoI_y": "0.03*exp(-x)", "rhoI_z": "0.02 + 0.01*x^2"}
        known |= {"rhoI_y": lambda x: 0.03 * np.exp(-x), "rhoI_z": lambda x: 0.02 + 0.01 * x**2}
    functions_of = {"bend_y": 2, "bend_z": 2, "twist": 2, "retain": "all", "rotary_inertia": rotary}
    beam = sf.Beam("beam", HUB, "L", damping="c", **functions_of, **stated)
    parameters = [sf.Parameter(*p) for p in (("rho", rho), ("EI", EI), ("L", L), ("c", 0.02))]
    flexible = Flexible(L, damping=0.02, rotary_inertia=rotary, **known, **functions("spline", 2, 2, 2))
    return Case(system(beam, parameters=parameters), (Node(-1, flexible, *hub()),))


def planar(family: str) -> Case:
    """A family in one plane, on a hub."""
    given = {"rhoA": 2.0, "EI_z": 3.0, "damping": 0.03}
    more: dict[str, Any] = {"family": family}
    breaks: tuple[float, ...] = ()
    if family == "clamped_free":
        # Not smooth breaks: shorter intervals, for modes that Gauss' nodes would not follow over the whole length.
        known, breaks = shapes.clamped_free(3, L), (L / 4, L / 2, 3 * L / 4)
    elif family == "hermite":
        known = shapes.hermite(L)
    elif family == "formulas":
        more = {"family": "user", "shapes": {"bend_y": ("1 - cos(pi*xi/2)", "xi^2*exp(-xi)")}}
        a = np.pi / 2
        known = (
            shapes.stretched(
                lambda s: 1 - np.cos(a * s), lambda s: a * np.sin(a * s), lambda s: a**2 * np.cos(a * s), L
            ),
            shapes.stretched(
                lambda s: s**2 * np.exp(-s),
                lambda s: (2 * s - s**2) * np.exp(-s),
                lambda s: (2 - 4 * s + s**2) * np.exp(-s),
                L,
            ),
        )
    else:
        more = {"family": "user", "shapes": {"bend_y": (sf.Samples(XI, SAMPLES),)}}
        known, breaks = (shapes.through(XI, SAMPLES, L),), tuple(L * x for x in XI)
    beam = sf.Beam("beam", HUB, L, bend_y=len(known), retain="all", **given, **more)
    return Case(system(beam), (Node(-1, Flexible(L, v=known, breaks=breaks, **given), *hub()),))


def users_own() -> Case:
    """Samples at stations of their own and formulas, in three directions of one beam."""
    twist = (0.0, 0.3, 0.4, 0.6, 0.9, 1.0), (0.0, 0.2, 0.35, 0.5, 0.9, 0.8)
    stated = {"bend_y": (sf.Samples(XI, SAMPLES),), "bend_z": ("xi^2", "xi^3"), "twist": (sf.Samples(*twist), "xi")}
    known = {
        "v": (shapes.through(XI, SAMPLES, L),),
        "w": shapes.monomials(2, 2, L),
        "twist": (shapes.through(*twist, L, bending=False), *shapes.monomials(1, 1, L)),
        "breaks": tuple(L * x for x in sorted({*XI, *twist[0]})),
    }
    beam = sf.Beam("beam", FREE, L, bend_y=1, bend_z=2, twist=2, family="user", shapes=stated, retain="all", **SECTION)  # type: ignore[arg-type]
    return Case(system(beam), (Node(-1, Flexible(L, **SECTION, **known), 6, six),))


def on_a_driven_base() -> Case:
    """Base motion is given: its rates and second rates enter h."""
    joint = sf.Joint(
        "drive",
        "general",
        coordinates=("X", "A"),
        moving_position=("X", "X*A", 0.3),
        prescribed=True,
        moving_rotation=sf.Rotation.rpy(0.0, "A", "X"),
    )
    motion = 2, lambda s: (ca.vertcat(s[0], s[0] * s[1], 0.3), about((0, 0, 1), s[0]) @ about((0, 1, 0), s[1]))
    beam, node = pair("beam", joint, -1, motion, (2, 1, 1))
    return Case(system(beam), (replace(node, prescribed=True),), ((0.4, -0.7), (1.2, 0.8), (-2.0, 3.0)))


AXIS = (1, 2, 2)
CASES: dict[str, Case] = {
    "spinning hub": one(HUB, -1, hub(), (3, 2, 0)),
    "hub about another axis": one(
        sf.Joint("hub", "revolute", position=(0.2, 0, 0), axis=AXIS), -1, hub(AXIS), (2, 2, 1)
    ),
    "free base": one(FREE, -1, (6, six), (2, 2, 2)),
    "free base, rotary inertia": one(FREE, -1, (6, six), (2, 1, 1), rotary_inertia=True),
    "free base, splines": one(FREE, -1, (6, six), (2, 1, 3), "spline"),
    "without foreshortening": one(FREE, -1, (6, six), (2, 2, 1), foreshortening=False),
    "two in series": two_in_series(
        sf.Joint("elbow", "revolute", "one", "tip", (0.1, 0, 0.05), axis=(0, 1, 0)), hub((0, 1, 0), (0.1, 0, 0.05))
    ),
    "clamped in series": two_in_series(
        sf.Joint("weld", "fixed", "one", "tip", rotation=sf.Rotation.rpy(0.3, -0.7, 1.2)),
        (0, lambda q: (vector(0, 0, 0), about((0, 0, 1), 1.2) @ about((0, 1, 0), -0.7) @ about((1, 0, 0), 0.3))),
    ),
    "branching": branching(),
    "body on the tip": with_tip_body(
        sf.Joint("weld", "fixed", "beam", "tip", (0.2, 0.1, -0.15), sf.Rotation.rpy(0, 0, 0.5)),
        (0, lambda q: (vector(0.2, 0.1, -0.15), about((0, 0, 1), ca.SX(0.5)))),
    ),
    "body on the tip, rotary inertia": with_tip_body(
        sf.Joint("weld", "fixed", "beam", "tip", (0.2, 0.1, -0.15)),
        (0, lambda q: (vector(0.2, 0.1, -0.15), ca.SX.eye(3))),
        rotary_inertia=True,
    ),
    "body hinged to the tip": with_tip_body(
        sf.Joint("wrist", "revolute", "beam", "tip", (0.2, 0.1, -0.15), axis=AXIS), hub(AXIS, (0.2, 0.1, -0.15))
    ),
    "tapered": tapered(),
    "tapered, rotary inertia": tapered(rotary=True),
    "user's own": users_own(),
    "driven base": on_a_driven_base(),
    "clamped to the world": one(
        sf.Joint("clamp", "fixed", position=(0, 0, 1)), -1, (0, lambda q: (vector(0, 0, 1), ca.SX.eye(3))), (2, 2, 1)
    ),
    **{f"planar {family}": planar(family) for family in ("clamped_free", "hermite", "formulas", "samples")},
}
