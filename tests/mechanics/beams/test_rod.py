"""Geometrically exact rods: sections, equations of motion, loads (docs/theory/rods.md)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.mechanics.beams.strain.theory import StrainShape
from tests.mechanics.beams.rods import CASES, HUB, integrated, rod, rod_system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities


@pytest.mark.parametrize("name", CASES)
def test_energy_is_kept_and_coriolis_matrix_gives_the_rate_of_mass(name: str) -> None:
    assert_agrees(identities.velocity_terms, rod_system(name))
    assert_agrees(identities.balanced, rod_system(name))


@pytest.mark.parametrize(
    ("counts", "sections", "error"), [((3, 0, 0), 12, 1e-10), ((0, 3, 0), 12, 1e-10), ((2, 2, 2), 16, 1e-8)]
)
def test_rod_sections_match_an_integrated_frame(
    counts: tuple[int, int, int], sections: int, error: float, rng: np.random.Generator
) -> None:
    stations = np.array([0.3, 0.75, 1.0])
    q = 0.5 * rng.standard_normal(sum(counts))
    p, R = StrainShape(rod(counts, sections=sections), {}, stations.tolist()).sections(q)
    expected_p, expected_R = integrated(counts, q, stations)
    assert np.abs(p - expected_p).max() < error
    assert np.abs(R - expected_R).max() < error
    assert np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max() < 1e-14


@pytest.mark.parametrize("counts", [(2, 2, 2), (3, 3, 3)])
def test_turns_converge_with_the_sixth_power_of_the_number_of_sections(counts: tuple[int, int, int]) -> None:
    q = np.array([0.9, -0.7, 0.4, 0.8, 0.5, -0.3, -0.6, 0.4, 0.5])
    if counts[0] == 2:
        q = q[[0, 1, 3, 4, 6, 7]]
    _, (expected,) = integrated(counts, q, np.array([1.0]))
    errors = [
        np.abs(StrainShape(rod(counts, sections=n), {}, [1.0]).sections(q)[1][0] - expected).max() for n in (8, 16)
    ]
    assert 5.4 < np.log2(errors[0] / errors[1]) < 7.5


@pytest.mark.parametrize("functions", [1, 2, 3])
def test_small_turns_are_integrated_exactly_by_as_many_sections_as_functions(functions: int) -> None:
    """Beside the root, whose section is known."""
    few, many = (
        sf.compile(
            sf.System("s", (rod((functions, 0, 0), HUB, sections=n),)),
            sf.Options(("mass_matrix",), backend="interpreter"),
        ).mass_matrix(np.zeros(functions + 1))
        for n in (functions, 9)
    )
    assert few == pytest.approx(many, rel=1e-13)


def test_small_strains_match_the_second_order_beam(rng: np.random.Generator) -> None:
    """Displacement functions whose second derivatives are 1 and xi, over L, as a user states them.

    Without twist, displacements and strains are the same coordinates up to terms of third degree. Sections that spin do
    so about axes that bending turns in one theory alone.
    """
    shapes = {"bend_y": ("xi^2/2", "xi^3/6"), "bend_z": ("xi^2/2",)}
    plain: dict[str, Any] = {"family": "user", "shapes": shapes, "theory": "second_order", "retain": "all"}
    functions = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "potential_energy")
    second = sf.compile(
        sf.System("s", (rod((2, 1, 0), HUB, rhoJ=0.0, **plain),)), sf.Options(functions, backend="interpreter")
    )
    exact = sf.compile(
        sf.System("s", (rod((2, 1, 0), HUB, rhoJ=0.0, family="polynomial", sections=12),)),
        sf.Options(functions, backend="interpreter"),
    )
    # Coordinates of displacements are those of strains times the length.
    scale = np.array([1.0, 1.3, 1.3, 1.3])
    direction, v = rng.standard_normal(4), rng.standard_normal(4)

    def differences(eps: float) -> np.ndarray:
        q = direction * np.array([1.0, eps, eps, eps])
        w = v * np.array([1.0, eps, eps, eps])
        ours, theirs = exact.bias(q, w), second.bias(scale * q, scale * w) * scale
        M = exact.mass_matrix(q) - second.mass_matrix(scale * q) * np.outer(scale, scale)
        Q = exact.generalized_force(q, w, ()) - second.generalized_force(scale * q, scale * w, ()) * scale
        return np.array([np.abs(ours - theirs).max(), np.abs(M).max(), np.abs(Q).max()])

    coarse, fine = differences(1e-2), differences(1e-3)
    # Strain forces are the same; M and h differ by terms of second degree.
    assert fine[2] < 1e-14
    assert np.all(0.0099 * coarse[:2] < fine[:2]) and np.all(fine[:2] < 0.0101 * coarse[:2])


def test_a_load_between_sections_and_one_along_the_rod_do_their_work(rng: np.random.Generator) -> None:
    loads = (
        sf.BeamLoad((1.0, -2.0, 0.5), (0.3, 0.2, -0.1), at=0.37, axes="world"),
        sf.BeamLoad(("0.2*x", -0.4, 0.3), axes="world"),
    )
    plain, loaded = (rod((2, 1, 1), rhoJ=0.04, loads=given) for given in ((), loads))
    forces = []
    for stated in (plain, loaded):
        m = sf.compile(sf.System("s", (stated,)), sf.Options(("generalized_force",), backend="interpreter"))
        forces.append(lambda q, m=m: m.generalized_force(q, 0 * q, ()))
    q, eps = 0.4 * rng.standard_normal(4), 1e-5
    xi, w = np.polynomial.legendre.leggauss(12)
    stations = np.concatenate([(xi + 1) / 2, [0.37]])
    shape = StrainShape(rod((2, 1, 1)), {}, stations.tolist())
    work = np.zeros(4)
    for i, step in enumerate(eps * np.eye(4)):
        (ahead, R_ahead), (behind, R_behind) = shape.sections(q + step), shape.sections(q - step)
        moved = 1.3 * (ahead - behind) / (2 * eps)
        spread = np.stack([0.2 * 1.3 * stations[:-1], 0 * xi - 0.4, 0 * xi + 0.3], axis=-1)
        turn = R_ahead[-1] @ R_behind[-1].T / (2 * eps)
        spin = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        work[i] = 0.65 * np.sum(w[:, None] * spread * moved[:-1]) + moved[-1] @ (1.0, -2.0, 0.5)
        work[i] += spin @ (0.3, 0.2, -0.1)
    # Five sections sum up what is spread; twelve nodes do here.
    assert np.abs(forces[1](q) - forces[0](q) - work).max() < 1e-5
