"""What the truncated models drop: terms of second order, or of first, in elastic coordinates and speeds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.cases import BODY, CASES, SECTION, L

FUNCTIONS = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "potential_energy")
# Elastic state against that of a random state of size one; differences between halvings give the slope.
SCALES = 2.0 ** -np.arange(8, 11)
# Terms of two degrees may cancel in one state's energy, not in several's.
STATES = 8
FULL = [
    "hub about another axis",
    "free base",
    "free base, rotary inertia",
    "two in series",
    "clamped in series",
    "body on the tip",
    "body on the tip, rotary inertia",
    "body hinged to the tip",
    "tapered",
    "driven base",
    "clamped to the world",
]


@cache
def model(name: str, retain: str) -> sf.Model:
    return sf.compile(CASES[name].retaining(retain), sf.Options(FUNCTIONS, backend="interpreter"))


def elastic(m: sf.Model) -> np.ndarray:
    """Which coordinates are of beams."""
    return np.array(["[" in name for name in m.names.q])


def slopes(name: str, retain: str, rng: np.random.Generator) -> dict[str, float]:
    """How fast each term's difference from the full model falls with the elastic state: the smallest exponent."""
    full, cut = model(name, "all"), model(name, retain)
    driven = np.concatenate([np.array(x) for x in CASES[name].driven])
    u = driven if len(driven) else None
    q, v, a = rng.standard_normal((3, STATES, full.nv))
    scale = np.where(elastic(full), SCALES[:, None, None], 1.0)
    found: dict[str, list[np.ndarray]] = {}
    for m in (full, cut):
        M = m.mass_matrix(scale * q, u=u)
        h = m.bias(scale * q, scale * v, u=u)
        Q = m.generalized_force(scale * q, scale * v, u)
        T, V = m.kinetic_energy(scale * q, scale * v, u=u), m.potential_energy(scale * q, u=u)
        for term, value in (("M", M), ("M a + h", np.einsum("snij,nj->sni", M, a) + h), ("Q", Q), ("T", T), ("V", V)):
            found.setdefault(term, []).append(value)
    result = {}
    for term, (one, other) in found.items():
        difference = np.linalg.norm((one - other).reshape(len(SCALES), -1), axis=1)
        size = np.linalg.norm(one.reshape(len(SCALES), -1), axis=1)
        assert np.all(difference > 1e-12 * size), f"{term}: nothing to measure"
        result[term] = float(np.diff(np.log(difference)).max() / np.log(0.5))
    return result


@pytest.mark.parametrize("name", FULL)
def test_first_order_drops_only_second_order(name: str, rng: np.random.Generator) -> None:
    for term, slope in slopes(name, "first_order", rng).items():
        # An energy whose gradient is right to first order is right to second.
        assert slope >= (2.9 if term == "V" else 1.9), (term, slope)


@pytest.mark.parametrize("name", FULL)
def test_zeroth_order_drops_first_order_inertia(name: str, rng: np.random.Generator) -> None:
    found = slopes(name, "zeroth_order", rng)
    del found["T"]  # It is that of M, and one number: its terms of first and second degree may cancel.
    for term, slope in found.items():
        assert slope >= (1.9 if term == "V" else 0.9), (term, slope)
    # It does drop it: were the terms of first order there, it would cost what first order costs.
    assert found["M a + h"] < 1.5


AXES = {"across": (0, 0, 1), "along": (1, 0, 0)}


