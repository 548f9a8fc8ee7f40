"""What binds coordinates and speeds: closures, rods, couplings, rolling contacts, knife edges, formulas."""

from __future__ import annotations

from collections.abc import Iterable, MutableMapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from symofros.base.names import name_of, symbol_of
from symofros.description.contacts import Contact
from symofros.description.entries import pairs_of, refuses_unknown_entries
from symofros.description.forces import Anchor
from symofros.description.values import Term, Value, as_value, symbols
from symofros.errors import DescriptionError, did_you_mean
from symofros.expr.expression import Expression

AxisName = Literal["x", "y", "z"]
AXES: tuple[AxisName, ...] = get_args(AxisName)


def _axes(stated: Any, what: str) -> tuple[AxisName, ...]:
    for name in stated:
        if name not in AXES:
            raise DescriptionError(
                f"{what}: unknown direction",
                f"'{name}'",
                "blocked directions are x, y, z of the first frame",
                did_you_mean(str(name), AXES),
            )
    return tuple(axis for axis in AXES if axis in stated)


class _OnCoordinates:
    """Base class of constraints on coordinates; by default one condition, named after the constraint."""

    name: str

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of its conditions: by default its own alone."""
        return (self.name,)

    @property
    def on_speeds(self) -> tuple[str, ...]:
        """Names of the conditions that bind speeds only: none."""
        return ()


class _OnSpeeds(_OnCoordinates):
    """Base class of constraints whose conditions bind speeds only."""

    @property
    def on_speeds(self) -> tuple[str, ...]:
        """Names of the conditions that bind speeds only: by default all."""
        return self.conditions


@refuses_unknown_entries
@dataclass(frozen=True)
class Closure(_OnCoordinates):
    """Two frames that stay together in some directions: it closes a loop of the tree.

    Attributes:
        name: Unique name.
        first: Reference frame: (body, frame), frame None for the body frame; "world" for the ground.
        second: Other frame: (body, frame).
        translations: Blocked directions of the second origin, along axes of the first frame.
        rotations: Blocked rotations about axes of the first frame. All three: the frames stay parallel; two: their
            third axes do; one: the two free axes stay at right angles, as in a universal joint.
    """

    name: str
    first: Anchor
    second: Anchor
    translations: tuple[AxisName, ...] = AXES
    rotations: tuple[AxisName, ...] = ()

    def __post_init__(self) -> None:
        """Check and order the directions."""
        what = f"closure '{self.name}'"
        object.__setattr__(self, "translations", _axes(self.translations, f"{what}: translations"))
        object.__setattr__(self, "rotations", _axes(self.rotations, f"{what}: rotations"))
        if not self.translations and not self.rotations:
            raise DescriptionError(
                f"{what}: blocks nothing",
                "no directions",
                "a closure blocks at least one",
                "name translations, rotations or both",
            )

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of its conditions: closure.x for a translation, closure.rx for a rotation."""
        return (*(f"{self.name}.{x}" for x in self.translations), *(f"{self.name}.r{x}" for x in self.rotations))


@refuses_unknown_entries
@dataclass(frozen=True)
class Rod(_OnCoordinates):
    """A massless rod: the distance between two frames' origins stays the same.

    Attributes:
        name: Unique name.
        first: First end: (body, frame), frame None for the body frame; "world" for the ground.
        second: Second end: (body, frame).
        length: Length [m].
    """

    name: str
    first: Anchor
    second: Anchor
    length: Value

    def __post_init__(self) -> None:
        """Convert the length."""
        object.__setattr__(self, "length", as_value(self.length, f"rod '{self.name}': length"))


@refuses_unknown_entries
@dataclass(frozen=True)
class Coupling(_OnCoordinates):
    """A condition on coordinates by formula, such as a gear or a joint that mimics another.

    Attributes:
        name: Unique name.
        residual: Formula of coordinates and parameters that stays zero: `q2 - 3*q1`.
    """

    name: str
    residual: Value

    def __post_init__(self) -> None:
        """Convert the formula."""
        residual = as_value(self.residual, f"coupling '{self.name}'")
        object.__setattr__(self, "residual", residual)
        if not symbols(residual):
            raise DescriptionError(
                f"coupling '{self.name}': binds no coordinate",
                f"'{residual}'",
                "a coupling is a formula of coordinates",
                "name a coordinate",
            )


