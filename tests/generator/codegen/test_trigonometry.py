"""Blocks of sines and cosines: the same bits as the interpreter's, by vectors and by loops, whatever their width."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf

EXACT = ("-O2", "-ffp-contract=off")


def model(angles: int, flags: tuple[str, ...], **options: str) -> sf.Model:
    """Forces that are sines and cosines of inputs, some of sums, some nested."""
    bodies = []
    for i in range(angles):
        formula = f"sin(u{i}) + 2*cos(u{i}) + cos(u{i} + u0) + sin(3*cos(u{i}))"
        joint = sf.Joint(f"x{i}", "prismatic", effort=(formula,))
        bodies.append(sf.RigidBody(f"b{i}", joint, sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))))
    stated = sf.System("angles", bodies, inputs=[sf.Input(f"u{i}") for i in range(angles)])
    return sf.compile(stated, sf.Options(functions=("generalized_force",), flags=flags or None, **options))  # type: ignore[arg-type]


def angles(n: int) -> np.ndarray:
    rng = np.random.default_rng(n)
    u = rng.uniform(-1.0, 1.0, (300, n)) * 10.0 ** rng.integers(-8, 5, (300, n))
    u[::7] *= 1e9  # Far, some of them.
    u[3, 0], u[4, -1], u[5, 0] = np.inf, np.nan, -0.0
    return u


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8, 9, 20])
@pytest.mark.parametrize("plain", [False, True])
def test_compiled_sines_equal_interpreter_bits(n: int, plain: bool) -> None:
    u, still = angles(n), np.zeros(n)
    compiled = model(n, (*EXACT, "-D__STRICT_ANSI__") if plain else EXACT)  # As -std=c99 defines it: no vectors.
    twin = model(n, (), backend="interpreter")
    expected = twin.generalized_force(still, still, u)
    assert np.array_equal(compiled.generalized_force(still, still, u), expected, equal_nan=True)


def test_fast_math_falls_back_to_the_c_library() -> None:
    """It may reorder the sums on which the polynomials rest."""
    u, still = angles(5)[10:], np.zeros(5)
    u = u[np.abs(u).max(axis=1) < 1e4]
    fast = model(5, ("-O2", "-ffast-math")).generalized_force(still, still, u)
    np.testing.assert_allclose(fast, model(5, EXACT).generalized_force(still, still, u), rtol=0, atol=1e-11)
    # And it leaves the numbers of the rest of the process alone.
    assert np.float64(1e-310) * np.float64(0.5) > 0.0