def linearised(retain: str, axis: str, rate: float, loaded: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, D, K of small vibrations on a hub that turns at a given rate: differences of h - Q, a polynomial in both."""
    joint = sf.Joint("hub", "revolute", position=(0.2, 0, 0), axis=AXES[axis], prescribed=True)
    section = SECTION | {"damping": 0.0}
    bodies: list[sf.Beam | sf.RigidBody] = [
        sf.Beam("b", joint, L, bend_y=2, bend_z=2, twist=1, family="legendre", retain=retain, **section)  # type: ignore[arg-type]
    ]
    if loaded:
        bodies.append(sf.RigidBody("load", sf.Joint("weld", "fixed", "b", "tip"), BODY))
    m = sf.compile(sf.System("s", bodies, gravity=(0, 0, 0)), sf.Options(FUNCTIONS, backend="interpreter"))
    u, still, step = np.array([0.3, rate, 0.0]), np.zeros(m.nv), 1e-4

    def force(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return m.bias(q, v, u=u) - m.generalized_force(q, v, u)

    steps = step * np.eye(m.nv)
    K = (force(steps, still) - force(-steps, still)).T / (2 * step)
    D = (force(still, steps) - force(still, -steps)).T / (2 * step)
    return m.mass_matrix(still, u=u), D, K


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("axis", AXES)
def test_spin_stiffens_nothing_at_zeroth_order(axis: str, loaded: bool) -> None:
    """M and K are those of the beam at rest: stable at any rate, right at low ones.

    What a body on the tip adds is gyroscopic: its Coriolis forces do no work and destabilise nothing.
    """
    M0, D0, K0 = linearised("zeroth_order", axis, 0.0, loaded)
    M, D, K = linearised("zeroth_order", axis, 5.0, loaded)
    rounding = 1e-9 * np.abs(K0).max()
    np.testing.assert_allclose(M, M0, rtol=1e-13)
    np.testing.assert_allclose(K, K0, atol=rounding)
    np.testing.assert_allclose(D0, 0.0, atol=rounding)
    np.testing.assert_allclose(D, -D.T if loaded else 0.0, atol=rounding)
    kept, _, stiffened = linearised("first_order", axis, 5.0, loaded)
    np.testing.assert_allclose(kept, M0, rtol=1e-12)
    assert np.abs(stiffened - K0).max() > 0.01 * np.abs(K0).max()


@pytest.mark.parametrize("loaded", [False, True])
def test_zeroth_order_keeps_coriolis_forces_of_tip_bodies(loaded: bool) -> None:
    """2 w x (r_T + s x c) of a mass at c from the tip, by hand; of the beam itself nothing."""
    m, rate, c = 0.7, 3.0, np.array([0.1, 0.3])
    stem = sf.Beam(
        "b", sf.Joint("h", "revolute"), L, rhoA=2.0, EI_z=3.0, bend_y=1, family="polynomial", retain="zeroth_order"
    )
    load = sf.RigidBody("m", sf.Joint("w", "fixed", "b", "tip"), sf.Inertia(m, (*c, 0), (0.05, 0.05, 0.05)))
    bodies = [stem, load] if loaded else [stem]
    model = sf.compile(sf.System("s", bodies, gravity=(0, 0, 0)), sf.Options(("bias",), backend="interpreter"))
    h = {sign: model.bias([0.0, 0.0], [rate, sign]) for sign in (1.0, -1.0)}
    slope = 2.0 / L  # Of (x/L)^2 at the tip, per unit of its displacement.
    velocity = np.array([-slope * c[1], 1.0 + slope * c[0]])
    coriolis = 2.0 * rate * np.array([-velocity[1], velocity[0]])
    x, y = c + [L, 0.0]
    expected = m * np.array([x * coriolis[1] - y * coriolis[0], velocity @ coriolis])
    np.testing.assert_allclose((h[1.0] - h[-1.0]) / 2.0, expected if loaded else 0.0, atol=1e-13)


def test_energies_of_beams_that_do_not_move_each_other_add_up() -> None:
    """In the order of the bodies: of one, of the other, and of both."""
    beams = [
        sf.Beam(
            name,
            sf.Joint(f"hinge_{name}", "revolute", axis=(0, 0, 1)),
            L,
            **SECTION | {"EI_z": stiffness, "rhoI_z": 0.0},
            bend_y=1,
        )
        for name, stiffness in (("soft", 2.0), ("stiff", 7.0))
    ]
    q, v = [0.3, 0.02, -0.4, 0.05], [0.1, 0.2, -0.3, 0.4]
    chosen = sf.Options(("kinetic_energy", "potential_energy"), backend="interpreter")
    both, *single = (sf.compile(sf.System("s", part), chosen) for part in (beams, beams[:1], beams[1:]))
    halves = [(m, q[2 * i : 2 * i + 2], v[2 * i : 2 * i + 2]) for i, m in enumerate(single)]
    stored = sum(float(m.potential_energy(x)) for m, x, _ in halves)
    assert float(both.potential_energy(q)) == pytest.approx(stored, rel=1e-13)
    assert float(both.kinetic_energy(q, v)) == pytest.approx(sum(float(m.kinetic_energy(x, y)) for m, x, y in halves))
