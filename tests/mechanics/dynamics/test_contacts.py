"""Compliant contact: distances, forces as slopes of energies, momentum, dissipation, and motions that are known."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.contacts import MEASURES
from validation.procedures.equations.contacts import SURFACES

INTERPRETED = sf.Options(backend="interpreter")
LOSSY = {"dissipation": 0.4, "friction": 0.6, "minimum_velocity": 0.05}
SOLID = sf.Inertia(2.0, (0.1, -0.05, 0.02), (0.3, 0.4, 0.35, 0.01, -0.02, 0.03))


def touching(name: str, **changed: Any) -> sf.Contact:
    stated = {"surface": name, "radius": 0.1, "points": [(0.2, 0.1, -0.1), (-0.1, 0.0, 0.15)]} | SURFACES[name]
    stated |= {"stiffness": 1e4} | changed
    return sf.Contact(**{"name": "touch", "first": ("one", "skew"), "second": ("two", "bent")} | stated)


def two_bodies(*contacts: sf.Contact) -> sf.System:
    """Two free bodies, with frames that are neither at their origins nor along their axes."""
    frames = {
        "one": sf.Frame("skew", (0.05, 0.1, 0.0), sf.Rotation.rpy(0.3, -0.2, 0.4)),
        "two": sf.Frame("bent", (0, 0.1, 0), sf.Rotation.rpy(0.1, 1, 0)),
    }
    bodies = [sf.RigidBody(k, sf.Joint(f"j{k}", "free"), SOLID, [frame]) for k, frame in frames.items()]
    return sf.System("two_bodies", bodies, gravity=(0.0, 0.0, 0.0), connections=contacts)


@pytest.mark.parametrize("name", SURFACES)
def test_derivatives_exist_everywhere_and_are_slopes(name: str, rng: np.random.Generator) -> None:
    contact = touching(name, first=("one", None), second=("world", None), points=[(0.2, 0.1, -0.1)], **LOSSY)
    body = sf.RigidBody("one", sf.Joint("j", "free"), SOLID)
    m = sf.compile(sf.System("s", [body], connections=[contact]), INTERPRETED)
    assert np.isfinite(m.forward_dynamics_derivatives([-0.2, -0.1, 0.1, 0, 0, 0, 1], np.zeros(6), [])[0]).all()
    for _ in range(8):
        q, v = m.random_state(rng)
        q[:3] *= 0.8
        by_q, by_v, _ = m.forward_dynamics_derivatives(q, v, [])
        h, scale = 1e-6, max(np.abs(by_q).max(), 1.0)
        for i, unit in enumerate(np.eye(6)):
            along = [m.forward_dynamics(m.integrate(q, sign * h * unit), v, []) for sign in (1.0, -1.0)]
            np.testing.assert_allclose(by_q[:, i], (along[0] - along[1]) / (2.0 * h), atol=1e-4 * scale)
            along = [m.forward_dynamics(q, v + sign * h * unit, []) for sign in (1.0, -1.0)]
            np.testing.assert_allclose(by_v[:, i], (along[0] - along[1]) / (2.0 * h), atol=1e-4 * scale)


def falling(contact: sf.Contact, *joints: sf.Joint, **options: Any) -> sf.System:
    """A chain of massless carriages that ends with a body "ball"."""
    bodies, parent = [], "world"
    for k, joint in enumerate(joints):
        last = k == len(joints) - 1
        inertia = sf.Inertia(1.0, (0, 0, 0), (4e-3,) * 3) if last else None
        name = "ball" if last else f"carriage{k}"
        bodies.append(sf.RigidBody(name, replace(joint, parent=parent), inertia))
        parent = name
    return sf.System("falling", bodies, connections=[contact], **options)


@pytest.mark.parametrize(("exponent", "speed"), list(itertools.product([1.0, 1.5, 2.0], [0.5, 3.0])))
def test_a_ball_rebounds_by_the_closed_form(exponent: float, speed: float) -> None:
    """(64), whatever stiffness and exponent are."""
    c = 0.3
    contact = sf.Contact("hit", ("ball", None), ("world", None), 1e5, radius=0.1, dissipation=c, exponent=exponent)
    m = sf.compile(falling(contact, sf.Joint("z", "prismatic", axis=(0, 0, 1)), gravity=(0, 0, 0)))
    run = sf.simulate(m, [0.15], [-speed], 0.2 / speed + 0.05, method="dop853", rtol=1e-10, atol=1e-12)
    assert run.q[-1, 0] > 0.1 and not run.outcome.notes, run.outcome

    def left(v: float) -> float:
        return v / c - math.log1p(c * v) / c**2

    assert left(-run.v[-1, 0]) == pytest.approx(left(speed), rel=1e-6)


def test_a_ball_with_slip_rolls_at_five_sevenths() -> None:
    """Momentum about the point of contact is kept: to rounding, with the radius less the penetration as its arm."""
    contact = sf.Contact(
        "floor", ("ball", None), ("world", None), 1e6, radius=0.1, friction=0.4, dissipation=0.5, minimum_velocity=1e-4
    )
    planar = sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Joint("z", "prismatic", axis=(0, 0, 1))
    m = sf.compile(falling(contact, *planar, sf.Joint("spin", "revolute", axis=(0, 1, 0))))
    arm = 0.1 - (9.81 / 1e6) ** (2 / 3)
    run = sf.simulate(m, [0.0, arm, 0.0], [2.0, 0.0, -5.0], 1.0, method="dop853", rtol=1e-8, atol=1e-10)
    assert run.v[-1, 0] == pytest.approx((2.0 * arm - 5.0 * 4e-3) / (arm + 4e-3 / arm), rel=2e-5)
    assert run.v[-1, 0] == pytest.approx(5 / 7 * 2.0 + 2 / 7 * 0.1 * -5.0, rel=5e-3)
    assert run.v[-1, 2] * arm == pytest.approx(run.v[-1, 0], rel=1e-4)
    push = m.contact_forces(run.q, run.v).push[:, 0]
    np.testing.assert_allclose(push, 9.81, rtol=1e-3)


def test_a_block_slides_down_an_incline_and_creeps_where_it_should_stick() -> None:
    """Four corners on a plane that is inclined by 0.4 rad."""
    alpha, mu = 0.4, 0.3
    corners = [(x, y, -0.05) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    found = []
    for friction in (mu, 0.6):
        contact = sf.Contact(
            "floor", ("block", None), ("world", None), 1e6, points=corners, friction=friction, dissipation=1.0
        )
        block = sf.RigidBody("block", sf.Joint("j", "free"), sf.Inertia(1.0, (0, 0, 0), (4e-3, 4e-3, 6e-3)))
        g = (9.81 * math.sin(alpha), 0.0, -9.81 * math.cos(alpha))
        m = sf.compile(sf.System("block", [block], gravity=g, connections=[contact]))
        rest = m.neutral()
        rest[2] = 0.05 - (9.81 * math.cos(alpha) / 4 / 1e6) ** (2 / 3)
        run = sf.simulate(m, rest, t_end=0.5, method="rodas4")
        found.append(run)
    slid, held = found
    a = 9.81 * (math.sin(alpha) - mu * math.cos(alpha))
    assert (slid.v[-1, 0] - slid.v[len(slid.t) // 2, 0]) / (slid.t[-1] - slid.t[len(slid.t) // 2]) == pytest.approx(
        a, rel=1e-3
    )
    assert 0.0 < held.v[-1, 0] < 2e-3


def test_a_cantilever_rests_with_its_tip_on_a_floor() -> None:
    """The floor's push is the shear force at the tip, and with it the deflection is that of a propped beam."""
    load, length, EI = 30.0, 1.0, 200.0
    floor = sf.Contact("floor", ("boom", "tip"), ("world", "floor"), 1e7, exponent=1.0)
    boom = sf.Beam(
        "boom",
        sf.Joint("root", "fixed"),
        length,
        rhoA=load / 9.81,
        EI_z=EI,
        EI_y=EI,
        GJ=EI,
        rhoJ=0.1,
        bend_y=0,
        bend_z=3,
    )
    ground = sf.RigidBody("ground", sf.Joint("still", "fixed"), frames=[sf.Frame("floor")])
    stated = sf.System("propped", [boom, ground], connections=[replace(floor, second=("ground", "floor"))])
    m = sf.compile(stated, INTERPRETED)
    found = sf.equilibrium(m)
    (push,) = m.contact_forces(found.q, np.zeros(m.nv)).push
    assert push == pytest.approx(3 / 8 * load * length, rel=2e-3)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"stiffness": 0.0}, "stiffness 0"),
        ({"radius": -0.1}, "radius -0.1"),
        ({"friction": -0.2}, "friction -0.2"),
        ({"dissipation": -1.0}, "dissipation -1"),
        ({"minimum_velocity": 0.0}, "minimum_velocity 0"),
        ({"exponent": 1.2}, "exponent"),
        ({"points": []}, "points"),
        ({"surface": "cone"}, "surface"),
        ({"surface": "sphere"}, "surface_radius"),
        ({"surface": "box", "size": (1, 0, 1)}, "size 0"),
        ({"surface_radius": 1.0}, "a plane has no measures"),
        ({"inside": True}, "inside a plane"),
        ({"surface": "sphere", "surface_radius": 0.1, "inside": True, "radius": 0.1}, "room around the ball"),
        ({"second": ("one", "skew")}, "on body 'one'"),
        ({"second": ("three", None)}, "no body 'three'"),
    ],
)
def test_contacts_that_cannot_be_are_refused(changed: dict[str, Any], words: str) -> None:
    stated = {"name": "touch", "first": ("one", "skew"), "second": ("two", "bent"), "stiffness": 1e4} | changed
    with pytest.raises(sf.SymofrosError, match="contact 'touch'") as raised:
        sf.compile(two_bodies(sf.Contact(**stated)), INTERPRETED)
    assert words in str(raised.value)


