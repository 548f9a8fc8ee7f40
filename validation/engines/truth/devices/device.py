"""One small model of MJCF: its text, what it is set to, what is read of it, and what that is by a formula."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import NamedTuple

import numpy as np

from ...interface import STEP
from ..arithmetic import Exact, arc, exact, quaternion_rotation
from ..dynamics import Point, Truth

H = Decimal(STEP)


class Device(NamedTuple):
    """One model.

    Attributes:
        about: The elements and attributes that it is about.
        model: The text.
        given: Fields of the data that are set, as code of arguments: "qpos=v[:1], ctrl=tau[:1]".
        read: Field of the data that is read, and what of it: "sensordata[:3]".
        value: What it is, of a state.
        steps: Steps that are taken first; 0: the field is read after forward dynamics.
    """

    about: str
    model: str
    given: str
    read: str
    value: Callable[[Point], object]
    steps: int = 0

    @property
    def text(self) -> str:
        """What is asked, in words."""
        after = f" after {self.steps} steps" if self.steps else ""
        return f"{self.read}{after} of a model with {self.about}, at {self.given}"

    def truth(self, t: Truth, s: Point) -> Exact:
        """The value as an array."""
        return np.atleast_1d(np.array(self.value(s), dtype=object))

    @property
    def code(self) -> str:
        """Statements that leave it in `value`, by a function `answer` of the plug-in's."""
        field, bracket, places = self.read.partition("[")
        given = f", {self.given}" if self.given else ""
        return f"value = answer('''{self.model}''', {field!r}, {self.steps}{given}){bracket}{places}"


def model(world: str, after: str = "", option: str = "", inside: str = "", head: str = "") -> str:
    """MJCF without gravity, with steps of `interface.STEP`."""
    stated = "" if "gravity=" in option else ' gravity="0 0 0"'
    return (
        f'<mujoco><compiler angle="radian"/><option timestep="{STEP}"{stated} {option}>{inside}</option>{head}'
        f"<worldbody>{world}</worldbody>{after}</mujoco>"
    )


# A ball of 2 kg: moments 2/5 m r^2 = 1/8 with a radius of 0.395...; bodies state theirs.
MASS, MOMENT = Decimal(2), Decimal("0.125")
INERTIAL = '<inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/>'


def body(joint: str, more: str = "", attributes: str = "") -> str:
    """A body of MASS and MOMENT on a joint."""
    return f'<body name="b" {attributes}>{INERTIAL}{joint}{more}</body>'


def slide(attributes: str = "", more: str = "", body_has: str = "") -> str:
    """A body on a slide along x."""
    return body(f'<joint name="j" type="slide" axis="1 0 0" {attributes}/>', more, body_has)


BALL = '<joint name="j" type="ball"/>'


def number(x: float | str) -> Exact:
    """A double in many digits."""
    return exact(float(x))[()]


def pi() -> Exact:
    """Half a turn."""
    return arc(Decimal(-1), Decimal(0))


def turn_of(q: Exact) -> Exact:
    """The rotation (3, 3) of a quaternion w, x, y, z of any length."""
    return quaternion_rotation(*q)


def clipped(x: Exact, least: float, greatest: float) -> Exact:
    """A number within bounds."""
    return min(max(x, number(least)), number(greatest))
