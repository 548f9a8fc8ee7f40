"""Contacts with bristles: they stick without creep, slip at Coulomb's limit, and never give energy (states.md, 5)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.dynamics.test_contacts import INTERPRETED, SURFACES, falling, touching, two_bodies

MU, S0, S1 = 0.6, 2e4, 8.0
K, DAMPING = 1e5, 400.0
BRISTLES = {"friction": MU, "bristle_stiffness": S0, "bristle_damping": S1, "dissipation": 0.4}


def bent(m: sf.Model, rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States with the bodies near each other; bristles are bent by 0.1 um to 10 mm."""
    q, v = (np.array(x) for x in zip(*(m.random_state(rng) for _ in range(count)), strict=True))
    q[:, :3] *= 0.5
    q[:, 7:10] *= 0.5
    return q, v, rng.normal(size=(count, m.nz)) * 10.0 ** rng.uniform(-7, -2, (count, 1))


@pytest.mark.parametrize("name", SURFACES)
def test_friction_stays_in_the_cone_and_never_gives_energy(name: str, rng: np.random.Generator) -> None:
    m = sf.compile(two_bodies(touching(name, **BRISTLES)), INTERPRETED)
    assert m.nz == 2 * (2 if name == "plane" else 3)
    q, v, z = bent(m, rng, 200)
    u = np.zeros(0)
    found = m.contact_forces(q, v, z=z)
    assert (found.gap < 0).any(axis=1).sum() > 20
    across = np.sqrt(np.maximum((found.force**2).sum(axis=2) - found.push**2, 0.0))
    # A root of rounding of the squares: beside 0.6 N.
    assert np.all(across <= MU * found.push * (1 + 1e-12) + 1e-9)
    assert across.max() > 1.0
    force, rates, step = m.generalized_force(q, v, u, z=z), m.state_rates(q, v, u, z=z), 1e-7

    def stored(h: float) -> np.ndarray:
        energy: np.ndarray = m.potential_energy(m.integrate(q, h * v), z=z + h * rates)
        return energy

    power = (force * v).sum(axis=1) + (stored(step) - stored(-step)) / (2 * step)  # d(T + V)/dt, (4).
    scale = np.abs(force * v).sum(axis=1) + np.abs(stored(0.0)) * S0 / S1
    assert np.all(power <= 1e-6 * scale)
    assert power.min() < -1.0


@pytest.mark.parametrize("name", ["plane", "sphere", "box"])
def test_linearisation_has_the_slopes_of_bristles(name: str, rng: np.random.Generator) -> None:
    m = sf.compile(two_bodies(touching(name, **BRISTLES)), INTERPRETED)
    q, v, z = (x[0] for x in bent(m, rng, 1))
    q[:3], q[7:10], z = 0.0, (0.1, -0.2, 0.3), 1e-4 * rng.normal(size=m.nz)
    u, n = np.zeros(0), m.nv
    A, _ = m.linearize(q, v, u, z=z)

    def rates(dq: np.ndarray, dv: np.ndarray, dz: np.ndarray) -> np.ndarray:
        at = (m.integrate(q, dq), v + dv, u)
        return np.concatenate([m.forward_dynamics(*at, z=z + dz), m.state_rates(*at, z=z + dz)])

    for k in range(2 * n + m.nz):
        d = np.zeros(2 * n + m.nz)
        d[k] = 1e-7 if k < 2 * n else 1e-10
        parts = (d[:n], d[n : 2 * n], d[2 * n :])
        slope = (rates(*parts) - rates(*(-x for x in parts))) / (2 * d[k])
        np.testing.assert_allclose(A[n:, k], slope, rtol=1e-4, atol=1e-5 * np.abs(slope).max() + 1e-4)


def incline(mu: float, alpha: float) -> sf.Model:
    """A point of 1 kg that moves along and across a plane, which falls towards x by alpha; "pull" pulls it along."""
    floor = sf.Contact("floor", ("ball", None), ("world", None), K, exponent=1.0, dissipation=20.0, friction=mu,
                       bristle_stiffness=K, bristle_damping=DAMPING)  # fmt: skip
    along, across = sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Joint("z", "prismatic", axis=(0, 0, 1))
    gravity = (9.81 * math.sin(alpha), 0.0, -9.81 * math.cos(alpha))
    system = falling(floor, along, across, gravity=gravity)
    pulled = sf.VirtualPower("pulling", {"dx": "pull"})
    return sf.compile(replace(system, inputs=(sf.Input("pull"),), virtual_power=(pulled,)))


def pressed(alpha: float) -> list[float]:
    """The configuration in which the floor carries the block."""
    return [0.0, -9.81 * math.cos(alpha) / K]


@pytest.mark.parametrize("share", [0.3, 0.97, 0.999])
def test_a_block_on_an_incline_sticks_without_creep(share: float) -> None:
    alpha = 0.4
    m = incline(math.tan(alpha) / share, alpha)
    run = sf.simulate(m, pressed(alpha), t_end=8.0, method="rk4", dt=5e-4, u=[0.0])
    late = run.q[run.t > 6.0, 0]  # By then it has settled: near the limit the spring leaves the damper little.
    assert np.ptp(late) == 0.0
    assert run.z[-1, 0] == pytest.approx(9.81 * math.sin(alpha) / K, rel=1e-9)