# Rule and remedy of joints that mimic each other in a cycle, whose ratios lock them or say nothing.
MIMICS = "each chain of mimics ends at a joint that mimics none", "remove the <mimic> of the joint that is to lead"


def mimic_cycle(leaders: MutableMapping[str, str], follower: str, leader: str) -> str:
    """The cycle that one more mimic closes, as "a -> b -> a"; "" where it closes none and joins the others.

    Args:
        leaders: Names of the coordinates that others follow, by the follower's; they form no cycle.
        follower: Name of the coordinate that follows.
        leader: Name of the coordinate that it follows.
    """
    chain = [follower, leader]
    while chain[-1] in leaders and chain[-1] != follower:
        chain.append(leaders[chain[-1]])
    if chain[-1] == follower:
        return " -> ".join(chain)
    leaders[follower] = leader
    return ""


def mimicry(follower: str, leader: str, multiplier: float, offset: float) -> Coupling:
    """The coupling of a joint that mimics another: q_follower = multiplier q_leader + offset.

    Args:
        follower: Name of the coordinate that follows.
        leader: Name of the coordinate that it follows.
        multiplier: Ratio of the speeds.
        offset: Coordinate of the follower where that of the leader is zero.
    """
    q, leading = (Term(Expression("symbol", name=symbol_of(name))) for name in (follower, leader))
    return Coupling(f"{follower}_mimics_{leader}", (q - Term(multiplier) * leading - Term(offset)).value)


@refuses_unknown_entries
@dataclass(frozen=True)
class KnifeEdge(_OnSpeeds):
    """A frame that moves along its own axes, but for one: an edge, or a thin wheel that may slip along.

    Attributes:
        name: Unique name.
        anchor: Frame of the edge: (body, frame).
        axis: Axis of the frame along which its origin does not move.
    """

    name: str
    anchor: Anchor
    axis: AxisName = "y"

    def __post_init__(self) -> None:
        """Check the direction."""
        _axes((self.axis,), f"knife edge '{self.name}'")


@refuses_unknown_entries
@dataclass(frozen=True)
class Rolling(_OnSpeeds):
    """A disc or a sphere that rolls without slipping on the horizontal plane z = height of the world.

    The first two conditions bind speeds; the third keeps the contact on the plane, and binds coordinates.

    Attributes:
        name: Unique name.
        anchor: Frame at the centre: (body, frame); a disc's axis is its z axis.
        radius: Radius [m].
        shape: Shape: "disc" (thin, at any tilt but flat) or "sphere".
        height: Height of the plane [m].
    """

    name: str
    anchor: Anchor
    radius: Value
    shape: Literal["disc", "sphere"] = "disc"
    height: Value = 0.0

    def __post_init__(self) -> None:
        """Convert the numbers, check the shape."""
        what = f"rolling contact '{self.name}'"
        for label in ("radius", "height"):
            object.__setattr__(self, label, as_value(getattr(self, label), f"{what}: {label}"))
        if self.shape not in ("disc", "sphere"):
            raise DescriptionError(
                f"{what}: unknown shape",
                f"'{self.shape}'",
                "a rolling body is a disc or a sphere",
                did_you_mean(str(self.shape), ("disc", "sphere")),
            )

    @property
    def conditions(self) -> tuple[str, ...]:
        """Two that bind speeds, one that binds coordinates."""
        return (f"{self.name}.slip_x", f"{self.name}.slip_y", f"{self.name}.height")

    @property
    def on_speeds(self) -> tuple[str, ...]:
        """Names of the two conditions that bind speeds only."""
        return self.conditions[:2]


