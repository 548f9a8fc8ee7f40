"""A rod that flies free: energy and momentum are kept while it bends by radians."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.rods import rod

KEPT = ("forward_dynamics", "kinetic_energy", "potential_energy", "centroidal_momentum", "center_of_mass")


@pytest.mark.parametrize(
    ("counts", "shear", "bend"), [((3, 0, 0), {}, 1.4), ((1, 1, 1), {"stretch": 1, "EA": 300.0}, 0.8)]
)
def test_a_flying_rod_keeps_energy_and_momentum(
    counts: tuple[int, int, int], shear: dict[str, float], bend: float
) -> None:
    stated = rod(counts, sf.Joint("base", "free"), EI_z=0.5, rhoJ=0.04, **shear)
    m = sf.compile(sf.System("s", (stated,), gravity=(0, 0, 0)), sf.Options(KEPT, ()))
    v = np.zeros(m.nv)
    v[:6] = (0.3, -0.2, 0.0, 0.0, 0.0, 1.0) if counts[2] == 0 else (0.3, -0.2, 0.1, 0.5, 0.8, 1.0)
    v[6:9] = (30.0, -18.0, 0.0) if counts[2] == 0 else (12.0, -9.0, 12.0)
    run = sf.simulate(m, v0=v, t_end=1.0, method="dopri5", rtol=1e-10, atol=1e-11, output=0.1)
    assert np.abs(run.q[:, 7:]).max() > bend
    energy = m.kinetic_energy(run.q, run.v) + m.potential_energy(run.q)
    assert np.ptp(energy) < 1e-8 * energy[0]
    momentum = m.centroidal_momentum(run.q, run.v)
    assert np.ptp(momentum, axis=0).max() < 1e-8 * np.abs(momentum).max()