def test_a_block_slides_by_the_closed_form() -> None:
    alpha = 0.4
    mu = math.tan(alpha) * (1 - 1e-3)
    m = incline(mu, alpha)
    run = sf.simulate(m, pressed(alpha), t_end=4.0, method="dop853", rtol=1e-10, atol=1e-13, u=[0.0])
    a = 9.81 * (math.sin(alpha) - mu * math.cos(alpha))
    late = run.t > 3.0  # A rate of the settling of some 1/s is over.
    slope = np.polyfit(run.t[late], run.v[late, 0], 1)[0]
    assert slope == pytest.approx(a, abs=1e-9 * 9.81)


def test_a_load_that_swings_within_the_limit_leaves_no_displacement() -> None:
    m = incline(0.5, 0.0)
    run = sf.simulate(m, pressed(0.0), t_end=5.0, method="rk4", dt=5e-4, u={"pull": "2*sin(60*t)*exp(-t)"})
    assert np.abs(run.q[:, 0]).max() > 1.5e-5
    free = sf.simulate(m, run.q[-1], run.v[-1], t_end=1.0, method="rk4", dt=5e-4, u=[0.0], z0=run.z[-1])
    assert abs(free.q[-1, 0]) < 1e-12


def test_bristles_that_are_bent_beyond_the_limit_relax_with_their_time() -> None:
    """A push that fell leaves bristles bent: they relax by s0/s1, and pull by mu N at once, nothing out of contact."""
    m = incline(0.5, 0.0)
    q, v, limit = pressed(0.0), np.zeros(2), 0.5 * 9.81
    z = np.array([3.0, 4.0]) * 1e-4
    assert m.contact_forces(q, v, z=z).force[0] == pytest.approx([-0.6 * limit, -0.8 * limit, 9.81])
    assert m.state_rates(q, v, [0.0], z=z) == pytest.approx(-(K / DAMPING) * z * (1 - limit / (K * 5e-4)))
    q[1] = 0.1
    assert not m.contact_forces(q, v, z=z).force.any()
    assert m.state_rates(q, v + 1.0, [0.0], z=z) == pytest.approx(-(K / DAMPING) * z)


def test_bristles_bent_along_the_normal_exert_no_force_and_relax(rng: np.random.Generator) -> None:
    """The normal turns under bent bristles as a ball rolls on a curved surface."""
    m = sf.compile(two_bodies(replace(touching("sphere", **BRISTLES), points=((0.0, 0.0, 0.0),))), INTERPRETED)
    q, _, _ = (x[0] for x in bent(m, rng, 1))
    q[:3], q[7:10], v = 0.0, (0.1, -0.2, 0.3), np.zeros(m.nv)
    bare = m.contact_forces(q, v)
    assert bare.push[0] > 100.0
    _, R_WS = m.frame_pose("two.bent", q)
    z = 1e-4 * R_WS.T @ bare.force[0] / bare.push[0]
    np.testing.assert_allclose(m.contact_forces(q, v, z=z).force, bare.force, rtol=1e-12)
    np.testing.assert_allclose(m.state_rates(q, v, np.zeros(0), z=z), -(S0 / S1) * z, rtol=1e-9)


def test_a_ball_with_slip_rolls_by_the_momentum_about_its_contact() -> None:
    floor = sf.Contact("floor", ("ball", None), ("world", None), 1e6, radius=0.1, dissipation=20.0, friction=0.4,
                       bristle_stiffness=1e5, bristle_damping=100.0)  # fmt: skip
    planar = sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Joint("z", "prismatic", axis=(0, 0, 1))
    m = sf.compile(falling(floor, *planar, sf.Joint("spin", "revolute", axis=(0, 1, 0))))
    arm = 0.1 - (9.81 / 1e6) ** (2 / 3)
    run = sf.simulate(m, [0.0, arm, 0.0], [2.0, 0.0, -5.0], 1.0, method="rodas4", rtol=1e-9, atol=1e-12)
    # What bends the bristles is left out of the balance: 4 N over 1e5 N/m.
    assert run.v[-1, 0] == pytest.approx((2.0 * arm - 5.0 * 4e-3) / (arm + 4e-3 / arm), rel=2e-5)
    assert run.v[-1, 2] * arm == pytest.approx(run.v[-1, 0], rel=1e-6)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"bristle_stiffness": 1e4, "friction": 0.5}, "give both, or neither"),
        ({"bristle_damping": 10.0, "friction": 0.5}, "give both, or neither"),
        ({"bristle_stiffness": 1e4, "bristle_damping": 10.0}, "state friction above zero"),
        ({"bristle_stiffness": -1.0, "bristle_damping": 10.0, "friction": 0.5}, "give a stiffness above zero"),
        ({"bristle_stiffness": 1e4, "bristle_damping": 0.0, "friction": 0.5}, "relax by their damping"),
    ],
)
def test_bristles_that_cannot_be_are_refused(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(sf.DescriptionError, match=words):
        sf.compile(two_bodies(touching("plane", **changed)), INTERPRETED)


def test_files_keep_bristles(tmp_path: Any) -> None:
    system = two_bodies(touching("sphere", **BRISTLES))
    sf.save(system, tmp_path / "touch.yaml")
    again = sf.load(tmp_path / "touch.yaml")
    assert again.connections == system.connections
    assert sf.compile(again, INTERPRETED).names.z[:4] == (
        *("touch.0.bristle_x", "touch.0.bristle_y", "touch.0.bristle_z"),
        "touch.1.bristle_x",
    )
