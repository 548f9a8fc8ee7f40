"""Modes about rests of elastic trees, by functions that know no speeds, beside the derivatives in motion."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.simulation.analysis.rest_linearisation import MANY
from tests.models import interpreted

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


def test_modes_at_rest_say_that_stiffness_changes_in_time() -> None:
    """Masses in a row on springs whose rate swings, at speeds few and many; one of named functions keeps to them."""
    named = ("rest_forces", "rest_stiffness", "rest_damping", "mass_matrix")
    for count, functions in ((3, None), (MANY + 1, named)):
        bodies = []
        for i in range(count):
            joint = sf.Joint(f"x{i}", "prismatic", f"b{i - 1}" if i else "world", effort=(f"-(3 + sin(t))*x{i} + t",))
            bodies.append(sf.RigidBody(f"b{i}", joint, sf.Inertia(1.0)))
        row = sf.System("row", bodies, gravity=(0, 0, 0))
        model = sf.compile(row, sf.Options(functions, backend="interpreter"))
        (note,) = sf.modes(model, model.neutral()).notes
        assert note.startswith("the linearised equations change along this motion")


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


@pytest.mark.parametrize("driven", ["held", "prescribed"])
def test_a_bead_on_a_turning_hoop_leaves_the_bottom_beyond_the_critical_speed(driven: str) -> None:
    """At sqrt(Omega^2 - g/R) where the hoop is driven, whoever states so; it stays at cos theta = g/(R Omega^2)."""
    prescribed, speed = driven == "prescribed", 6.0
    hoop = sf.RigidBody("hoop", sf.Joint("h", "revolute", prescribed=prescribed), sf.Inertia(1.0, moments=(0.1,) * 3))
    joint = sf.Joint("theta", "revolute", "hoop", axis=(0, 1, 0))
    made = interpreted(sf.System("bead", (hoop, sf.RigidBody("bead", joint, sf.Inertia(0.2, (0, 0, -0.5))))))
    how = {"u": [0.0, speed, 0.0]} if prescribed else {"v": {"h": speed}, "held": ["h"]}
    (note,) = sf.equilibrium(made, **how).notes
    found = re.match(r"this motion is unstable: moved by a little, 'theta' leaves it at ([\d.]+) 1/s; guess", note)
    assert found, note
    assert float(found[1]) == pytest.approx(np.sqrt(speed**2 - 9.81 / 0.5), rel=5e-3)
    stays = sf.equilibrium(made, {"theta": 1.0}, **how)
    assert np.cos(stays.q[-1]) == pytest.approx(9.81 / (0.5 * speed**2), rel=1e-9)
    assert not stays.notes


def test_a_shaft_beyond_its_critical_speed_stays_by_forces_of_speeds() -> None:
    """Laval's rotor in axes that turn with it: K - m Omega^2 < 0, and Coriolis forces hold it."""
    springs = [sf.Spring(100.0)]
    bodies = (
        sf.RigidBody("shaft", sf.Joint("s", "revolute", prescribed=True)),
        sf.RigidBody("x", sf.Joint("x", "prismatic", "shaft", axis=(1, 0, 0), elements=springs), sf.Inertia(1e-6)),
        sf.RigidBody("disc", sf.Joint("y", "prismatic", "x", axis=(0, 1, 0), elements=springs), sf.Inertia(1.0)),
    )
    rotor = interpreted(sf.System("rotor", bodies))
    assert not sf.equilibrium(rotor, u=[0.0, 15.0, 0.0]).notes