@pytest.mark.parametrize("name", SURFACES)
def test_files_keep_contacts(name: str, tmp_path: Any) -> None:
    """Also formulas of parameters, which are judged at their values."""
    contact = touching(name, stiffness="k", friction=0.5)
    stated = replace(two_bodies(contact), parameters=[sf.Parameter("k", 1e4)])
    sf.save(stated, tmp_path / "two.yaml")
    again = sf.load(tmp_path / "two.yaml")
    assert again.contacts == stated.contacts and again == stated
    assert set(MEASURES) == {"plane", "sphere", "cylinder", "capsule", "box"}
    m = sf.compile(again, INTERPRETED)
    with pytest.raises(sf.SymofrosError, match="contact 'touch': stiffness -1"):
        m.contact_forces(m.neutral(), np.zeros(m.nv), par=[-1.0])


@pytest.mark.parametrize(("stiffness", "deep"), [(1e5, False), (50.0, True)])
def test_runs_in_which_a_ball_sinks_to_its_centre_say_so(stiffness: float, deep: bool) -> None:
    contact = sf.Contact("floor", ("ball", None), ("world", None), stiffness, radius=0.05, dissipation=2.0)
    m = sf.compile(falling(contact, sf.Joint("z", "prismatic", axis=(0, 0, 1))))
    for run in (
        sf.simulate(m, [0.2], t_end=1.0, method="dopri5"),
        sf.simulate_batch(m, [[0.2]], t_end=1.0, method="dopri5", output=0.01)[0],
    ):
        assert (
            any("contact 'floor' is" in note and "times its radius deep" in note for note in run.outcome.notes) == deep
        )


