"""What acts on a tree: tendons, actuators with what they are and have, a medium."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from .frames import ORIGIN, End, Vector


class Wrap(NamedTuple):
    """A surface that a tendon is tight around, on its way from one of its points to the next.

    Attributes:
        after: Number of the point before it.
        end: Its frame: the centre of a sphere, or a point of a cylinder's axis, which is z.
        radius: Its radius [m].
        is_sphere: Whether it is a sphere; otherwise a cylinder, as long as need be.
        side: Point of that frame outside of it, on whose side the tendon passes; () for the shortest way.
    """

    after: int
    end: End
    radius: float
    is_sphere: bool
    side: tuple[float, ...] = ()


class Muscle(NamedTuple):
    """An actuator whose gain and bias are those of a muscle, as MuJoCo's documentation states them.

    With l0 the length at rest, L = (length - least) / l0 + low and V = speed / (l0 fastest), where l0 is
    (greatest - least) / (high - low), gain = -peak FL(L) FV(V), bias = -peak FP(L).

    Attributes:
        activation: What multiplies the gain.
        lengths: Least and greatest length of the actuator.
        operating: What these are in units of l0: low and high.
        peak: Greatest active force at rest.
        zeros: L below and above which there is no active force.
        fastest: V is in units of this.
        passive: FP at the second of `zeros`.
        lengthening: FV at speeds above.
    """

    activation: float
    lengths: tuple[float, float]
    operating: tuple[float, float] = (0.75, 1.05)
    peak: float = 100.0
    zeros: tuple[float, float] = (0.5, 1.6)
    fastest: float = 1.5
    passive: float = 1.3
    lengthening: float = 1.2


class Medium(NamedTuple):
    """What surrounds the links, and drags at boxes of half sizes r with a link's moments of inertia.

    With u and w the speeds of the mass centre against the wind and of turning, along the link's axes, and r without a
    letter the mean of the three, its force and moment about x are -2 density r_y r_z |u_x| u_x - 6 pi viscosity r u_x
    and -density r_x (r_y^4 + r_z^4) |w_x| w_x / 2 - 8 pi viscosity r^3 w_x, and so on about y and z. Links have no
    products of inertia.

    Attributes:
        density: Density [kg/m^3].
        viscosity: Dynamic viscosity [Pa s].
        wind: Its velocity (3) in the world [m/s].
    """

    density: float
    viscosity: float
    wind: Vector = ORIGIN


class Activation(NamedTuple):
    """A state w of an actuator that its control u changes, and that stands in the control's place in its force.

    Attributes:
        kind: "integrator", w' = u; "filter", w' = (u - w) / T, stepped as w + h w'; "exact filter", the same, stepped
            as w + (u - w) (1 - exp(-h / T)); "muscle", a filter whose time is T0 (1/2 + 3/2 w) as w grows and
            T1 / (1/2 + 3/2 w) as it falls, with u within 0 and 1.
        state: w.
        times: Time constants [s]: none, T, or T0 and T1.
        limits: Least and greatest w after a step; () for none.
        is_early: Whether the force has w as it is after the step.
    """

    kind: str
    state: float
    times: tuple[float, ...] = ()
    limits: tuple[float, ...] = ()
    is_early: bool = False


@dataclass(frozen=True)
class Tendon:
    """A length, and the spring and the damper that act along it.

    Attributes:
        kind: "coupling", a sum of coordinates, or "path", as constraints have them.
        ends: See `Constraint`.
        coefficients: See `Constraint`.
        stiffness: Force against a unit of length beyond `rest`.
        damping: Force against a unit of the length's rate.
        rest: Length at which the spring has no force.
        armature: Mass that moves with the length.
        wraps: Surfaces on its way; of a "path" only.
        limits: Least and greatest length; () for none.
        friction: Greatest force of dry friction against its rate.
    """

    kind: str
    ends: tuple[End, ...]
    coefficients: tuple[float, ...] = ()
    stiffness: float = 0.0
    damping: float = 0.0
    rest: float = 0.0
    armature: float = 0.0
    wraps: tuple[Wrap, ...] = ()
    limits: tuple[float, ...] = ()
    friction: float = 0.0


@dataclass(frozen=True)
class Actuator:
    """A force along a coordinate, a tendon or between frames: gain control + bias, with l and l' the length times gear.

    Attributes:
        link: Link whose only joint it drives; "" for a tendon.
        tendon: Number of the tendon that it pulls; None for a joint.
        gear: Factor of length and force.
        gain: Force for a unit of control.
        slopes: What a unit of l and one of l' add to the gain.
        bias: Force b0 + b1 l + b2 l'.
        control: Control that it has.
        control_limits: Least and greatest control that counts; () for none.
        force_limits: Least and greatest force; () for none.
        ends: One frame: it makes the force and the moment `wrench` there, along its axes, and its length is zero. Two:
            its length is how far the first is from the second along `wrench`, which stands in the second. Of a
            `crank`: the end of the crank, and the slider's frame, which moves along its z.
        wrench: See `ends`.
        crank: Length of the rod of a slider and crank [m]: its length is the slider's coordinate. 0 for none.
        muscle: Gain and bias of a muscle, in place of the stated ones; None for none.
        is_disabled: Whether it makes no force.
        activation: Its state; None for none.
    """

    link: str = ""
    tendon: int | None = None
    gear: float = 1.0
    gain: float = 1.0
    slopes: tuple[float, float] = (0.0, 0.0)
    bias: Vector = ORIGIN
    control: float = 0.0
    control_limits: tuple[float, ...] = ()
    force_limits: tuple[float, ...] = ()
    ends: tuple[End, ...] = ()
    wrench: tuple[float, ...] = ()
    crank: float = 0.0
    muscle: Muscle | None = None
    is_disabled: bool = False
    activation: Activation | None = None

    @property
    def is_plain(self) -> bool:
        """Whether it is a force along a joint, or a servo of place and speed there, and no more; limits apart."""
        _, by_place, by_speed = self.bias
        is_servo = by_place < 0.0 >= by_speed
        beyond = self.muscle or self.activation or self.control_limits or self.is_disabled or any(self.slopes)
        return bool(self.link) and self.gear == 1.0 and not beyond and (is_servo or self.bias == ORIGIN)

    def fed(self, place: float, speed: float) -> float:
        """What a plain one adds to the force of its gains, of a place and a speed that it is to hold."""
        constant, by_place, by_speed = self.bias
        return self.gain * self.control + constant + by_place * place + by_speed * speed
