"""Beams by other statements of the same beam, and the balance of their power."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import symofros as sf

from ...contract.quantities import ROUNDING
from ...mechanics.geometry import Array
from ..scene import Cell, Scene, derivative, off

# Cubics over x/L that bend and twist a clamped beam, and the places of their samples, unevenly spaced.
_CUBICS = (sf.formula("3*xi^2 - xi^3"), sf.formula("2*xi - xi^3"))
_PLACES = (0.0, 0.17, 0.4, 0.58, 0.83, 1.0)
_AXIS = (0.48, -0.6, 0.64)
_DIFFERENCED = 1e-8


def sampled_shapes(_: Scene) -> Iterator[Cell]:
    """Shape functions by samples of cubics, as finite-element programs give them, are those cubics."""
    samples = (sf.Samples(_PLACES, tuple(cubic(x) for x in _PLACES)) for cubic in (_bending, _twist))
    stated, sampled = (_values(_cantilever(*shapes)) for shapes in (_CUBICS, samples))
    for name, value in stated.items():
        yield Cell(f"shapes by samples: {name}", off(sampled[name], value), ROUNDING)


def _bending(xi: float) -> float:
    return 3 * xi**2 - xi**3


def _twist(xi: float) -> float:
    return 2 * xi - xi**3


def _cantilever(bending: Any, twist: Any) -> sf.Model:
    beam = sf.Beam(
        "beam",
        sf.Joint("clamp", "fixed"),
        1.3,
        0.7,
        EI_y=2.0,
        GJ=1.5,
        rhoJ=0.05,
        bend_z=1,
        twist=1,
        family="user",
        shapes=(("bend_z", (bending,)), ("twist", (twist,))),
    )
    return sf.compile(sf.System("cantilever", (beam,)))


def _values(model: sf.Model) -> dict[str, Array]:
    q, v = np.array([0.02, 0.1]), np.array([0.3, -0.4])
    place, turned = model.frame_pose("beam.tip", q)
    energy = np.atleast_1d(model.potential_energy(q))
    return {
        "M": model.mass_matrix(q),
        "h": model.bias(q, v),
        "V": energy,
        "place of the tip": place,
        "its turn": turned,
    }


def power(_: Scene) -> Iterator[Cell]:
    """Energy changes by what damping takes: a beam that bends both ways and twists, on a hub about an oblique axis."""
    q, v = np.array([0.4, 0.03, -0.02, 0.04]), np.array([1.3, 0.7, -0.9, 1.1])
    hub = sf.Joint("hub", "revolute", position=(0.2, 0, 0), axis=_AXIS)
    beam = sf.Beam(
        "beam",
        hub,
        1.3,
        0.7,
        EI_z=3.0,
        EI_y=2.0,
        GJ=1.5,
        rhoJ=0.05,
        rhoI_y=0.02,
        rhoI_z=0.03,
        bend_y=1,
        bend_z=1,
        twist=1,
        damping=0.1,
        rotary_inertia=True,
        retain="all",
    )
    model = sf.compile(sf.System("hub", (beam,)))
    a = model.forward_dynamics(q, v, ())

    def energy(t: Array) -> Array:
        at, speeds = q + t * v + 0.5 * t * t * a, v + t * a
        return np.atleast_1d(model.kinetic_energy(at, speeds) + model.potential_energy(at))

    rate = derivative(energy, np.zeros(1))[0, 0]
    taken = v @ (model.generalized_force(q, v, ()) - model.generalized_force(q, 0 * v, ()))
    yield Cell("power of damping", abs(rate - taken) / abs(taken), _DIFFERENCED)


def in_a_plane(_: Scene) -> Iterator[Cell]:
    """Rods that bend in a plane, by formulas for it where they hold: the same as those that know no plane."""
    given: dict[str, Any] = {
        "EI_z": 1.7,
        "bend_y": 2,
        "theory": "strain",
        "rhoI_y": 1e-3,
        "rhoI_z": 2e-3,
        "rotary_inertia": True,
    }
    loads = (sf.BeamLoad(force=(0.3, -0.2, 0.0), at=0.4), sf.BeamLoad(force=(0.1, 0.4, 0.0), axes="world"))
    options = sf.Options(("mass_matrix", "bias", "generalized_force", "frame_pose"), backend="interpreter")
    cases: dict[str, dict[str, Any]] = {
        "straight": {},
        "loaded": {"loads": loads},
        "mass beside its axis": {"mass_center": (0.02, 0.0)},
        "damped, curved": {"curvature_z": 0.4, "damping": 0.01},
    }
    for what, more in cases.items():
        models = [
            sf.compile(
                sf.System(
                    "rod",
                    (
                        sf.Beam(
                            "rod", sf.Joint("q", "revolute", axis=(0, 0, 1)), 0.8, 0.5, **given, **more, rhoI_yz=tilt
                        ),
                    ),
                ),
                options,
            )
            for tilt in (0.0, 1e-200)
        ]
        q, v = 0.3 * np.random.default_rng(24).standard_normal((2, models[0].nv))
        pairs = zip(
            *(
                (m.mass_matrix(q), m.bias(q, v), m.generalized_force(q, v, []), m.frame_pose("rod.tip", q)[0])
                for m in models
            ),
            strict=True,
        )
        yield Cell(f"a rod in a plane, {what}", max(off(one, other) for one, other in pairs), 1e-9)
