"""Quaternions near unit length are taken at it by every function that takes a state; others are refused."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.runtime.calls import extension
from symofros.runtime.manifold import UNIT_TOLERANCE, are_unit, at_unit_length
from tests.interop.turning import SYSTEMS, turns

Array = np.ndarray
# Lengths of rotations: off by rounding, by digits that were not written, and by the most that is allowed.
ROTATIONS = (1.0, 1.0 + 1e-15, 1.0 + 1e-12, 1.0 - 1e-9, 1.0 + 1e-6, 1.0 - 0.99 * UNIT_TOLERANCE)
OTHERS = (1.1, 0.9, 1.0 + 1.01 * UNIT_TOLERANCE, 0.0, 1e-200, 1e200)
# Of results, relative to their largest entry; rounding of a length within that of 16 units is left as it is.
CLOSE = 2e-14


def carried() -> sf.System:
    """A hinge on a body whose rotation is an input."""
    wrist = sf.RigidBody("c", sf.Joint("w", "ball", prescribed=True), sf.Inertia(1.0, (0.1, 0, 0), (0.2, 0.3, 0.4)))
    hinge = sf.Joint("j", "revolute", "c", position=(0.1, 0.2, 0.3), axis=(0, 1, 0))
    return sf.System("carried", [wrist, sf.RigidBody("b", hinge, sf.Inertia(1.0, (0.5, 0, 0), (0.2, 0.3, 0.4)))])


@cache
def model(name: str, backend: Any) -> sf.Model:
    """A free joint with a hinge, a ball behind a hinge, or a ball whose rotation is prescribed."""
    return sf.compile(carried() if name == "carried" else SYSTEMS[name](), sf.Options(backend=backend))


@pytest.fixture(params=["hopper", "swing"])
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(params=["extension", "c", "interpreter"])
def m(request: pytest.FixtureRequest, name: str, monkeypatch: pytest.MonkeyPatch) -> sf.Model:
    """Calls and looks at batches by the extension, and by NumPy of compiled and of interpreted functions."""
    made = extension.load() if request.param == "extension" else None
    if request.param == "extension" and made is None:
        pytest.skip("needs the headers of Python")
    monkeypatch.setattr("symofros.runtime.calls.plain.call_type", lambda _: made)
    monkeypatch.setattr("symofros.runtime.manifold.available_type", lambda: made)
    return model(name, "interpreter" if request.param == "interpreter" else "c").with_parameters()


def with_length(m: sf.Model, q: Array, length: float) -> Array:
    """The same rotations, by quaternions of another length."""
    scaled = q.copy()
    for turn in turns(m):
        scaled[..., turn] *= length
    return scaled


Entry = Callable[[sf.Model, Array, Array], Any]
ENTRIES: dict[str, Entry] = {
    "mass_matrix": lambda m, q, v: m.mass_matrix(q),
    "bias": lambda m, q, v: m.bias(q, v),
    "dynamics": lambda m, q, v: m.dynamics(q, v, np.ones(m.nu)),
    "forward_dynamics": lambda m, q, v: m.forward_dynamics(q, v, np.ones(m.nu)),
    "inverse_dynamics": lambda m, q, v: m.inverse_dynamics(q, v, v),
    "energies": lambda m, q, v: (m.kinetic_energy(q, v), m.potential_energy(q)),
    "frame_pose": lambda m, q, v: m.frame_pose("toe", q),
    "frame_jacobian": lambda m, q, v: m.frame_jacobian("toe", q),
    "center_of_mass": lambda m, q, v: m.center_of_mass(q),
    "regressor": lambda m, q, v: m.regressor(q, v, v),
    "linearize": lambda m, q, v: m.linearize(q, v, np.ones(m.nu)),
    "evaluate": lambda m, q, v: m.evaluate("dynamics", q=q, v=v),
    "vjp": lambda m, q, v: list(m.vjp("inverse_dynamics", q=q, v=v, a=v, tau_bar=v).values()),
    "of parameters": lambda m, q, v: m.bias(q, v, par=m.parameter_values),
    "by name": lambda m, q, v: m.bias(dict(zip(m.names.q, np.moveaxis(q, -1, 0), strict=True)), v),
    "as lists": lambda m, q, v: m.bias(q.tolist(), v.tolist()),
    "not contiguous": lambda m, q, v: m.bias(np.stack([q, q], -1)[..., 0], v),
    "integrate": lambda m, q, v: m.integrate(q, v),
    "difference": lambda m, q, v: (m.difference(q, m.neutral()), m.difference(m.neutral(), q)),
}
BATCHES: dict[str, Callable[[Array], Array]] = {
    "one state": lambda q: q[0],
    "a batch": lambda q: q,
    "by columns": np.asfortranarray,
    "in two dimensions": lambda q: q.reshape(2, -1, q.shape[-1]),
    "by columns in two dimensions": lambda q: np.asfortranarray(q.reshape(2, -1, q.shape[-1])),
}


def states(m: sf.Model, n: int = 6) -> tuple[Array, Array]:
    rng = np.random.default_rng(5)
    q, v = (np.array(x) for x in zip(*(m.random_state(rng) for _ in range(n)), strict=True))
    return q, v


def flat(results: Any) -> Array:
    parts = results if isinstance(results, tuple | list) else [results]
    return np.concatenate([np.ravel(np.asarray(part)) for part in parts])


@pytest.mark.parametrize("entry", ENTRIES)
def test_functions_depend_on_the_direction_of_quaternions_only(m: sf.Model, entry: str) -> None:
    call = ENTRIES[entry]
    for shaped in BATCHES.values():
        q, v = (shaped(x) for x in states(m))
        expected = flat(call(m, q, v))
        for length in ROTATIONS:
            given = with_length(m, q, length)
            before = given.copy()
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                found = flat(call(m, given, v))
            assert np.abs(found - expected).max() <= CLOSE * np.abs(expected).max(), length
            assert np.array_equal(given, before)
        for length in OTHERS:
            with pytest.raises(sf.ShapeError, match="holds a quaternion that is no rotation"):
                call(m, with_length(m, q, length), v)


def test_the_error_names_the_quaternion_and_the_remedy(m: sf.Model) -> None:
    q, v = states(m)
    off = with_length(m, q, 1.1)
    q[3] = off[3]
    with pytest.raises(sf.ShapeError) as error:
        m.bias(q, v)
    names = ", ".join(m.names.q[turns(m)[0]])
    assert f"length 1.1 of {names} in row 3" in str(error.value)
    assert "of unit length, to 0.001" in str(error.value) and "model.normalized(q)" in str(error.value)
    assert np.abs(m.normalized(q) - states(m)[0]).max() < 1e-15
    with pytest.raises(sf.ShapeError, match="length 0 of(.|\n)*not turned has"):
        m.bias(np.zeros(m.nq), v[0])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_non_finite_state_affects_no_other_state(m: sf.Model, value: float) -> None:
    q, v = states(m)
    given = with_length(m, q, 1.0 + 1e-6)
    clean = m.bias(given, v)
    given[2, turns(m)[0].start] = value
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = m.bias(given, v)
        one = m.bias(given[2], v[2])
    others = np.arange(len(q)) != 2
    assert np.array_equal(found[others], clean[others])
    assert np.isnan(found[2]).any() and np.array_equal(found[2], one, equal_nan=True)


@pytest.mark.parametrize("n", [2, 512, 1025])
@pytest.mark.parametrize("place", [0, -1])
def test_one_invalid_quaternion_among_many_is_found(m: sf.Model, n: int, place: int) -> None:
    firsts, q = m.record.quaternions["q"], np.tile(states(m, 1)[0], (n, 1))
    for layout in (np.ascontiguousarray, np.asfortranarray, lambda x: np.repeat(x, 2, axis=0)[::2]):
        assert are_unit(layout(q), firsts)
        off = q.copy()
        off[place, firsts[-1] + 3] += 1e-9
        assert not are_unit(layout(off), firsts)
        mended = at_unit_length(m.record, "q", layout(off))
        assert are_unit(mended, firsts)
        others = np.arange(n) != place % n
        assert np.array_equal(mended[others], q[others])


def test_numbers_of_single_precision_are_rotations(m: sf.Model) -> None:
    q, v = states(m)
    single = m.with_precision("single")
    expected = m.bias(q, v)
    for given in (q.astype(np.float32), with_length(m, q, 1.0 + 1e-4).astype(np.float32)):
        assert np.abs(single.bias(given, v) - expected).max() < 1e-5 * np.abs(expected).max()
        # In doubles the rotation that was rounded is off by that rounding, its length no longer.
        assert np.abs(m.bias(given, v) - expected).max() < 1e-6 * np.abs(expected).max()
    with pytest.raises(sf.ShapeError, match="no rotation"):
        single.bias(with_length(m, q, 1.1), v)


def test_derivatives_by_quaternion_components_are_tangential(m: sf.Model) -> None:
    """So that quotients of differences by coordinates are tangential, as in frameworks: nothing depends on lengths."""
    q, v = states(m, 1)
    turn, h = turns(m)[0], 1e-5
    by_length = (m.bias(with_length(m, q, 1 + h), v) - m.bias(with_length(m, q, 1 - h), v)) / (2 * h)
    assert np.abs(by_length).max() < 1e-8 * np.abs(m.bias(q, v)).max()
    across = np.zeros_like(q)
    across[0, turn] = np.array([0.3, -0.2, 0.5, 0.1])
    slope = (m.bias(q + h * across, v) - m.bias(q - h * across, v)) / (2 * h)
    along = across.copy()
    along[0, turn] -= (across[0, turn] @ q[0, turn]) * q[0, turn]
    expected = (m.bias(m.normalized(q + h * along), v) - m.bias(m.normalized(q - h * along), v)) / (2 * h)
    assert np.abs(slope - expected).max() < 1e-7 * np.abs(expected).max()


@pytest.mark.parametrize("backend", ["c", "interpreter"])
def test_prescribed_rotations_are_checked_by_calls_and_batches(backend: str) -> None:
    m = model("carried", backend)
    rng = np.random.default_rng(2)
    u = rng.normal(size=(5, m.nu))
    (first,) = m.record.quaternion_inputs
    turn = slice(first, first + 4)
    u[:, turn] /= np.linalg.norm(u[:, turn], axis=1, keepdims=True)
    q, v = rng.normal(size=(2, 5, 1))
    for rows in (slice(None), 0):
        expected = m.forward_dynamics(q[rows], v[rows], u[rows])
        for length in (*ROTATIONS, *OTHERS):
            given = u.copy()
            given[:, turn] *= length
            if length in ROTATIONS:
                found = m.forward_dynamics(q[rows], v[rows], given[rows])
                assert np.abs(found - expected).max() <= CLOSE * np.abs(expected).max()
            else:
                with pytest.raises(sf.ShapeError, match="u holds a quaternion that is no rotation"):
                    m.forward_dynamics(q[rows], v[rows], given[rows])