@pytest.mark.parametrize(("stiffness", "dt"), [(1e6, 1e-2), (1e8, 1e-2), (1e8, 1e-3), (1e4, 5e-3), (1e8, 1e-4)])
def test_fixed_steps_that_do_not_follow_an_impact_say_so(stiffness: float, dt: float) -> None:
    """No mode of the flight between impacts shows them: short runs with contacts are held against half the step."""
    contact = sf.Contact("floor", ("ball", None), ("world", None), stiffness, radius=0.1)
    m = sf.compile(falling(contact, sf.Joint("z", "prismatic", axis=(0, 0, 1))))
    options: dict[str, Any] = {"t_end": 1.0, "method": "rk4", "dt": dt}
    for run in (sf.simulate(m, [1.0], **options), sf.simulate_batch(m, [[1.0]], output=0.1, **options)[0]):
        energy = m.kinetic_energy(run.q, run.v) + m.potential_energy(run.q)
        assert bool(run.outcome.notes) == bool(np.ptp(energy) > 0.05 * energy[0]), run.outcome


@pytest.mark.parametrize("method", ["dopri5", "rodas4", "dop853"])
def test_a_thin_wall_that_a_step_of_a_long_flight_passes_is_noted(method: str) -> None:
    wall = sf.Contact("wall", ("ball", None), ("world", None), 1e9, "box", size=(0.02, 1.0, 1.0))
    m = sf.compile(falling(wall, sf.Joint("x", "prismatic", axis=(1, 0, 0)), gravity=(0.0, 0.0, 0.0)))
    run = sf.simulate(m, [-10.0], [3.0], t_end=6.0, method=method)
    assert run.q[-1, 0] < 0.0 or any("passes over what acts within it" in note for note in run.outcome.notes)


def test_derivatives_in_single_precision_are_numbers_in_and_out_of_contact() -> None:
    contact = sf.Contact("c", ("one", None), ("world", None), 1e4, radius=0.1, friction=0.5, dissipation=0.3)
    body = sf.RigidBody("one", sf.Joint("z", "prismatic", axis=(0, 0, 1)), SOLID)
    m = sf.compile(sf.System("s", [body], connections=[contact]))
    q, v = np.array([[0.3], [0.1], [0.05]]), np.array([[0.0], [-0.5], [0.5]])
    by_q, by_v, _ = m.with_precision("single").forward_dynamics_derivatives(
        q.astype(np.float32), v.astype(np.float32), []
    )
    expected = m.forward_dynamics_derivatives(q, v, [])
    np.testing.assert_allclose(by_q, expected[0], rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(by_v, expected[1], rtol=1e-4, atol=1e-3)
