"""Contact of balls on one frame with the surface of a solid on another frame: compliant, or rigid."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

from symofros.description.entries import refuses_unknown_entries
from symofros.description.forces import Anchor
from symofros.description.values import ORIGIN, Value, Vector, as_value, as_vector
from symofros.errors import DescriptionError, Problem

Surface = Literal["plane", "sphere", "cylinder", "capsule", "box"]
# The measures that each surface has, and those of them that may enclose the balls.
MEASURES: dict[Surface, tuple[str, ...]] = {
    "plane": (),
    "sphere": ("surface_radius",),
    "cylinder": ("surface_radius",),
    "capsule": ("surface_radius", "length"),
    "box": ("size",),
}
HOLLOW: tuple[Surface, ...] = ("sphere", "cylinder")
EXPONENTS = (1.0, 1.5, 2.0)
# What points of contact move along, the surfaces that it meets (no surface meets both), and what stands in elsewhere.
_MOVING: tuple[tuple[str, tuple[Surface, ...], str], ...] = (
    ("rim", ("plane", "sphere", "cylinder"), "one of these from outside and restitution; or points along the rim"),
    ("segment", ("sphere", "cylinder", "capsule", "box"), "its two ends as points, as on a plane; or points along it"),
)
_NUMBERS = (
    *("stiffness", "radius", "rim", "segment", "surface_radius", "length", "dissipation"),
    *("friction", "minimum_velocity", "bristle_stiffness", "bristle_damping", "restitution"),
)
# What rigid contacts have no use for, and what stands there unless it is stated.
_COMPLIANT = {"exponent": 1.5, "dissipation": 0.0, "minimum_velocity": 1e-3, "bristle_stiffness": None}
# Balls of a contact.
_MOST = 1000


def entries_by_surface() -> dict[str, list[str]]:
    """Surface -> the entries that not all surfaces have: its measures, whether it may enclose, what may move on it."""
    return {
        surface: [
            *measures,
            *(["inside"] if surface in HOLLOW else []),
            *(label for label, surfaces, _ in _MOVING if surface in surfaces),
        ]
        for surface, measures in MEASURES.items()
    }


@refuses_unknown_entries
@dataclass(frozen=True)
class Contact:
    """Balls that a surface pushes back: compliant, where they penetrate it, or rigid, so that they do not.

    *Compliant*, with `stiffness`: one-sided, dissipative, with friction. At a penetration d > 0 the surface pushes by
    N = stiffness d^exponent max(0, 1 + dissipation d'), and friction drags by up to `friction` N against the slip
    (docs/theory/rigid.md, section 10.2). It never pulls, and what it stores, stiffness d^(exponent + 1)/(exponent + 1),
    is potential energy.

    Friction is smooth through zero slip unless bristles are stated: then it holds nothing at rest, and a body on an
    incline creeps, as a joint with `Friction` does. With `bristle_stiffness` and `bristle_damping` each ball sticks
    by a spring across the surface, which slips at `friction` N; its deflections are states of the model,
    "BALL.bristle_x" and so on in the axes of the second frame, of a plane two, of other surfaces three
    (docs/theory/states.md, section 5).

    *Rigid*, with `restitution` in place of `stiffness`: balls on a surface strike, slide, stick and part by Coulomb's
    law, exactly, as modes of a run ("BALL.mode": 0 open, 1 slides, 2 sticks; docs/theory/constraints.md,
    section 15). Runs, batches, steppers, C packages, MEX, FMUs and WebAssembly choose the modes; all other functions
    see an open contact unless a mode is set.

    Attributes:
        name: Unique name, among connections too.
        first: Frame that the balls are fixed to: (body, frame), frame None for the body frame; "world" for the ground.
        second: Frame of the surface: (body, frame).
        stiffness: Stiffness, in N/m^exponent; None: the contact is rigid.
        surface: Solid on the second frame, about its origin: "plane", all below its x-y plane; "sphere"; "cylinder",
            along its z axis without end; "capsule", along its z axis; "box", along its axes.
        radius: Radius of the balls; 0 of points [m].
        points: Centres of the balls in the first frame, one at its origin if not given: a box on a plane touches by
            its eight corners, a capsule by its two ends [m].
        surface_radius: Radius of a sphere, cylinder or capsule [m].
        length: Distance of the centres of a capsule's ends [m].
        size: Edges of a box [m].
        inside: Whether balls move within a sphere or cylinder, as pegs in a hole do.
        exponent: Power of the penetration: 1, 1.5 (Hertz's, of balls) or 2.
        dissipation: Share of the force that a speed of approach adds [s/m]: with it the coefficient of restitution of
            slow impacts is 1 - 2/3 dissipation times the speed.
        friction: Coefficient of Coulomb's friction.
        minimum_velocity: Speed of slip that smooths friction without bristles: its maximum is from 15/8 of it on [m/s].
        bristle_stiffness: Stiffness against displacement across the surface where a ball sticks [N/m].
        bristle_damping: Damping of that displacement [N s/m].
        restitution: Of a rigid contact, Stronge's energetic coefficient, 0 to 1: the normal impulse gives back its
            square of the work that it took.
        rim: Radius of a circle about the z axis of the first frame through each point, whose next point to a plane,
            sphere or cylinder takes the point's place: rims of a disc, a wheel or a cylinder that tumbles, or a ring
            around a rod; of rigid contacts [m].
        segment: Length of a line along the z axis of the first frame about each point, whose next point to a sphere,
            cylinder, capsule or box takes the point's place: with a radius a capsule; of rigid contacts [m].
    """

    name: str
    first: Anchor
    second: Anchor
    stiffness: Value | None = None
    surface: Surface = "plane"
    radius: Value = 0.0
    points: tuple[Vector, ...] = (ORIGIN,)
    surface_radius: Value | None = None
    length: Value | None = None
    size: Vector | None = None
    inside: bool = False
    exponent: float = 1.5
    dissipation: Value = 0.0
    friction: Value = 0.0
    minimum_velocity: Value = 1e-3
    bristle_stiffness: Value | None = None
    bristle_damping: Value | None = None
    restitution: Value | None = None
    rim: Value | None = None
    segment: Value | None = None

    def __post_init__(self) -> None:
        """Convert the numbers, and refuse measures that the surface lacks or does not have."""
        what = f"contact '{self.name}'"
        for label in _NUMBERS:
            if getattr(self, label) is not None:
                object.__setattr__(self, label, as_value(getattr(self, label), f"{what}: {label}"))
        if self.size is not None:
            object.__setattr__(self, "size", as_vector(self.size, f"{what}: size"))
        object.__setattr__(self, "points", tuple(as_vector(point, f"{what}: points") for point in self.points))
        problem = self._problem(what)
        if problem is not None:
            raise DescriptionError(problem)

    def _problem(self, what: str) -> Problem | None:
        """What is wrong about the choices of this contact."""
        if self.surface not in MEASURES:
            return Problem(f"{what}: surface", repr(self.surface)[:80], f"one of {', '.join(MEASURES)}", "choose one")
        needed = MEASURES[self.surface]
        for label in ("surface_radius", "length", "size"):
            stated = getattr(self, label)
            if (stated is not None) != (label in needed):
                found = "not given" if stated is None else f"{stated}"[:80]
                rule = f"a {self.surface} has {' and '.join(needed) or 'no measures'}"
                return Problem(f"{what}: {label}", found, rule, "state it" if stated is None else "leave it out")
        if self.inside and self.surface not in HOLLOW:
            remedy = "leave inside out, or state a contact for each wall"
            return Problem(f"{what}: inside a {self.surface}", "inside", "balls move within spheres, cylinders", remedy)
        for label, surfaces, remedy in _MOVING:
            if getattr(self, label) is not None and (self.surface not in surfaces or self.inside or not self.rigid):
                found = f"{'inside ' if self.inside else ''}a {self.surface}, {'rigid' if self.rigid else 'compliant'}"
                rule = f"a {label} meets a {', '.join(surfaces)} from outside, as a rigid contact"
                return Problem(f"{what}: {label}", found, rule, remedy)
        if self.exponent not in EXPONENTS:
            rule = f"one of {', '.join(f'{x:g}' for x in EXPONENTS)}"
            return Problem(f"{what}: exponent", repr(self.exponent)[:80], rule, "1.5 for balls (Hertz)")
        if not 1 <= len(self.points) <= _MOST:
            return Problem(f"{what}: points", f"{len(self.points)}", f"from 1 to {_MOST} balls", "state their centres")
        return self._bristle_problem(what) or self._rigid_problem(what)

    def _rigid_problem(self, what: str) -> Problem | None:
        """What is wrong about the choice of a compliant or a rigid contact."""
        if (self.stiffness is None) == (self.restitution is None):
            found = "neither" if self.stiffness is None else "stiffness and restitution"
            rule = "a contact is compliant, with a stiffness, or rigid, with a coefficient of restitution"
            return Problem(f"{what}: compliant or rigid", found, rule, "state one of the two")
        if not self.rigid:
            return None
        for label, left_out in _COMPLIANT.items():
            if getattr(self, label) != left_out:
                remedy = "leave it out, or state a stiffness in place of restitution"
                return Problem(
                    f"{what}: {label}", f"{getattr(self, label)}"[:80], "it is of compliant contacts", remedy
                )
        return None

    @property
    def rigid(self) -> bool:
        """Whether the contact is rigid."""
        return self.stiffness is None

    def _bristle_problem(self, what: str) -> Problem | None:
        """What is wrong about the bristles."""
        if (self.bristle_stiffness is None) != (self.bristle_damping is None):
            found = "bristle_damping" if self.bristle_stiffness is None else "bristle_stiffness"
            rule = "bristles are springs and dampers across the surface"
            return Problem(f"{what}: one of two entries", f"{found} alone", rule, "give both, or neither")
        if self.bristle_stiffness is not None and self.friction == 0.0:
            rule = "bristles hold up to friction times the normal force"
            return Problem(f"{what}: bristles without friction", "friction 0", rule, "state friction above zero")
        return None

    @property
    def ball_names(self) -> tuple[str, ...]:
        """One a ball: the contact's name, of several with their number from 0 on."""
        return (self.name,) if len(self.points) == 1 else tuple(f"{self.name}.{k}" for k in range(len(self.points)))

    @property
    def state_names(self) -> tuple[tuple[str, ...], ...]:
        """Names of the states of each ball: none without bristles."""
        axes = "" if self.bristle_stiffness is None else "xy" if self.surface == "plane" else "xyz"
        return tuple(tuple(f"{ball}.bristle_{axis}" for axis in axes) for ball in self.ball_names)

    def values(self) -> list[tuple[str, Any]]:
        """Label and value of each number."""
        stated: list[tuple[str, Any]] = []
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name == "points":
                stated += [(item.name, x) for point in value for x in point]
            elif item.name == "size" and value is not None:
                stated += [(item.name, x) for x in value]
            elif item.name not in ("name", "first", "second", "surface", "inside", "exponent") and value is not None:
                stated.append((item.name, value))
        return stated