@refuses_unknown_entries
@dataclass(frozen=True)
class Nonholonomic(_OnSpeeds):
    """A condition on speeds by formula: the sum of coefficient times speed equals a right-hand side.

    Attributes:
        name: Unique.
        coefficients: Speed, as formulas call it (dq1) -> formula of coordinates, parameters and t.
        right: Formula of coordinates, parameters and t.
    """

    name: str
    coefficients: tuple[tuple[str, Value], ...]
    right: Value = 0.0

    def __post_init__(self) -> None:
        """Accept a mapping, and convert the formulas."""
        what = f"non-holonomic constraint '{self.name}'"
        pairs = pairs_of(self.coefficients, what)
        coefficients = tuple((name_of(k), as_value(x, f"{what}: {k}")) for k, x in pairs)
        object.__setattr__(self, "coefficients", coefficients)
        object.__setattr__(self, "right", as_value(self.right, f"{what}: right"))
        if not self.coefficients:
            raise DescriptionError(
                f"{what}: binds no speed", "no coefficients", "a constraint has at least one", "name a speed"
            )


@refuses_unknown_entries
@dataclass(frozen=True)
class Switch:
    """When a constraint holds. A released one is as if it were not stated: its rows are zero, and so is its force.

    Attributes:
        constraint: Name of the constraint.
        engaged: Formula of parameters: 1 where the constraint holds, 0 where it is released.
        pose: What holds: "stated", the constraint as it is described; or "moment", the relative pose, distance or
            residual that there is at the moment in which an action of an event engages it. Until then, "moment" is as
            "stated".
    """

    constraint: str
    engaged: Value
    pose: Literal["stated", "moment"] = "stated"

    def __post_init__(self) -> None:
        """Convert the formula, check the choice."""
        what = f"switch of '{self.constraint}'"
        object.__setattr__(self, "engaged", as_value(self.engaged, f"{what}: engaged"))
        if self.pose not in ("stated", "moment"):
            raise DescriptionError(
                f"{what}: unknown pose",
                f"'{self.pose}'",
                "a constraint engages at the pose that is 'stated', or at that of the 'moment'",
                did_you_mean(str(self.pose), ("stated", "moment")),
            )


@dataclass(frozen=True)
class Touching(_OnCoordinates):
    """Conditions that a ball of a rigid contact meets, stated by the generator (docs/theory/constraints.md, 15).

    Attributes:
        name: Unique name.
        contact: The contact.
        ball: Number of the ball.
        axes: Axes of the plane, 2 its normal, along which the ball is held.
    """

    name: str
    contact: Contact
    ball: int
    axes: tuple[int, ...]

    @property
    def first(self) -> Anchor:
        """The frame of the plane."""
        return self.contact.second

    @property
    def second(self) -> Anchor:
        """The frame of the ball."""
        return self.contact.first

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions: the contact's own for the normal, with the axis for those across it."""
        return (self.name,) if self.axes == (2,) else tuple(f"{self.name}.{AXES[axis]}" for axis in self.axes)

    @property
    def on_speeds(self) -> tuple[str, ...]:
        """Names of the conditions on speeds: those across the normal, as rolling does not depend on where a ball is."""
        return () if self.axes == (2,) else self.conditions


# What a description states, and what the generator adds of rigid contacts.
Constraint = Closure | Rod | Coupling | KnifeEdge | Rolling | Nonholonomic | Touching
# What joins two frames.
BETWEEN_FRAMES = (Closure, Rod, Touching)
# What knows no bodies, and so has no wrench.
BY_FORMULA = (Coupling, Nonholonomic)


def acts_on_bodies(constraints: Iterable[Constraint]) -> list[str]:
    """Names of the constraints with a wrench: all but conditions by formula, which know no bodies."""
    return [constraint.name for constraint in constraints if not isinstance(constraint, BY_FORMULA)]


def section_order(constraint: Constraint) -> int:
    """Place of a constraint's section in files: closures and rods, couplings, conditions on speeds."""
    return 0 if isinstance(constraint, BETWEEN_FRAMES) else 1 if isinstance(constraint, Coupling) else 2
