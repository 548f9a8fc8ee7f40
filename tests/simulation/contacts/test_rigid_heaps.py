"""Heaps of balls: more contacts at once than one body has (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from functools import cache
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import symofros as sf
from tests.models import sampled
from tests.simulation.rigid_scenes import FINE, GROUND, G, sphere

RADIUS = 0.1


def heap(base: int) -> np.ndarray:
    """Centres of balls that touch each other in a ring on the ground, and of one upon them."""
    out = 1 / sin(pi / base)
    ring = [(out * cos(x), out * sin(x), 1.0) for x in 2 * pi * (0.25 + np.arange(base) / base)]
    return np.array([*ring, (0.0, 0.0, 1.0 + sqrt(4 - out * out))]) * RADIUS


@cache
def pyramid(friction: float, base: int = 3) -> sf.Model:
    """Balls of 1 kg, each of which may touch the ground and its neighbours: three contacts for each of the base."""
    names = [f"b{k}" for k in range(base + 1)]
    floors = [
        sf.Contact(f"f{k}", (name, None), GROUND, restitution=0.0, radius=RADIUS, friction=friction)
        for k, name in enumerate(names)
    ]
    ring = [(names[k], names[(k + 1) % base]) for k in range(base)]
    pairs = [
        sf.Contact(
            f"{a}_{b}",
            (a, None),
            (b, None),
            restitution=0.0,
            radius=RADIUS,
            friction=friction,
            surface="sphere",
            surface_radius=RADIUS,
        )
        for a, b in [*ring, *((name, names[base]) for name in names[:base])]
    ]
    return sf.compile(sf.System("pyramid", [sphere(n, 1.0, RADIUS) for n in names], connections=[*floors, *pairs]))


def piled(model: sf.Model, base: int = 3, lifted: float = 0.0) -> np.ndarray:
    """The heap, its uppermost ball lifted [m]."""
    q = model.neutral()
    q.reshape(base + 1, 7)[:, :3] = heap(base)
    q[-5] += lifted
    return q


@pytest.mark.parametrize("base", sampled([3, 4, 5], [3]))
@pytest.mark.parametrize("lifted", [0.0, 0.05])
def test_a_pyramid_stands_by_friction(base: int, lifted: float) -> None:
    """It carries its weight by up to fifteen contacts; a ball that drops on it, without restitution, rests there.

    The more balls it stands on the flatter it is: its friction exceeds the tangent of half the slope of its lines.
    """
    model = pyramid(0.8 if base == 5 else 0.5, base)
    run = sf.simulate(model, piled(model, base, lifted), t_end=0.2, dt=1e-3)
    assert run.outcome.kind == "finished"
    assert run.q[-1].reshape(base + 1, 7)[:, :3] == pytest.approx(heap(base), abs=1e-12)
    found = run.contact_forces()
    force = dict(zip(model.names.contacts, found.force[-1], strict=True))
    ground = sum(force[f"f{k}"] for k in range(base))
    upper = sum(force[f"b{k}_b{base}"] for k in range(base))
    assert ground == pytest.approx([0, 0, (base + 1) * G], abs=1e-9) and -upper == pytest.approx([0, 0, G], abs=1e-9)


def test_a_pyramid_without_friction_opens_evenly() -> None:
    """With c the cosine of the lines of centres, c_0 = sqrt(2/3), theta'^2 = g (c_0 - c)/(R (1 + 2 c^2)).

    The three move apart by 2 R cos theta', which is largest, and their contacts open, where 2 c^3 + 3 c = 2 c_0.
    """
    model = pyramid(0.0)
    run = sf.simulate(model, piled(model), t_end=0.3, **FINE)
    first = sqrt(2 / 3)
    last = brentq(lambda c: 2 * c**3 + 3 * c - 2 * first, 0, 1, xtol=1e-15)

    def pace(angle: float) -> float:
        c = cos(angle)
        return sqrt(G * (first - c) / (RADIUS * (1 + 2 * c * c)))

    begin, end = np.arccos(first), np.arccos(last)
    # From rest: the angle is that of the beginning and x^2.
    time = quad(lambda x: 2 * x / pace(begin + x * x), 0, sqrt(end - begin), epsabs=1e-12, epsrel=1e-12)[0]
    # By rounding one opens first, and those that it lets go at that instant are no events of their own.
    assert {found.name for found in run.events} <= {f"b{k}_b3 opens" for k in range(3)} and run.outcome.notes == ()
    assert run.events[0].t == pytest.approx(time, abs=1e-7) == run.events[-1].t
    at = run.q[-1].reshape(4, 7)[:3, :2]
    out = np.linalg.norm(at, axis=1)
    assert out == pytest.approx(2 * RADIUS * sin(end) + 2 * RADIUS * last * pace(end) * (0.3 - time), abs=1e-8)
    assert np.abs(run.v[-1].reshape(4, 6)[:3, :2].sum(axis=0)).max() < 1e-12
    assert np.ptp(run.kinetic_energy + run.potential_energy) < 1e-9
