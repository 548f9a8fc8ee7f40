"""Modes about rests of elastic trees, by functions that know no speeds, beside the derivatives in motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

STRIP: dict[str, Any] = {"rhoA": 2.0, "EI_z": 3e3, "EI_y": 5e3, "GJ": 2e3, "rhoJ": 0.04, "damping": 1e-3}
# Largest difference of frequencies, relative: the eigenvalues of the two matrices, which agree to rounding of M^-1.
ALIKE = 1e-9


def chain(links: int, functions: int, **changed: Any) -> sf.System:
    """Beams in series on hinges, which hang or stand out at an angle."""
    bodies = []
    for k in range(links):
        carrier = (f"b{k - 1}", "tip") if k else ("world", None)
        spring = (sf.Spring(800.0, 0.3), sf.Damper(5.0)) if changed.get("sprung") else ()
        joint = sf.Joint(f"q{k}", "revolute", *carrier, axis=(0, 1, 0), elements=spring)
        counts = {"bend_y": functions, "bend_z": functions, "twist": functions}
        bodies.append(sf.Beam(f"b{k}", joint, 1.0, retain="all", frames=[sf.Frame("tip")], **counts, **STRIP))
    return sf.System("chain", tuple(bodies))


DRIVEN = sf.System(
    "driven",
    (
        sf.RigidBody("hub", sf.Joint("turn", "revolute", axis=(0, 0, 1), prescribed=True), frames=[sf.Frame("rim")]),
        sf.Beam("blade", sf.Joint("flap", "revolute", "hub", "rim", axis=(0, 1, 0)), 1.0, bend_y=2, bend_z=1, **STRIP),
    ),
)


@pytest.mark.parametrize("name", ["slider_crank", "double_pendulum", "planar_robot", "driven"])
def test_forces_and_damping_at_rest_match_the_equations(name: str, rng: np.random.Generator) -> None:
    m = sf.compile(DRIVEN if name == "driven" else MODELS[name])
    (q, _), still = m.random_state(rng), np.zeros(m.nv)
    u, lam = rng.normal(size=m.nu), np.zeros(m.nc)  # Prescribed motions go on.
    h, Q = m.evaluate("rest_forces", q=q, u=u)
    _, expected_h, expected_Q = m.dynamics(q, still, u)
    scale = max(np.abs(expected_h).max(), np.abs(expected_Q).max())
    np.testing.assert_allclose((h, Q), (expected_h, expected_Q), atol=1e-13 * scale)
    _, by_v, _ = m.residual_derivatives(q, still, still, u, lam)
    (D,) = m.evaluate("rest_damping", q=q, u=u)
    np.testing.assert_allclose(D, by_v[: m.nv], atol=1e-13 * max(np.abs(by_v).max(), 1.0))


def test_modes_at_rest_match_derivatives_in_motion() -> None:
    m = sf.compile(chain(3, 1, sprung=True))
    q = sf.equilibrium(m, {"q0": 1.5}).q
    found = sf.modes(m, q)
    assert not _made(m, "forward_dynamics_derivatives") and _made(m, "rest_damping")
    expected = np.linalg.eigvals(sf.state_space(m, q).A)
    expected = expected[expected.imag >= 0.0]
    for s in found.eigenvalues:
        assert np.abs(expected - s).min() <= ALIKE * np.abs(s)
    assert len(found.eigenvalues) == len(expected)


def test_equilibrium_and_modes_generate_no_terms_of_speeds() -> None:
    m = sf.compile(chain(1, 3))
    sf.modes(m, sf.equilibrium(m, {"q0": 1.5}).q)
    for name in ("bias", "dynamics", "forward_dynamics_derivatives", "residual_derivatives"):
        assert not _made(m, name), name


def test_a_model_of_named_functions_keeps_to_them() -> None:
    named = ("dynamics", "rest_stiffness", "forward_dynamics_derivatives")
    m = sf.compile(chain(1, 3), sf.Options(functions=named))
    assert m.has("dynamics") and not m.has("rest_forces")
    every = sf.compile(chain(1, 3))
    q = sf.equilibrium(m, {"q0": 1.5}).q
    np.testing.assert_allclose(q, sf.equilibrium(every, {"q0": 1.5}).q, atol=1e-12)
    found, expected = sf.modes(m, q).frequencies, sf.modes(every, q).frequencies
    np.testing.assert_allclose(found, expected, rtol=ALIKE)


def _made(model: sf.Model, name: str) -> bool:
    return (name, "") in model._kernels
