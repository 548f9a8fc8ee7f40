"""Relations between what a model says, with noise of 1e-16 to 1e-6 in every number that is stated.

None of them asks for a right value: M follows from inverse dynamics, from kinematics and from energy; neither the
place of the world, nor how a body is divided, nor the order of siblings, nor a file changes what moves.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.noise import with_noise
from reference_models.rigid.random_tree import MORE_KINDS, random_tree
from tests.models import sampled
from tests.validation.subjects import subject_of
from validation.adapters import interpreted
from validation.comparison.errors import typical_scales
from validation.comparison.relations import Related, judge_relations
from validation.inputs.sampling import sample

pytestmark = pytest.mark.filterwarnings("ignore::symofros.InconsistentModelWarning")

# Rounding of sums of some hundred terms, relative to the largest entry; noise of any size above it would be seen.
ROUNDING = 1e-12
FUNCTIONS = ("mass_matrix", "bias", "inverse_dynamics", "kinetic_energy", "frame_jacobian", "frame_pose")
TREES = tuple(f"tree{seed}" for seed in range(40))
LOOPS = ("four_bar", "slider_crank", "stewart", "rolling_disc", "bricard", "andrews_squeezer")
BEAMS = ("flexible_pendulum", "planar_robot", "free_boom", "spinning_beam")
RODS = ("spatial_rod", "soft_pendulum")
RIGID = ("car", "flyball_governor", "gyroscope", "chain7", "stanford_arm", "space_arm")
# With other noise each in wide runs.
NAMED = tuple(f"{name}:{seed}" for seed in range(2) for name in (*LOOPS, *BEAMS, *RODS, *RIGID))
SOME_TREES = TREES[:6]
SOME = (*SOME_TREES, "four_bar:0", "stewart:0", "rolling_disc:0", "flexible_pendulum:0", "spatial_rod:0", "car:0")
CASES = (*TREES, *NAMED)


@cache
def system(case: str) -> sf.System:
    """A random tree or a reference model, with noise."""
    name, _, seed = case.partition(":")
    if seed:
        return with_noise(MODELS[name], int(seed))
    number = int(case.removeprefix("tree"))
    return with_noise(random_tree(number, n=4, kinds=MORE_KINDS, noisy=True), number)


def compiled(stated: sf.System) -> sf.Model:
    functions = tuple(f for f in FUNCTIONS if not f.startswith("frame") or not any_beams(stated))
    functions += ("constraint", "constraint_jacobian") * bool(stated.constraints)
    return sf.compile(stated, sf.Options(functions, backend="interpreter"))


@cache
def model(case: str) -> sf.Model:
    return compiled(system(case))


def any_beams(stated: sf.System) -> bool:
    return any(isinstance(body, sf.Beam) for body in stated.bodies)


def state(case: str) -> tuple[np.ndarray, np.ndarray]:
    return model(case).random_state(np.random.default_rng(len(case)))


def assert_same(found: np.ndarray, expected: np.ndarray, scale: float = 0.0) -> None:
    largest = max(scale, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING * largest)


@pytest.mark.parametrize("case", sampled(CASES, SOME))
def test_the_mass_matrix_agrees_with_inverse_dynamics_and_kinetic_energy(case: str) -> None:
    m, (q, v) = model(case), state(case)
    M = m.mass_matrix(q)
    forces = m.inverse_dynamics(q, v, np.vstack([np.zeros(m.nv), np.eye(m.nv)]))
    assert_same((forces[1:] - forces[0]).T, M, float(np.abs(forces).max()))
    assert_same(m.kinetic_energy(q, v), 0.5 * v @ M @ v)
    assert np.array_equal(M, M.T) and np.linalg.eigvalsh(M).min() > -ROUNDING * np.abs(M).max()


@pytest.mark.parametrize("case", sampled(CASES, SOME))
def test_equivalent_descriptions_give_the_same_dynamics(case: str) -> None:
    """The relations of check: another world, order, division, names, units and format of the same mechanism."""
    subject = subject_of(system(case))
    ours = interpreted.build(subject)
    states = sample(subject.assembly, ours.model.nu, 16)
    scales = typical_scales(ours, states)
    rows = list(judge_relations(Related(subject, subject.assembly, ours, states, scales, np.inf, states)))
    assert not [row for row in rows if not row.ok]
    assert sum(row.status == "agree" for row in rows) >= 4


@pytest.mark.parametrize("case", sampled(CASES, SOME))
def test_a_file_keeps_every_bit(case: str, tmp_path: Path) -> None:
    sf.save(system(case), tmp_path / "saved.yaml")
    again, m, (q, v) = compiled(sf.load(tmp_path / "saved.yaml")), model(case), state(case)
    assert again.names.q == m.names.q
    assert np.array_equal(again.mass_matrix(q), m.mass_matrix(q)) and np.array_equal(again.bias(q, v), m.bias(q, v))


@pytest.mark.parametrize("case", sampled(CASES, SOME))
def test_relative_noise_moves_results_in_proportion(case: str) -> None:
    """Noise of 1e-9 in all that is stated: M and constraints by some thousand times that, not by shares of it."""
    name, _, seed = case.partition(":")
    plain = MODELS[name] if seed else random_tree(int(name.removeprefix("tree")), n=4, kinds=MORE_KINDS)
    size = 1e-9
    exact, noisy = compiled(plain), compiled(with_noise(plain, 3, size))
    q, v = exact.random_state(np.random.default_rng(1))
    M, T = exact.mass_matrix(q), exact.kinetic_energy(q, v)
    np.testing.assert_allclose(noisy.mass_matrix(q), M, rtol=0, atol=1e3 * size * np.abs(M).max())
    np.testing.assert_allclose(noisy.kinetic_energy(q, v), T, rtol=0, atol=1e3 * size * np.abs(M).max() * (v @ v))
    if plain.constraints:
        np.testing.assert_allclose(noisy.constraint(q), exact.constraint(q), rtol=0, atol=1e3 * size)
        G = exact.constraint_jacobian(q)
        np.testing.assert_allclose(noisy.constraint_jacobian(q), G, rtol=0, atol=1e3 * size * np.abs(G).max())


# Without beams that are stiff: steps of their order would be many.
MOVING = (*TREES[:20], *(f"{name}:0" for name in ("flexible_pendulum", "spinning_beam", *RODS, *RIGID)))


@pytest.mark.parametrize("case", sampled(MOVING, (*SOME_TREES[:2], "flexible_pendulum:0")))
def test_runs_repeat_their_bits_and_converge_by_their_order(case: str) -> None:
    stated = system(case)
    m = sf.compile(stated, sf.Options(("forward_dynamics",)))
    q, v = m.random_state(np.random.default_rng(2))
    steps = 0.01 / (1.0 + float(np.abs(v).max())) / (8.0 if any_beams(stated) else 1.0) * 0.5 ** np.arange(3)

    def end(dt: float) -> np.ndarray:
        run = sf.simulate(m, q, 0.3 * v, 16 * steps[0], dt=dt, method="rk4")
        return np.concatenate([run.q[-1], run.v[-1]])

    first, second, third = (end(float(dt)) for dt in steps)
    assert np.array_equal(second, end(float(steps[1])))
    coarse, fine = np.abs(first - second).max(), np.abs(second - third).max()
    rounding = 1e-12 * np.abs(third).max()
    # Of order four sixteen; a half of it where the next term still counts.
    assert fine <= coarse / 8.0 + rounding
