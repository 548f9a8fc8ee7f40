"""The harness's own rod: an adaptive integration of the same strains, and rates along a motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.rods import HUB, STIFF, integrated, rod
from validation.mechanics import carried
from validation.mechanics.assembly import assemble
from validation.mechanics.rod import StrainRod

# Of differences of sixth order along a motion.
STEP, FIRST, SECOND = 1e-2, ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)), ((1, 3 / 2), (2, -3 / 20), (3, 1 / 90))


def test_rod_sections_match_an_adaptive_integration(rng: np.random.Generator) -> None:
    counts, stations = (3, 2, 2), np.array([0.0, 0.3, 0.75, 1.0])
    q = 0.5 * rng.standard_normal((1, 7))
    one = StrainRod(rod(counts), {})
    p, R = integrated(counts, q[0], stations)
    assert one.axis(one.length * stations, q, 0 * q).value[0] / one.length == pytest.approx(p, abs=1e-11)
    assert one.rotation(one.length * stations, q, 0 * q).R[0] == pytest.approx(R, abs=1e-11)


CASES: dict[str, dict[str, Any]] = {
    "legendre, stretched, sheared, bent without stress": {
        "stretch": 1,
        "shear_y": 2,
        "shear_z": 1,
        "curvature_y": "0.3 + x",
        "twist_rate": 0.2,
        **STIFF,
    },
    "splines with knots": {"family": "spline", "bend_y": 6},
}


@pytest.mark.parametrize("case", CASES)
def test_jacobians_and_accelerations_are_rates_along_a_motion(case: str, rng: np.random.Generator) -> None:
    stated = replace(rod((2, 1, 1), HUB), **CASES[case])
    assembly, beams = assemble(sf.System("s", (stated,))), {"rod": StrainRod(stated, {})}
    q, v, a = 0.3 * rng.standard_normal((3, 1, assembly.nv))

    def at(t: float) -> carried.Carried:
        states = carried.AllSpeeds(q + v * t + a * t**2 / 2, 0 * v, 0 * a)
        return carried.joined(carried.bodies(assembly, beams, states))

    now = carried.joined(carried.bodies(assembly, beams, carried.AllSpeeds(q, v, a)))
    ahead = {k: at(k * STEP) for k in (-3, -2, -1, 0, 1, 2, 3)}
    rate, R_rate, w_rate = (
        sum(w * (getattr(ahead[k], name) - getattr(ahead[-k], name)) for k, w in FIRST) / STEP
        for name in ("p", "R", "J_w")
    )
    bend = sum(w * (ahead[k].p - 2 * ahead[0].p + ahead[-k].p) for k, w in SECOND) / STEP**2
    assert np.einsum("nkai,ni->nka", now.J, v) == pytest.approx(rate, abs=1e-9)
    assert now.a == pytest.approx(bend, abs=1e-8)
    spin = R_rate @ now.R.swapaxes(-1, -2)
    w = np.einsum("nkai,ni->nka", now.J_w, v)
    assert np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], -1) == pytest.approx(w, abs=1e-9)
    alpha = np.einsum("nkai,ni->nka", w_rate, v) + np.einsum("nkai,ni->nka", now.J_w, a)
    assert now.alpha == pytest.approx(alpha, abs=1e-9)
