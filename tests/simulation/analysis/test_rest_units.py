"""Rests are the same in any units of length, mass and time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.analysis.equilibrium import Equilibrium
from tests.models import interpreted

# Metres, kilograms and seconds in units of the model.
UNITS = [
    (1.0, 1e6, 1.0),
    (1.0, 1e-6, 1.0),
    (1.0, 1.0, 1e-3),
    (1.0, 1.0, 1e3),
    (1e3, 1.0, 1.0),
    (1e-3, 1.0, 1.0),
    (1e-4, 1e-9, 1e-2),
    (1e6, 1e15, 1e3),
]
f = sf.formula
PARAMETERS = tuple(sf.Parameter(name, 1.0) for name in ("L", "M", "T"))


def rod(length: float) -> sf.Inertia:
    """A slender one of mass M along x, in a plane."""
    moment = f(f"{length * length / 12}*M*L^2")
    return sf.Inertia(f("M"), (f(f"{length / 2}*L"), 0, 0), (0, moment, moment))


def link(name: str, length: float, parent: str = "world", x: float = 0.0) -> sf.RigidBody:
    """One that turns about y, at the end of its parent or of the base."""
    joint = sf.Joint(f"q_{name}", "revolute", parent, "end" if parent != "world" else None, axis=(0, 1, 0))
    placed = replace(joint, position=(f(f"{x}*L"), 0, 0))
    return sf.RigidBody(name, placed, rod(length), (sf.Frame("end", (f(f"{length}*L"), 0, 0)),))


def four_bar() -> sf.System:
    """A loop of three links."""
    closure = sf.Closure("pin", ("b", "end"), ("c", "end"), ("x", "z"))
    return made(link("a", 0.4), link("b", 1.0, "a"), link("c", 0.7, x=1.0), constraints=(closure,))


def pushed() -> sf.System:
    """A slider-crank whose piston a spring pushes."""
    spring = sf.Spring(f("20*M/T^2"), f("1.2*L"))
    piston = sf.RigidBody("piston", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(spring,)), sf.Inertia(f("M")))
    closure = sf.Closure("pin", ("b", "end"), ("piston", None), ("x", "z"))
    return made(link("a", 0.4), link("b", 1.0, "a"), piston, constraints=(closure,))


def hung() -> sf.System:
    """A plate on three springs."""
    corners = ((0.2, 0, 0), (-0.1, 0.2, 0), (-0.1, -0.2, 0))
    above = ((0.5, 0, 1), (-0.3, 0.5, 1), (-0.3, -0.4, 1))
    inertia = sf.Inertia(f("M"), at(0.05, 0, 0), tuple(f(f"{moment}*M*L^2") for moment in (0.02, 0.03, 0.04)))
    plate = sf.RigidBody("plate", sf.Joint("f", "free"), inertia, frames(corners))
    ceiling = sf.RigidBody("ceiling", None, None, frames(above))
    springs = [sf.Connection(f"s{i}", ("world", i), ("plate", i), f("30*M/T^2"), f("0.3*L")) for i in "abc"]
    return made(ceiling, plate, connections=tuple(springs))


def at(x: float, y: float, z: float) -> tuple[float | sf.Expression, float | sf.Expression, float | sf.Expression]:
    """A place."""
    return f(f"{x}*L"), f(f"{y}*L"), f(f"{z}*L")


def frames(places: Sequence[tuple[float, float, float]]) -> tuple[sf.Frame, ...]:
    """Frames a, b, c."""
    return tuple(sf.Frame(name, at(*place)) for name, place in zip("abc", places, strict=True))


def made(*bodies: sf.RigidBody, **entries: Any) -> sf.System:
    """A system with the parameters of the units."""
    return sf.System("made", bodies, PARAMETERS, gravity=(0, 0, f("-9.81*L/T^2")), **entries)


# What it is, a guess in metres, and which coordinates are lengths.
SYSTEMS = {
    "four_bar": (four_bar, [-0.99, 0.18, -1.62], ()),
    "pushed": (pushed, [1.1, -1.5, 1.0], (2,)),
    "hung": (hung, [0.0, 0, 0.3, 0, 0, 0, 1], (0, 1, 2)),
}


@cache
def rest(name: str, units: tuple[float, float, float]) -> tuple[Equilibrium, np.ndarray]:
    """The rest from the guess, and its configuration in metres."""
    make, guess, lengths = SYSTEMS[name]
    factors = np.ones(len(guess))
    factors[list(lengths)] = units[0]
    found = sf.equilibrium(model(name), guess * factors, par=units)
    return found, found.q / factors


@cache
def model(name: str) -> sf.Model:
    """Compiled once, for all units."""
    return sf.compile(SYSTEMS[name][0]())


@pytest.mark.parametrize("units", UNITS, ids=str)
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_rest_is_the_same_in_other_units(name: str, units: tuple[float, float, float]) -> None:
    """In about as many steps, to the same digits, with the same words."""
    (here, q_here), (there, q_there) = rest(name, (1.0, 1.0, 1.0)), rest(name, units)
    assert q_there == pytest.approx(q_here, abs=1e-9)
    assert there.iterations <= here.iterations + 3
    assert len(there.notes) == len(here.notes)


def test_an_unstable_rest_is_noted_however_slowly_it_is_left() -> None:
    """An upright rod, at sqrt(3 g / (2 L)), on the earth and where gravity is faint."""
    upright = interpreted(made(link("a", 1.0)))
    for units in ((1.0, 1.0, 1.0), (1e4, 1e6, 1.0), (1.0, 1.0, 1e5), (1e4, 1.0, 1e9)):
        (note,) = sf.equilibrium(upright, [-1.5], par=units).notes
        assert f"leaves it at {np.sqrt(1.5 * 9.81) / units[2]:.3g} 1/s" in note
        assert sf.equilibrium(upright, [1.5], par=units).notes == ()
