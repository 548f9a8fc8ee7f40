"""Many loops: sparse factors give the motions and multipliers of full matrices, at any scale, rank and posture."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models.closed.four_bars import n_four_bar, n_four_bar_absolute
from symofros.compiler import Compilation
from symofros.generator.codegen.solvers import sparse_systems

WINDOWS = 6


def rods(sizes: tuple[float, ...]) -> sf.System:
    """Side by side, four-bars with rods of these lengths [m] and of uniform density."""
    axis = (0, -1, 0)
    bodies: list[sf.RigidBody] = []
    loops = []
    for i, a in enumerate(sizes):
        rod = sf.Inertia(a**3, (a / 2, 0, 0), (0.0, a**5 / 12, a**5 / 12))
        end = (sf.Frame("end", (a, 0, 0)),)
        for k, position in enumerate((0.0, a)):
            pivot = sf.Joint(f"crank{i}{k}", "revolute", position=(position, 0, 0), axis=axis)
            bodies.append(sf.RigidBody(f"bar{i}{k}", pivot, rod, end))
        coupler = sf.Joint(f"coupler{i}", "revolute", f"bar{i}0", "end", axis=axis)
        bodies.append(sf.RigidBody(f"link{i}", coupler, rod, end))
        loops.append(sf.Closure(f"loop{i}", (f"bar{i}1", "end"), (f"link{i}", "end"), ("x", "z")))
    return sf.System("rods", tuple(bodies), constraints=tuple(loops))


def spatial(n: int) -> sf.System:
    """The row of four-bars, each loop closed in space: conditions that planar motion meets by itself."""
    planar = n_four_bar(n)
    loops = [sf.Closure(c.name, c.first, c.second, ("x", "y", "z"), ("x",)) for c in planar.constraints]
    return sf.System("spatial", planar.bodies, constraints=tuple(loops))


def doubled(n: int) -> sf.System:
    """The row of four-bars, the first loop closed twice."""
    planar = n_four_bar(n)
    first = planar.constraints[0]
    again = sf.Closure("again", first.first, first.second, ("x", "z"))
    return sf.System("doubled", planar.bodies, constraints=(*planar.constraints, again))


def rolling(n: int) -> sf.System:
    """The row of four-bars beside a rack that a crank drives by a condition on speeds."""
    planar = n_four_bar(n)
    rack = sf.RigidBody("rack", sf.Joint("y", "prismatic", axis=(0, 1, 0)), sf.Inertia(2.0))
    gear = sf.Nonholonomic("gear", {"dy": 1.0, "dcrank0": -0.3})
    return sf.System("rolling", (*planar.bodies, rack), constraints=(*planar.constraints, gear))


SYSTEMS = {
    "row": n_four_bar(WINDOWS),
    "absolute": n_four_bar_absolute(3),
    "spatial": spatial(WINDOWS),
    "doubled": doubled(WINDOWS),
    "rolling": rolling(WINDOWS),
    "unlike": rods((1e-3, 0.1, 1.0, 10.0, 1e3, 0.3)),
}


def closed(m: sf.Model, angle: float) -> np.ndarray:
    """The configuration in which all cranks stand at an angle [rad]."""
    if m.record.name.endswith("_absolute"):
        q = np.zeros(m.nq)
        for name, i in ((name, i) for i, name in enumerate(m.names.q)):
            body, _, coordinate = name.partition(".pose.")
            bar, k = body.startswith("bar"), int(body[3:] if body.startswith("bar") else body[4:])
            pose = {
                "x": k + 0.5 * np.cos(angle) if bar else k + np.cos(angle) + 0.5,
                "y": 0.5 * np.sin(angle) if bar else np.sin(angle),
            }
            q[i] = pose.get(coordinate, angle if bar else 0.0)
        return q
    signs = {"crank": angle, "coupl": -angle}
    return np.array([signs.get(name[:5], 0.0) for name in m.names.q])


@pytest.fixture(scope="module", params=SYSTEMS)
def pair(request: pytest.FixtureRequest) -> tuple[sf.Model, sf.Model]:
    """In C by sparse factors, and in NumPy by full matrices."""
    options = sf.Options(functions=("forward_dynamics", "project"))
    system = SYSTEMS[request.param]
    assert sparse_systems(Compilation(system, options).program)[0].keys() == {"forward_dynamics", "project"}
    return sf.compile(system, options), sf.compile(system, sf.Options(backend="interpreter"))


def assert_same_motion(pair: tuple[sf.Model, sf.Model], q: np.ndarray, v: np.ndarray, bound: float) -> None:
    sparse, full = pair
    a, lam, rank = sparse.constrained_dynamics(q, v, np.zeros(sparse.nu))
    expected_a, expected_lam, expected_rank = full.constrained_dynamics(q, v, np.zeros(full.nu))
    assert rank == expected_rank
    forces = full.constraint_jacobian(q).T
    np.testing.assert_allclose(a, expected_a, rtol=bound, atol=bound * np.abs(expected_a).max())
    # Each multiplier by its effect: those of small mechanisms are small.
    scale = np.abs(forces * expected_lam).max(axis=1)
    assert (np.abs(forces @ (lam - expected_lam)) <= bound * np.maximum(scale, 1e-300)).all()


@pytest.mark.parametrize("angle", [0.3, 1.0, 2.5])
def test_sparse_accelerations_and_multipliers_match_full_matrices(
    pair: tuple[sf.Model, sf.Model], angle: float, rng: np.random.Generator
) -> None:
    q = closed(pair[0], angle)
    assert_same_motion(pair, q, rng.normal(size=pair[0].nv), 1e-10)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4])
def test_rank_lost_along_the_ground_falls_back_to_full_matrices(pair: tuple[sf.Model, sf.Model], angle: float) -> None:
    """All bars in one line: there full matrices decide, and their answer is given."""
    sparse, full = pair
    q, v = closed(sparse, angle), np.zeros(sparse.nv)
    a, _, rank = sparse.constrained_dynamics(q, v, np.zeros(sparse.nu))
    expected, _, expected_rank = full.constrained_dynamics(q, v, np.zeros(full.nu))
    assert rank == expected_rank
    np.testing.assert_allclose(a, expected, rtol=1e-5, atol=1e-5 * np.abs(expected).max())


def test_sparse_and_dense_projections_agree_off_the_constraints(
    pair: tuple[sf.Model, sf.Model], rng: np.random.Generator
) -> None:
    sparse, full = pair
    q = closed(sparse, 1.0) + 1e-4 * rng.normal(size=sparse.nq)
    v = rng.normal(size=sparse.nv)
    ours, expected = sparse.project(q, v), full.project(q, v)
    assert ours[2] <= 1e-11 * max(1.0, np.abs(q).max())
    for one, other in zip(ours[:2], expected[:2], strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-8 * max(1.0, np.abs(other).max()))


def test_nan_states_give_nan_accelerations(pair: tuple[sf.Model, sf.Model]) -> None:
    sparse, _ = pair
    a, _, _ = sparse.constrained_dynamics(np.full(sparse.nq, np.nan), np.zeros(sparse.nv), np.zeros(sparse.nu))
    assert np.isnan(a).all()


def test_an_ill_conditioned_elimination_falls_back_to_full_matrices() -> None:
    """Eliminating the link leaves a millionth of the crank's inertia: M^-1 would lose digits."""
    row = n_four_bar(WINDOWS)
    heavy = sf.Inertia(1e6, (0.5, 0, 0), (0.0, 1e-3, 1e-3))
    bodies = [sf.RigidBody(b.name, b.joint, heavy if b.name == "link3" else b.inertia, b.frames) for b in row.bodies]
    system = sf.System("heavy", tuple(bodies), constraints=row.constraints)
    options = sf.Options(functions=("forward_dynamics",))
    pair = sf.compile(system, options), sf.compile(system, sf.Options(backend="interpreter"))
    assert_same_motion(pair, closed(pair[0], 1.0), np.ones(pair[0].nv), 1e-9)
