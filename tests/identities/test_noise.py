"""Relations between what a model says, with noise of 1e-16 to 1e-6 in every number that is stated.

None of them asks for a right value: M follows from inverse dynamics, from kinematics and from energy; neither the
place of the world, nor how a body is divided, nor the order of siblings, nor a file changes what moves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.noise import with_noise
from reference_models.rigid.random_tree import MORE_KINDS, noisy_rotation, random_tree
from symofros.mechanics.topology.numbers import Numbers
from tests.models import sampled

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


def _turned(stated: sf.System, rng: np.random.Generator) -> sf.System:
    """All of it in another place, gravity included; nothing but the roots and weight knows of the world."""
    rotation = noisy_rotation(rng)
    R = Numbers(sf.System("s")).rotation(rotation)
    x, y, z = map(float, rng.uniform(-5, 5, 3))
    placed = sf.RigidBody("elsewhere", sf.Joint("placed", "fixed", "world", None, (x, y, z), rotation))
    bodies = [placed]
    for body in stated.bodies:
        joint = body.joint or sf.Joint(f"{body.name} held", "fixed")
        bodies.append(replace(body, joint=replace(joint, parent="elsewhere") if joint.parent == "world" else joint))
    gravity = R @ Numbers(stated).values(stated.gravity)
    return replace(stated, bodies=tuple(bodies), gravity=tuple(map(float, gravity)))


def _halved(stated: sf.System, rng: np.random.Generator) -> sf.System:
    """A part of each body as one of its own that is welded to it somewhere."""
    bodies = list(stated.bodies)
    for k, body in enumerate(stated.bodies):
        if not isinstance(body, sf.RigidBody) or body.inertia is None or body.inertia.about == "body":
            continue
        share, inertia = float(rng.uniform(0.2, 0.8)), body.inertia
        if not all(isinstance(x, float) for x in (inertia.mass, *inertia.center_of_mass, *inertia.moments)):
            continue
        frame, place = noisy_rotation(rng), rng.uniform(-0.5, 0.5, 3)
        numbers = Numbers(stated)
        R = numbers.rotation(frame)
        center = R.T @ (numbers.values(inertia.center_of_mass) - place)
        matrix = R.T @ numbers.rotation(inertia.rotation)
        parts = {
            name: (float(part * inertia.mass), tuple(float(part * x) for x in inertia.moments))
            for name, part in (("rest", 1.0 - share), ("part", share))
        }
        bodies[k] = replace(body, inertia=replace(inertia, mass=parts["rest"][0], moments=parts["rest"][1]))
        weld = sf.Joint(f"{body.name} weld", "fixed", body.name, None, tuple(map(float, place)), frame)
        turned = sf.Rotation.matrix(matrix.tolist())
        welded = sf.Inertia(parts["part"][0], tuple(map(float, center)), parts["part"][1], rotation=turned)
        bodies.append(sf.RigidBody(f"{body.name} part", weld, welded))
    return replace(stated, bodies=tuple(bodies))


def _permuted(stated: sf.System, rng: np.random.Generator) -> sf.System:
    return replace(stated, bodies=tuple(stated.bodies[i] for i in rng.permutation(len(stated.bodies))))


def _by_name(m: sf.Model, names: tuple[str, ...], kind: str) -> list[int]:
    own = list(getattr(m.names, kind))
    return [own.index(name) for name in names]


@pytest.mark.parametrize("change", [_turned, _halved, _permuted])
@pytest.mark.parametrize("case", sampled(CASES, SOME))
def test_equivalent_descriptions_give_the_same_dynamics(case: str, change: Callable[..., sf.System]) -> None:
    stated = system(case)
    anchors = {name for c in stated.constraints for name in _anchored(c)}
    anchors |= {name for c in stated.connections for name in (c.first[0], c.second[0])}
    if change is _turned and "world" in anchors or stated.virtual_power or stated.potentials:
        pytest.skip("it is tied to the world, or to an order")
    m, (q, v) = model(case), state(case)
    other = compiled(change(stated, np.random.default_rng(7)))
    to_q, to_v = _by_name(m, other.names.q, "q"), _by_name(m, other.names.v, "v")
    M, h = m.mass_matrix(q), m.bias(q, v)
    weight = float(np.abs(M).max() * max(1.0, np.abs(v).max()) ** 2)
    assert_same(other.mass_matrix(q[to_q]), M[np.ix_(to_v, to_v)])
    assert_same(other.bias(q[to_q], v[to_v]), h[to_v], weight)
    assert_same(other.kinetic_energy(q[to_q], v[to_v]), m.kinetic_energy(q, v))


def _anchored(constraint: object) -> list[str]:
    """Bodies that a constraint names."""
    anchors = (getattr(constraint, name, None) for name in ("first", "second", "body", "surface"))
    return [anchor if isinstance(anchor, str) else anchor[0] for anchor in anchors if anchor]


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


@pytest.mark.parametrize("seed", sampled(range(20), (0, 1, 2)))
@pytest.mark.parametrize(("length", "mass"), [(1e3, 1.0), (1e-3, 1e-6)])
def test_other_units_of_length_and_mass_scale_all_entries_alike(seed: int, length: float, mass: float) -> None:
    """Joints that turn: M and h in kg m^2 as in kg mm^2, or in mg mm^2."""
    stated = with_noise(random_tree(seed, n=4, kinds=("revolute", "ball", "universal", "continuous"), noisy=True), seed)

    def scaled(part: Any) -> Any:
        if isinstance(part, sf.Inertia):
            moments = tuple(mass * length**2 * x for x in part.moments)
            return replace(part, mass=mass * part.mass, center_of_mass=moved(part.center_of_mass), moments=moments)
        return replace(part, position=moved(part.position))

    def moved(vector: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(length * x for x in vector)

    bodies = [
        replace(
            body,
            joint=body.joint and scaled(body.joint),
            inertia=body.inertia and scaled(body.inertia),
            frames=tuple(map(scaled, body.frames)),
        )
        for body in stated.bodies
    ]
    m = compiled(stated)
    other = compiled(replace(stated, bodies=tuple(bodies), gravity=moved(stated.gravity)))
    q, v = m.random_state(np.random.default_rng(seed))
    unit = mass * length**2
    assert_same(other.mass_matrix(q) / unit, m.mass_matrix(q))
    assert_same(other.bias(q, v) / unit, m.bias(q, v))


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
