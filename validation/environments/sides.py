"""A function of a model at some states, as each side of a race offers it; the native one, which all must agree with."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf

from ..mechanics.geometry import Array
from ..timing.models import TIMED_MODELS
from ..timing.task import flat
from .record import NATIVE

# Readers of URDF that want an inertia of every link: any of the base, which stands still, none of others without mass.
_INERTIAL = (
    '<inertial><origin xyz="0 0 0" rpy="0 0 0"/><mass value="{0}"/>'
    '<inertia ixx="{0}" ixy="0" ixz="0" iyy="{0}" iyz="0" izz="{0}"/></inertial>'
)
# Third input of each function, and inputs that are cotangents: of its value, and of the multipliers that trees lack.
_INPUTS: dict[str, tuple[str, tuple[str, ...]]] = {
    "dynamics": ("u", ()),
    "forward_dynamics": ("u", ("a_bar", "lam_bar")),
    "inverse_dynamics": ("a", ("tau_bar",)),
}


@dataclass(frozen=True)
class Subject:
    """A model and its states.

    Attributes:
        label: Label of the model.
        system: The description: a rigid tree of one-coordinate joints, with a motor each.
        model: The same, compiled: native C.
        q, v, w, cotangent: States (n, nv): `w` stands for u of forward and for a of inverse dynamics.
    """

    label: str
    system: sf.System
    model: sf.Model
    q: Array
    v: Array
    w: Array
    cotangent: Array

    @classmethod
    def of(cls, label: str, states: int) -> Subject:
        """A model of the race of times, at seeded states within 1 rad, 1 rad/s, 1 N m or 1 rad/s^2."""
        system = TIMED_MODELS[label].load()
        model = sf.compile(system).with_threads(1)
        rng = np.random.default_rng(25)
        q, v, w, cotangent = (rng.uniform(-1.0, 1.0, (states, model.nv)) for _ in range(4))
        return cls(label, system, model, q, v, w, cotangent)

    def at(self, function: str, states: int) -> tuple[Array, ...]:
        """The arguments of a function at the first states: q, v, w, and cotangents where it takes them."""
        given = (self.q, self.v, self.w, *([self.cotangent] if function.endswith("_vjp") else []))
        return tuple(array[:states] for array in given)

    @property
    def gravity(self) -> list[float]:
        """Acceleration of gravity, with zeros for a spatial vector's angular part (6) [m/s^2, rad/s^2]."""
        stated: Any = self.system.gravity  # Numbers, in the models that are raced.
        return [*map(float, stated), 0.0, 0.0, 0.0]

    def urdf(self) -> str:
        """The mechanism as text of a URDF in which every link has an inertia."""
        with tempfile.TemporaryDirectory() as folder:
            sf.export(self.system, "urdf", folder, name="robot")
            text = (Path(folder) / "robot.urdf").read_text(encoding="utf-8")

        children = re.findall(r'<child link="([^"]*)"', text)

        def with_inertia(link: re.Match[str]) -> str:
            return f'<link name="{link[1]}">{_INERTIAL.format(int(link[1] not in children))}</link>'

        return re.sub(r'<link name="([^"]*)"\s*/>', with_inertia, text)


@dataclass(frozen=True)
class Side:
    """A function by one side, ready to be timed.

    Attributes:
        who: Name of the side.
        call: Evaluate it at all states of a call, and wait until that is done.
        results: What a call gave, state by state (n, size).
    """

    who: str
    call: Callable[[], object]
    results: Callable[[], Array]


# Function and states in a call -> the side, or None where the peer has no such function.
Offer = Callable[[str, int], Side | None]


@dataclass(frozen=True)
class Peer:
    """Someone else in the same environment.

    Attributes:
        name: Name in tables.
        module: What is imported of it.
        package: Distribution that it comes in.
        install: Command that installs it.
        offer: Makes its side of each function of a subject.
    """

    name: str
    module: str
    package: str
    install: str
    offer: Callable[[Subject], Offer]


@dataclass(frozen=True)
class Environment:
    """A framework in which functions are raced by Python.

    Attributes:
        name: Name in tables and on the command line.
        title: Heading.
        own: The framework with our side.
        functions: Functions that are raced.
        peers: Whom we race.
        settings: Variables of the process, read as the framework loads.
        limits: What is timed, in words.
    """

    name: str
    title: str
    own: Peer
    functions: tuple[str, ...]
    peers: tuple[Peer, ...]
    limits: str
    settings: Mapping[str, str] = field(default_factory=dict)


def plain(function: str) -> str:
    """The function that one is, or is a derivative of."""
    base, found, _ = function.partition("_dynamics")
    return base + found


def native(subject: Subject, function: str, states: int) -> Side:
    """Our C, called from Python."""
    model, (q, v, w, *cotangent) = subject.model, subject.at(function, states)
    if states == 1:
        q, v, w, *cotangent = (array[0] for array in (q, v, w, *cotangent))
    base = plain(function)
    third, cotangents = _INPUTS[base]
    named: dict[str, Any] = {"q": q, "v": v, third: w}
    if cotangent:
        named |= dict(zip(cotangents, (*cotangent, np.zeros((*q.shape[:-1], 0))), strict=False))

    wanted = {"dynamics": ("M", "h"), f"{base}_vjp": ("by_q", "by_v", f"by_{third}")}.get(function)
    names = [name for name, _ in model.kernel(function).signature.outputs]
    kept = [names.index(name) for name in wanted] if wanted else range(1 if function == base else 3)

    def call() -> list[Array]:
        values = model.evaluate(function, **named)
        if function == "inverse_dynamics_derivatives":
            values += model.evaluate("mass_matrix", q=q)
        return values

    def results() -> Array:
        values = call()
        return flat(*(values[k].reshape(states, -1) for k in kept))

    return Side(NATIVE, call, results)
