"""What a tree carries: velocities and accelerations are the rates of places and turns along a motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.rods import HUB, STIFF, rod
from validation.mechanics import carried
from validation.mechanics.assembly import Assembly, assemble
from validation.mechanics.elastic import ElasticBeam
from validation.mechanics.rod import StrainRod

# Of differences of sixth order along a motion.
STEP = 1e-2
FIRST = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
SECOND = ((1, 3 / 2), (2, -3 / 20), (3, 1 / 90))


def tree() -> tuple[Assembly, dict[str, ElasticBeam]]:
    """Joints whose speeds are rates of coordinates, a driven one and a beam of all directions among them."""
    beam = sf.Beam(
        "b",
        sf.Joint("turn", "universal", "slide", axis=(1, 2, 2), axis2=(0, 1, 0)),
        1.3,
        2.0,
        EI_z=3.0,
        EI_y=5.0,
        GJ=1.5,
        rhoJ=0.04,
        bend_y=2,
        bend_z=2,
        twist=2,
        family="legendre",
    )
    bodies = [
        sf.RigidBody("slide", sf.Joint("s", "screw", position=(0.1, 0, 0), axis=(0, 1, 1), pitch=0.3)),
        beam,
        sf.RigidBody("last", sf.Joint("d", "revolute", "b", "tip", axis=(1, 0, 1), prescribed=True)),
    ]
    system = sf.System("tree", bodies)
    return assemble(system), {"b": ElasticBeam(beam, {})}


def strained(**stated: Any) -> tuple[Assembly, dict[str, StrainRod]]:
    """A geometrically exact rod on a turning hub."""
    beam = replace(rod((2, 1, 1), HUB), **stated)
    return assemble(sf.System("s", (beam,))), {"rod": StrainRod(beam, {})}


# What is carried, and how many prescribed speeds it has.
CASES: dict[str, tuple[Any, int]] = {
    "tree": (tree(), 1),
    "rod by Legendre polynomials, stretched, sheared, bent without stress": (
        strained(stretch=1, shear_y=2, shear_z=1, curvature_y="0.3 + x", twist_rate=0.2, **STIFF),
        0,
    ),
    "rod by splines with knots": (strained(family="spline", bend_y=6), 0),
}


@pytest.mark.parametrize("case", CASES)
def test_jacobians_and_accelerations_are_rates_along_a_motion(case: str, rng: np.random.Generator) -> None:
    (assembly, beams), prescribed = CASES[case]
    q, v, a = 0.3 * rng.standard_normal((3, 1, assembly.nv + prescribed))

    def at(t: float) -> carried.Carried:
        states = carried.AllSpeeds(q + v * t + a * t**2 / 2, 0 * v, 0 * a)
        return carried.joined(carried.bodies(assembly, beams, states))

    now = carried.joined(carried.bodies(assembly, beams, carried.AllSpeeds(q, v, a)))
    ahead = {k: at(k * STEP) for k in (-3, -2, -1, 0, 1, 2, 3)}
    rate = {
        name: sum(w * (getattr(ahead[k], name) - getattr(ahead[-k], name)) for k, w in FIRST) / STEP
        for name in ("p", "R", "J_w")
    }
    bend = sum(w * (ahead[k].p - 2 * ahead[0].p + ahead[-k].p) for k, w in SECOND) / STEP**2
    assert np.einsum("nkai,ni->nka", now.J, v) == pytest.approx(rate["p"], abs=1e-9)
    assert now.a == pytest.approx(bend, abs=1e-8)
    spin = rate["R"] @ now.R.swapaxes(-1, -2)
    w = np.einsum("nkai,ni->nka", now.J_w, v)
    assert np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], -1) == pytest.approx(w, abs=1e-9)
    alpha = np.einsum("nkai,ni->nka", rate["J_w"], v) + np.einsum("nkai,ni->nka", now.J_w, a)
    assert now.alpha == pytest.approx(alpha, abs=1e-9)


def test_slopes_are_derivatives_of_places_along_the_axis() -> None:
    _, beams = tree()
    beam = beams["b"]
    rng = np.random.default_rng(4)
    q, v = 0.3 * rng.standard_normal((2, 1, beam.beam.modes))
    x, h = 0.7, 1e-2
    stations = np.array([x + k * h for k in (-3, -2, -1, 0, 1, 2, 3)])
    places, slopes = beam.axis(stations, q, v), beam.tangent(stations, q, v)
    for name in ("value", "partial", "bend"):
        place, slope = getattr(places, name)[0], getattr(slopes, name)[0]
        difference = sum(w * (place[3 + k] - place[3 - k]) for k, w in FIRST) / h
        assert slope[3] == pytest.approx(difference, abs=1e-9), name
