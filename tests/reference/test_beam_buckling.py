"""Buckling: by a compressive load, by the beam's own weight, sideways."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

import symofros as sf
from tests.reference.beams import cantilever, compiled, data, stiffness

REFERENCE = data("buckling_cantilever")
FAMILIES = {"cantilever_eigenmodes": "clamped_free", "monomials": "polynomial", "cubic_bspline": "spline"}


def critical(K: np.ndarray, softening: np.ndarray) -> float:
    """The smallest positive load P at which K - P softening is singular."""
    # Each coordinate is scaled to unit stiffness: monomials lose digits otherwise.
    scale = 1.0 / np.sqrt(np.diag(K))
    inverse = scipy.linalg.eigvalsh(softening * np.outer(scale, scale), K * np.outer(scale, scale))
    return 1.0 / float(inverse.max())


def loaded(**changed: object) -> sf.Model:
    """Compressed by a force at the tip that keeps its direction."""
    load = sf.BeamLoad(("-P", 0, 0), at=1.0, axes="world")
    return compiled(cantilever(loads=(load,), **changed), parameters=[sf.Parameter("P", 0.0)])


@pytest.mark.parametrize("modes", range(1, 8))
@pytest.mark.parametrize("basis", FAMILIES)
def test_euler_load_matches_ritz_values_per_function(basis: str, modes: int) -> None:
    """The Ritz value of every basis at every number of functions, not only the limit."""
    m = loaded(bend_y=modes, family=FAMILIES[basis])
    K = stiffness(m)
    found = critical(K, K - stiffness(m, P=1.0))
    assert found == pytest.approx(REFERENCE["convergence_with_modes"][str(modes)][basis], rel=1e-8)


def heavy(**changed: object) -> sf.Model:
    """Under gravity along the beam, positive if it hangs."""
    return compiled(cantilever(**changed), gravity=("g", 0, 0), parameters=[sf.Parameter("g", 0.0)])


def test_a_column_buckles_under_its_weight() -> None:
    m = heavy(bend_y=5)
    K = stiffness(m)
    assert critical(K, K - stiffness(m, g=-1.0)) == pytest.approx(REFERENCE["greenhill_self_weight"], rel=1e-3)


@pytest.mark.parametrize("row", REFERENCE["gravity_frequencies_hanging_positive"], ids=lambda row: str(row["gamma"]))
def test_frequencies_of_hanging_columns_match_the_reference(row: dict[str, float | list[float]]) -> None:
    m = heavy(bend_y=10)
    K = stiffness(m, g=float(row["gamma"]))  # type: ignore[arg-type]
    found = np.sqrt(scipy.linalg.eigvalsh(K, m.mass_matrix(np.zeros(m.nq)))[:3])
    # Ten functions under a weight of fifty give the third frequency 5e-8 too high.
    np.testing.assert_allclose(found, row["omega"], rtol=1e-7)


# A strip clamped at one end, bent on edge by a force at the other end: it tips over and twists. EI_z = GJ = 1.
STIFF = 1e8


def lateral_load(functions: int, retain: str = "all") -> float:
    """The load at which the bent strip's stiffness against tipping is singular; nan if it never is."""
    beam = cantilever(
        bend_y=functions,
        bend_z=2,
        twist=functions,
        EI_y=STIFF,
        GJ=1.0,
        rhoJ=1.0,
        retain=retain,
        family="polynomial",
        loads=(sf.BeamLoad((0, 0, "P"), at=1.0),),
    )
    m = compiled(beam, parameters=[sf.Parameter("P", 0.0)])
    tipping = [i for i, name in enumerate(m.names.q) if "bend_z" not in name]
    still = np.zeros(m.nv)
    # Bending on edge is linear as long as the strip stays upright.
    bent = np.linalg.solve(stiffness(m), m.with_parameters(P=1.0).generalized_force(np.zeros(m.nq), still, ()))
    equilibrium = m.with_parameters(P=1.0)
    np.testing.assert_allclose(equilibrium.generalized_force(bent, still, ()), 0.0, atol=1e-7)
    K0, K1 = (stiffness(m, q)[np.ix_(tipping, tipping)] for q in (np.zeros(m.nq), bent))
    # The stiffness falls linearly with the load; its sign does not matter to the critical one.
    slope = scipy.linalg.eigvalsh(K0 - K1, K0).max()
    return 1.0 / float(slope) if slope > 1e-9 else np.nan


@pytest.mark.parametrize(("functions", "expected"), [(1, 6.0), (2, 4.485), (3, 4.050), (4, 4.016)])
def test_lateral_buckling_load_matches_ritz_values(functions: int, expected: float) -> None:
    """4.0126 sqrt(EI GJ)/L^2 (Prandtl 1899; Timoshenko & Gere), by the cubic part of the strain energy."""
    assert lateral_load(functions) == pytest.approx(expected, abs=0.6e-3)


def test_quadratic_strain_energy_never_buckles_sideways() -> None:
    assert np.isnan(lateral_load(3, "first_order"))
