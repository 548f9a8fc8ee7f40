"""What acts on a mechanism: joint elements, rotors, loads on bodies, connections, virtual power, potentials."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Literal

from symofros.base.names import name_of
from symofros.description.entries import pairs_of, refuses_unknown_entries, shown_entries
from symofros.description.values import ORIGIN, Term, Value, Vector, as_value, as_vector
from symofros.errors import DescriptionError


class _Values:
    """Converts every numeric field of a dataclass at its construction."""

    def __post_init__(self) -> None:
        for name, value in numbers_of(self):
            object.__setattr__(self, name, as_value(value, f"{type(self).__name__.lower()}: {name}"))


# Entries of joint elements that are no numbers or formulas.
_NO_NUMBERS = ("coordinate", "sticks")


def numbers_of(element: Any) -> Iterator[tuple[str, Value]]:
    """The stated numbers and formulas of an element of a joint, by their entries."""
    for item in fields(element):
        value = getattr(element, item.name)
        if item.name not in _NO_NUMBERS and value is not None:
            yield item.name, value


@refuses_unknown_entries
@dataclass(frozen=True)
class Spring(_Values):
    """F = -(stiffness x + cubic x^3), x = q - rest; its energy is potential energy.

    Attributes:
        stiffness: Stiffness [N m/rad or N/m].
        rest: Coordinate at rest [rad or m].
        cubic: Cubic stiffness: positive hardens, negative softens [N m/rad^3 or N/m^3].
        coordinate: Index of the coordinate of the joint, from 0.
    """

    stiffness: Value
    rest: Value = 0.0
    cubic: Value = 0.0
    coordinate: int = 0


@refuses_unknown_entries
@dataclass(frozen=True)
class Damper(_Values):
    """F = -(coefficient v + quadratic v |v|).

    Attributes:
        coefficient: Viscous coefficient [N m s/rad or N s/m].
        quadratic: Coefficient of v |v| [N m s^2/rad^2 or N s^2/m^2].
        coordinate: Index of the speed of the joint, from 0.
    """

    coefficient: Value
    quadratic: Value = 0.0
    coordinate: int = 0


@refuses_unknown_entries
@dataclass(frozen=True)
class Stop(_Values):
    """A limit as penalty: a spring and damper that act only beyond it; the spring's energy is potential energy.

    Attributes:
        stiffness: Stiffness beyond the limit [N m/rad or N/m].
        damping: Damping of motion further into the limit; motion out of it is not held back [N m s/rad or N s/m].
        lower: Lower limit; no lower limit if not given [rad or m].
        upper: Upper limit; no upper limit if not given [rad or m].
        coordinate: Index of the coordinate of the joint, from 0.
    """

    stiffness: Value
    damping: Value = 0.0
    lower: Value | None = None
    upper: Value | None = None
    coordinate: int = 0


@refuses_unknown_entries
@dataclass(frozen=True)
class Friction(_Values):
    """Coulomb, Stribeck and viscous friction, smooth through zero speed.

    F = -sign(v) [dynamic + (static - dynamic) exp(-((|v| - peak)/stribeck_velocity)^2)] - viscous v

    from the speed `peak` on, which is 15/8 minimum_velocity, and 1.5 stribeck_velocity at most. Below it, F grows with
    |v| from zero at rest, where its slope is static/minimum_velocity, to `static` at the peak: the maximum of dry
    friction is exactly that. Without `static`, F is `dynamic` from the peak on. It is twice continuously
    differentiable (docs/theory/rigid.md, (56) to (58)).

    It holds nothing at rest: a joint under a load P below `static` does not stick but creeps, at about
    minimum_velocity P/static. A block that is loaded by half of `static` creeps by 53 mm in 100 s at the default
    1 mm/s, in proportion to `minimum_velocity`. A run that ends in creep bears a note; `equilibrium` finds none.

    With `sticks`, runs hold the joint exactly: at rest a constraint takes up to `static`, and lets go in the direction
    of what it takes beyond that; then friction has one sign, and the level of the speed, until the joint comes to rest
    again (docs/theory/constraints.md, section 14). To the model's functions such friction is the smooth one.

    Attributes:
        dynamic: Coulomb friction at speed [N m or N].
        static: Friction at the onset of motion, its maximum unless it is below dynamic; dynamic if
            not given [N m or N].
        minimum_velocity: Speed over which the sign of the speed is smoothed [rad/s or m/s].
        viscous: Viscous coefficient [N m s/rad or N s/m].
        stribeck_velocity: Speed over which static falls to dynamic; if not given ten times the minimum velocity, and no
            speed at all of friction that sticks [rad/s or m/s].
        coordinate: Index of the speed of the joint, from 0.
        sticks: Whether runs hold the joint at rest exactly.
        factor: Factor of dynamic and static, a formula of coordinates, speeds, inputs, states of forces, parameters and
            t: load, temperature, position; 0 where it is below zero. Not of friction that sticks.
    """

    dynamic: Value
    static: Value | None = None
    minimum_velocity: Value = 0.001
    viscous: Value = 0.0
    stribeck_velocity: Value | None = None
    coordinate: int = 0
    sticks: bool = False
    factor: Value = 1.0

    def __post_init__(self) -> None:
        """Convert the numbers; what holds a joint has a level that only events change."""
        super().__post_init__()
        if self.sticks and self.factor != 1.0:
            rule = "friction that sticks lets go at a level of parameters, which only events change"
            remedy = "leave sticks out, or state dynamic and static by parameters"
            raise DescriptionError("friction: factor of friction that sticks", f"{self.factor}", rule, remedy)

    def __repr__(self) -> str:
        """Each field that counts, as hashes of descriptions are made of this text."""
        unused = {"sticks": not self.sticks, "factor": self.factor == 1.0}
        return shown_entries(self, [name for name, left_out in unused.items() if left_out])

    @property
    def breakaway(self) -> Value:
        """Most that friction takes at rest [N m or N]."""
        return self.dynamic if self.static is None else self.static


def Brake(torque: Value | str, engaged: Value | str = 1.0, coordinate: int = 0) -> Friction:
    """A brake: friction that sticks, up to a torque at which it slips, while it is engaged.

    Args:
        torque: Torque or force at which it slips [N m or N]: number or formula of parameters.
        engaged: Formula of parameters that is 1 where the brake is shut and 0 where it is open; what lies between is a
            brake that is partly shut.
        coordinate: Index of the speed of the joint, from 0.
    """
    level = Term(as_value(torque, "brake: torque")) * Term(as_value(engaged, "brake: engaged"))
    return Friction(level.value, coordinate=coordinate, sticks=True)


@refuses_unknown_entries
@dataclass(frozen=True)
class LuGre(_Values):
    """Friction by bristles that bend, the LuGre model: presliding displacement, stick-slip, a lag in sliding.

    F = -(stiffness z + damping z' + viscous v),   z' = v - stiffness |v| z / g,
    g = dynamic + (static - dynamic) exp(-(v/stribeck_velocity)^2)

    The mean deflection z of the bristles is a state of the model, "COORDINATE.bristle", which runs integrate with the
    motion; its neutral value is zero. The energy stiffness z^2/2 of the bristles is potential energy
    (docs/theory/states.md, section 2, which says up to which speed it dissipates whatever the motion).

    Attributes:
        dynamic: Coulomb friction at speed [N m or N].
        stiffness: Stiffness of the bristles [N m/rad or N/m].
        damping: Damping of the bristles [N m s/rad or N s/m].
        static: Friction at the onset of motion; dynamic if not given [N m or N].
        stribeck_velocity: Speed over which static falls to dynamic; needed where static is given [rad/s or m/s].
        viscous: Viscous coefficient [N m s/rad or N s/m].
        coordinate: Index of the speed of the joint, from 0.
    """

    dynamic: Value
    stiffness: Value
    damping: Value = 0.0
    static: Value | None = None
    stribeck_velocity: Value | None = None
    viscous: Value = 0.0
    coordinate: int = 0
    state: ClassVar[str] = "bristle"

    def __post_init__(self) -> None:
        """Convert the numbers; static friction falls over a speed."""
        super().__post_init__()
        if (self.static is None) != (self.stribeck_velocity is None):
            given = "static" if self.stribeck_velocity is None else "stribeck_velocity"
            rule = "friction falls from static to dynamic over stribeck_velocity"
            raise DescriptionError("lugre: one of two entries", f"{given} alone", rule, "give both, or neither")


@refuses_unknown_entries
@dataclass(frozen=True)
class Hysteresis(_Values):
    """An elasto-plastic element, a spring that slips at a force: rate-independent hysteresis, as of harmonic drives.

    F = -stiffness z,   z' = v (1 - |stiffness z/force|^sharpness) where z grows, z' = v where it falls

    Several on one coordinate, some softer than others, are the model of Iwan and of Maxwell slip: each slips at its
    own displacement. The deflection z is a state of the model, "COORDINATE.slip" (the next "COORDINATE.slip2"), whose
    neutral value is zero; stiffness z^2/2 is potential energy (docs/theory/states.md, section 3).

    Attributes:
        stiffness: Stiffness before it slips [N m/rad or N/m].
        force: Force at which it slips [N m or N].
        sharpness: Exponent, 1 or more: 1 bends at once (Dahl's model), 50 is nearly elastic up to the force.
        coordinate: Index of the speed of the joint, from 0.
    """

    stiffness: Value
    force: Value
    sharpness: Value = 2.0
    coordinate: int = 0
    state: ClassVar[str] = "slip"


JointElement = Spring | Damper | Stop | Friction | LuGre | Hysteresis
# Elements with a state of their own.
WITH_STATE = (LuGre, Hysteresis)


@refuses_unknown_entries
@dataclass(frozen=True)
class ForceState:
    """A state of a force of one's own: a number that moves by its rate, and that formulas of forces may use.

    Its neutral value is zero. Formulas of loads, efforts, virtual power and potentials may name it; of a potential it
    is energy that is stored, not a force: that is stated beside it.

    Attributes:
        name: Unique.
        rate: Formula of states, coordinates, speeds, inputs, parameters and t.
    """

    name: str
    rate: Value

    def __post_init__(self) -> None:
        """Convert the formula."""
        object.__setattr__(self, "rate", as_value(self.rate, f"state '{self.name}'"))


@refuses_unknown_entries
@dataclass(frozen=True)
class Rotor:
    """A motor's rotor that spins `ratio` times as fast as a joint speed, about an axis fixed in its carrier.

    Its mass, and its inertia as if it were locked, belong to the carrier's own inertia; this adds what the spin brings:
    inertia on the joint, coupling to the carrier's rotation, and the gyroscopic moments.

    Attributes:
        inertia: Inertia about the spin axis [kg m^2].
        ratio: Spin relative to the carrier per joint speed.
        axis: Spin axis in the carrier's body frame; the joint's own axis if not given, which then needs the default
            carrier.
        carrier: Body that bears the rotor; the joint's parent if not given.
        coordinate: Index of the speed of the joint that drives it, from 0.
    """

    inertia: Value
    ratio: Value = 1.0
    axis: Vector | None = None
    carrier: str | None = None
    coordinate: int = 0

    def __post_init__(self) -> None:
        """Convert the numbers."""
        object.__setattr__(self, "inertia", as_value(self.inertia, "rotor: inertia"))
        object.__setattr__(self, "ratio", as_value(self.ratio, "rotor: ratio"))
        if self.axis is not None:
            object.__setattr__(self, "axis", as_vector(self.axis, "rotor: axis"))


@refuses_unknown_entries
@dataclass(frozen=True)
class Load:
    """A force and a torque on a body, by formulas of inputs, parameters, coordinates, speeds and t.

    Attributes:
        force: Force [N].
        torque: Moment [N m].
        at: Point of application: "body" (the body frame's origin), "center_of_mass", or a frame of the body.
        axes: Axes of the components: "body" (those of that frame for an extremity frame), or "world".
    """

    force: Vector = ORIGIN
    torque: Vector = ORIGIN
    at: str = "body"
    axes: Literal["body", "world"] = "body"

    def __post_init__(self) -> None:
        """Convert the components."""
        object.__setattr__(self, "force", as_vector(self.force, "load: force"))
        object.__setattr__(self, "torque", as_vector(self.torque, "load: torque"))
        if self.axes not in ("body", "world"):
            raise DescriptionError(
                f"load: axes '{self.axes}'", str(self.axes), "axes are 'body' or 'world'", "choose one"
            )


Anchor = tuple[str, str | None]


@refuses_unknown_entries
@dataclass(frozen=True)
class Connection:
    """A spring and damper along the line between two frames, which pulls and pushes.

    A cable that only pulls, or a length that an input gives, is a force by formula: T = max(0, k*(d - length)) with the
    distance d in terms of coordinates, in a `Load` in world axes or in `VirtualPower`.

    Attributes:
        name: Unique name.
        first: First end: (body, frame), frame None for the body frame; "world" for the ground.
        second: Second end: (body, frame).
        stiffness: Stiffness [N/m].
        length: Length at rest [m]. With a length of zero the direction does not matter, and the ends may meet.
        damping: Damping coefficient [N s/m].
    """

    name: str
    first: Anchor
    second: Anchor
    stiffness: Value = 0.0
    length: Value = 0.0
    damping: Value = 0.0

    def __post_init__(self) -> None:
        """Convert the numbers."""
        for label in ("stiffness", "length", "damping"):
            object.__setattr__(self, label, as_value(getattr(self, label), f"connection '{self.name}': {label}"))


@refuses_unknown_entries
@dataclass(frozen=True)
class VirtualPower:
    """Internal forces by their virtual power, the sum of force_k times the virtual change of speed k.

    Attributes:
        name: Unique.
        forces: Speed, as formulas call it (dq1) -> formula of coordinates, speeds, inputs, parameters and t.
    """

    name: str
    forces: tuple[tuple[str, Value], ...]

    def __post_init__(self) -> None:
        """Accept a mapping, and convert the formulas."""
        what = f"virtual power '{self.name}'"
        listed = pairs_of(self.forces, what)
        object.__setattr__(self, "forces", tuple((name_of(k), as_value(x, f"{what}: {k}")) for k, x in listed))


@refuses_unknown_entries
@dataclass(frozen=True)
class Potential:
    """A potential energy by formula of coordinates, parameters and t [J]; its forces follow by differentiation."""

    name: str
    energy: Value

    def __post_init__(self) -> None:
        """Convert the formula."""
        object.__setattr__(self, "energy", as_value(self.energy, f"potential '{self.name}'"))
