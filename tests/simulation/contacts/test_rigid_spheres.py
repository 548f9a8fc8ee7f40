"""Rigid contacts of spheres with each other: closed forms, momentum, axes (docs/theory/constraints.md, 15)."""

from __future__ import annotations

import itertools
from functools import cache
from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import symofros as sf
from tests.simulation.rigid_scenes import FINE, GROUND, G, in_shell, sphere

RADIUS, CORE = 0.1, 0.5


@cache
def on_top(friction: float) -> sf.Model:
    """A ball on a sphere that is fixed."""
    contact = sf.Contact(
        "top",
        ("ball", None),
        GROUND,
        surface="sphere",
        radius=RADIUS,
        surface_radius=CORE,
        restitution=0.0,
        friction=friction,
    )
    return sf.compile(sf.System("on_top", [sphere("ball", 1.0, RADIUS)], connections=[contact]))


def beside_top(model: sf.Model, angle: float) -> Any:
    """The ball at an angle from the upright."""
    q = model.neutral()
    q[[0, 2]] = (CORE + RADIUS) * sin(angle), (CORE + RADIUS) * cos(angle)
    return q


@cache
def pair(friction: float, e: float) -> sf.Model:
    """Two free balls, of 1 kg and 0.1 m, and of 3 kg and 0.2 m."""
    bodies = [sphere("a", 1.0, 0.1), sphere("b", 3.0, 0.2)]
    sizes: dict[str, Any] = {"surface": "sphere", "radius": 0.1, "surface_radius": 0.2}
    contact = sf.Contact("pair", ("a", None), ("b", None), restitution=e, friction=friction, **sizes)
    return sf.compile(sf.System("pair", bodies, gravity=(0, 0, 0), connections=[contact]))


def momentum(model: sf.Model, q: Any, v: Any, mass: tuple[float, float], radius: tuple[float, float]) -> Any:
    """Linear and angular momentum, about the world's origin, of two homogeneous balls, and their kinetic energy."""
    found = np.zeros(7)
    for k, name in enumerate(("a", "b") if "a.px" in model.names.q else ("ball", "shell")):
        p, velocity = model.frame_pose(name, q)[0], model.frame_velocity(name, q, v)
        inertia = 0.4 * mass[k] * radius[k] ** 2
        found[:3] += mass[k] * velocity[:3]
        found[3:6] += mass[k] * np.cross(p, velocity[:3]) + inertia * velocity[3:]
        found[6] += 0.5 * mass[k] * velocity[:3] @ velocity[:3] + 0.5 * inertia * velocity[3:] @ velocity[3:]
    return found


def test_a_ball_slides_off_a_sphere() -> None:
    """Without friction it leaves where cos = 2/3 of that of the start."""
    model, angle = on_top(0.0), 0.3
    run = sf.simulate(model, beside_top(model, angle), t_end=0.6, **FINE)
    (leaves,) = run.events
    assert leaves.name == "top opens"
    assert leaves.q[2] / (CORE + RADIUS) == pytest.approx(2 / 3 * cos(angle), abs=1e-9)
    # From there on it falls freely.
    t = run.t[-1] - leaves.t
    assert run.q[-1, 2] == pytest.approx(leaves.q[2] + leaves.v[2] * t - G / 2 * t**2, abs=1e-9)


@pytest.mark.parametrize("friction", [0.5, 2.0, 1e4])
def test_a_ball_rolls_on_a_sphere_until_it_slips(friction: float) -> None:
    """N = m g (17 c - 10 c_0)/7 and F = 2/7 m g s: it slips at F = mu N, and leaves at 10/17 c_0 for large mu."""
    model, angle = on_top(friction), 0.3
    run = sf.simulate(model, beside_top(model, angle), t_end=0.65, **FINE)
    slips, leaves = run.events[0], run.events[-1]
    at = brentq(lambda x: 2 * sin(x) - friction * (17 * cos(x) - 10 * cos(angle)), angle, 1.2, xtol=1e-14)
    # By rounding one of mu = 1e4, which would slip for the last 4e-6 s alone, is held until it leaves.
    assert slips.name == "top slides" or (friction == 1e4 and slips.name == "top sticks")
    assert leaves.name == "top opens" and leaves.t > slips.t
    assert slips.q[2] / (CORE + RADIUS) == pytest.approx(cos(at), abs=1e-9)
    assert friction < 1e4 or leaves.q[2] / (CORE + RADIUS) == pytest.approx(10 / 17 * cos(angle), abs=1e-3)
    rolls = run.t < slips.t
    height = run.q[rolls, 2] / (CORE + RADIUS)
    assert np.linalg.norm(run.q[rolls, :3], axis=1) == pytest.approx(CORE + RADIUS, abs=1e-11)
    assert run.lam[rolls, 0] == pytest.approx(G / 7 * (17 * height - 10 * cos(angle)), abs=1e-8)
    # The force in world axes, from the multipliers along the axes of contact.
    force = run.contact_forces().force[:, 0]
    acceleration = np.array([model.frame_acceleration("ball", *x)[:3] for x in zip(run.q, run.v, run.a, strict=True)])
    np.testing.assert_allclose(force, acceleration + [0, 0, G], atol=1e-9)


@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
def test_two_balls_strike(e: float) -> None:
    """Without friction: what they exchange is along the line of centres, and the speed there comes back e times."""
    model = pair(0.0, e)
    q, v = model.neutral(), np.array([2.0, 0, 0, -3, 1, 5, 0, 0, 0, 1, 2, 3])
    q[7:10] = 0.5, 0.1, 0.05
    run = sf.simulate(model, q, v, t_end=0.3, **FINE)
    strike, d0 = run.events[0], q[7:10]
    t = brentq(lambda t: np.linalg.norm(d0 - [2 * t, 0, 0]) - 0.3, 0, 0.24, xtol=1e-15)
    n = ([2 * t, 0, 0] - d0) / 0.3
    impulse = (1 + e) * 0.75 * -2.0 * n[0]
    assert strike.t == pytest.approx(t, abs=1e-12) and strike.impulse[0] == pytest.approx(impulse, rel=1e-11)
    assert strike.energy_lost == pytest.approx((1 - e**2) * 0.5 * 0.75 * (2.0 * n[0]) ** 2, abs=1e-12)
    for name, share in (("a", 1.0), ("b", -1 / 3)):
        changes = np.subtract(*(model.frame_velocity(name, strike.q, x) for x in (strike.v_after, strike.v)))
        assert changes == pytest.approx([*(share * impulse * n), 0, 0, 0], abs=1e-11)


def test_balls_that_rub_keep_their_momentum() -> None:
    """Stronge's impact with friction gives each ball the opposite of the other's impulse, at one point of contact."""
    model = pair(0.3, 0.5)
    q, v = model.neutral(), np.array([2.0, 0, 0, -3, 1, 5, 0, 0, 0, 1, 2, 3])
    q[7:10] = 0.5, 0.1, -0.15
    run = sf.simulate(model, q, v, t_end=0.3, **FINE)
    before, after = (momentum(model, run.q[k], run.v[k], (1.0, 3.0), (0.1, 0.2)) for k in (0, -1))
    assert run.events[0].name == "pair strikes" and after[:6] == pytest.approx(before[:6], abs=1e-11)
    assert before[6] - after[6] == pytest.approx(run.events[0].energy_lost, rel=1e-10) and run.events[0].energy_lost > 0
    # Within the cone, against the slip: the impulse's part along the surface.
    normal, x, y = run.events[0].impulse
    assert 0 < sqrt(x * x + y * y) <= 0.3 * normal * (1 + 1e-12)


def test_where_centres_coincide() -> None:
    """Balls outside of each other penetrate there, in words; one in a hollow sphere moves freely until it strikes."""
    refused = sf.simulate(pair(0.0, 0.5), t_end=0.1)
    assert refused.outcome.kind == "input failed" and "penetrate" in str(refused.outcome)
    model = sf.compile(in_shell(0.3))
    run = sf.simulate(model, model.neutral(), {"ball.vz": -0.5}, t_end=0.9, **FINE)
    assert [one.t for one in run.events] == [pytest.approx(0.8, abs=1e-12)] and run.events[0].name == "wall strikes"
    assert run.v[-1, [2, 8]] == pytest.approx(-1 / 6, abs=1e-12)  # Plastic: they go on together.


@pytest.mark.parametrize("friction", [0.1, 20.0])
def test_the_axes_of_contact_have_no_part_in_the_motion(friction: float) -> None:
    """A ball goes round in a free shell, past either pole of the surface's frame: as in any other frame."""
    v = np.array([0.0, 1.2, 0.4, 3.0, -1.0, 2.0, 0.0, 0.1, 0.0, 0.4, -0.3, 0.2])
    ends, events = [], set()
    # Of the second frame the z axis is where the ball begins, of whose normal it is the opposite.
    for axis, angle in (((1, 0, 0), 0.0), ((0, 1, 0), pi / 2), ((1, 2, 3), 2.5)):
        model = sf.compile(in_shell(friction, axis, angle))
        q = model.neutral()
        q[0] = 0.4
        run = sf.simulate(model, q, v, t_end=3.0, **FINE)
        assert run.outcome.ok, run.outcome
        kept = np.array([momentum(model, run.q[k], run.v[k], (1.0, 2.0), (0.1, 0.5)) for k in (0, len(run) // 2, -1)])
        np.testing.assert_allclose(kept[1:, :6], kept[:1, :6].repeat(2, axis=0), atol=1e-9)
        assert abs(model.contact_forces(run.q, run.v).gap).max() < 1e-10
        sticks = run.t >= next(one.t for one in run.events if one.name == "wall sticks")
        assert np.ptp(run.kinetic_energy[sticks]) < 1e-9
        events.add(len(run.events))
        ends.append(np.concatenate([run.q[-1], run.v[-1]]))
    np.testing.assert_allclose(ends[1:], [ends[0]] * 2, atol=1e-8)
    assert len(events) > 1  # Poles are taken anew where frames need it.


def row_of_balls(e: float | None) -> sf.Model:
    """Five balls of 1 kg that touch in a row, as rigid contacts or, with None, by conditions that strike at once."""
    bodies, names = [], [f"x{k}" for k in range(5)]
    for k, name in enumerate(names):
        slide = sf.Joint(name, "prismatic", axis=(1, 0, 0), position=(0.2 * k, 0, 0))
        bodies.append(sf.RigidBody(f"b{k}", slide, sf.Inertia(1.0)))
    given: dict[str, Any] = {"gravity": (0, 0, 0)}
    if e is None:
        couplings = [sf.Coupling(f"c{k}", f"{b} - {a}") for k, (a, b) in enumerate(itertools.pairwise(names))]
        given |= {"constraints": couplings, "switches": [sf.Switch(one.name, "hit") for one in couplings]}
        given["parameters"] = [sf.Parameter("hit", 0.0)]
    else:
        sizes: dict[str, Any] = {"surface": "sphere", "radius": 0.1, "surface_radius": 0.1}
        pairs = [((f"b{k}", None), (f"b{k + 1}", None)) for k in range(4)]
        given["connections"] = [sf.Contact(f"c{k}", *pair, restitution=e, **sizes) for k, pair in enumerate(pairs)]
    return sf.compile(sf.System("cradle", bodies, **given))


def test_newtons_cradle_strikes_in_sequence_or_at_once() -> None:
    """By a sequence of pairs as many balls leave as come, with their speed; Newton's law at once has another answer."""
    in_pairs = row_of_balls(1.0)
    for coming in (1, 2, 3):  # That several touch while they move is no reason for events.
        q, v = np.where(np.arange(5) < coming, -0.05, 0.0), np.where(np.arange(5) < coming, 1.0, 0.0)
        run = sf.simulate(in_pairs, q, v, t_end=0.1, **FINE)
        assert run.outcome.ok and len(run.events) <= coming and run.events[-1].t == pytest.approx(0.05, abs=1e-12)
        assert run.v[-1] == pytest.approx(v[::-1], abs=1e-14)
        assert run.events[-1].energy_lost == pytest.approx(0.0, abs=1e-14)
    # With losses the first blow has ((1 + e)/2)^4 for the last one, and those behind it meet again.
    e, start = 0.9, [-0.05, 0, 0, 0, 0]
    run = sf.simulate(row_of_balls(e), start, [1.0, 0, 0, 0, 0], t_end=0.1, **FINE)
    assert run.v[-1].sum() == pytest.approx(1.0, abs=1e-14) and (np.diff(run.v[-1]) > -1e-12).all()
    assert run.v[-1, -1] >= ((1 + e) / 2) ** 4 - 1e-14
    # At once: v+ = (1 + e) v_p - e v-, of which v_p is one fifth.
    hit = sf.Event("x1 - x0", "falling", action={"hit": 1.0}, restitution=1.0)
    run = sf.simulate(row_of_balls(None), start, [1.0, 0, 0, 0, 0], t_end=0.1, events={"hit": hit}, **FINE)
    assert run.v[-1] == pytest.approx([-0.6, 0.4, 0.4, 0.4, 0.4], abs=1e-14)


CRANK, ROD, CLEARANCE = 0.1, 0.3, 1e-3


def slider_crank(e: float, friction: float) -> sf.Model:
    """A crank, a rod and a slider, whose pin at the end of the rod has a clearance of 1 mm; without weight."""
    crank = sf.Inertia(0.3, (CRANK / 2, 0, 0), (1e-5, 0.3 * CRANK**2 / 12, 0.3 * CRANK**2 / 12))
    rod = sf.Inertia(0.2, (ROD / 2, 0, 0), (1e-5, 0.2 * ROD**2 / 12, 0.2 * ROD**2 / 12))
    turning: dict[str, Any] = {"axis": (0, 0, 1)}
    bodies = (
        sf.RigidBody("crank", sf.Joint("crank", "revolute", **turning), crank),
        sf.RigidBody("rod", sf.Joint("rod", "revolute", "crank", position=(CRANK, 0, 0), **turning), rod),
        sf.RigidBody("slider", sf.Joint("slide", "prismatic", axis=(1, 0, 0)), sf.Inertia(0.14)),
    )
    sizes: dict[str, Any] = {"radius": 0.01, "surface_radius": 0.01 + CLEARANCE, "points": [(ROD, 0, 0)]}
    laws: dict[str, Any] = {"restitution": e, "friction": friction}
    pin = sf.Contact("pin", ("rod", None), ("slider", None), surface="sphere", inside=True, **sizes, **laws)
    return sf.compile(sf.System("slider_crank", bodies, gravity=(0, 0, 0), connections=(pin,)))


def flights(e: float, state: Any, n: int) -> Any:
    """Instants and states behind the first n strikes of its pin, without friction, by angles in the plane alone."""
    m = 0.2
    ends, t = [], 0.0

    def parts(s: Any) -> tuple[Any, Any, Any]:
        a, b = s[0], s[1]
        coupling = m * CRANK * ROD / 2
        M = np.diag([0.1 * CRANK**2 + m * CRANK**2, m * ROD**2 / 3, 0.14])
        M[0, 1] = M[1, 0] = coupling * cos(a - b)
        h = coupling * sin(a - b) * np.array([s[4] ** 2, -(s[3] ** 2), 0.0])
        d = np.array([CRANK * cos(a) + ROD * cos(b) - s[2], CRANK * sin(a) + ROD * sin(b)])
        return M, h, d

    def gap(_: float, s: Any) -> Any:
        return CLEARANCE - np.linalg.norm(parts(s)[2])

    gap.terminal, gap.direction = True, -1  # type: ignore[attr-defined]
    for _ in range(n):
        rates = lambda _, s: [*s[3:], *np.linalg.solve(parts(s)[0], -parts(s)[1])]  # noqa: E731
        flight = solve_ivp(rates, (t, t + 0.1), state, "DOP853", events=gap, rtol=1e-13, atol=1e-15, max_step=1e-4)
        t, state = flight.t_events[0][0], flight.y_events[0][0]
        M, _, d = parts(state)
        J = (
            d
            / np.linalg.norm(d)
            @ [
                [-CRANK * sin(state[0]), -ROD * sin(state[1]), -1.0],
                [CRANK * cos(state[0]), ROD * cos(state[1]), 0.0],
            ]
        )
        across = np.linalg.solve(M, J)
        state = np.concatenate([state[:3], state[3:] - (1 + e) * (J @ state[3:]) / (J @ across) * across])
        ends.append([t, *state])
    return np.array(ends)


def test_a_slider_crank_whose_pin_has_a_clearance() -> None:
    """Strike after strike as of an integration of angles in the plane; with friction the same by coarser steps."""
    start, v = [0.4, -0.4 - 0.13, CRANK * cos(0.4) + ROD * cos(0.13)], [50.0, -65.0, 0.0]
    known = flights(0.8, np.array([0.4, -0.13, start[2], 50.0, -15.0, 0.0]), 12)
    model = slider_crank(0.8, 0.0)
    run = sf.simulate(model, start, v, t_end=known[-1, 0] + 1e-6, **FINE)
    strikes = [one for one in run.events if one.name == "pin strikes"]
    assert [one.t for one in strikes] == pytest.approx(known[:, 0], abs=1e-11)
    angles = np.array([[1, 0, 0], [1, 1, 0], [0, 0, 1]])  # Of the bodies, by those of the joints.
    after = np.array([one.v_after for one in strikes]) @ angles.T
    np.testing.assert_allclose(after, known[:, 4:], atol=1e-7)
    lost = sum(one.energy_lost for one in strikes)
    assert run.kinetic_energy[0] - run.kinetic_energy[-1] == pytest.approx(lost, rel=1e-8)
    assert all(one.energy_lost > 0 for one in strikes)
    rubs, states = slider_crank(0.5, 0.1), []
    for rtol in (1e-8, 1e-11):
        run = sf.simulate(rubs, start, v, t_end=0.02, method="dopri5", rtol=rtol, atol=rtol / 100)
        states.append(run.q[-1])
        assert {one.name for one in run.events} >= {"pin strikes", "pin opens"} or len(run.events) > 5
        assert all(one.energy_lost > -1e-12 for one in run.events) and run.kinetic_energy[-1] < run.kinetic_energy[0]
    assert states[0] == pytest.approx(states[1], abs=1e-6)


@cache
def rolling_balls() -> sf.Model:
    """Two balls of 1 kg on the ground, in a plane: one may roll into the other."""
    bodies, contacts = list[sf.RigidBody](), list[sf.Contact]()
    for name in "ab":
        x = sf.RigidBody(f"x{name}", sf.Joint(f"x{name}", "prismatic", axis=(1, 0, 0)))
        z = sf.RigidBody(f"z{name}", sf.Joint(f"z{name}", "prismatic", axis=(0, 0, 1), parent=x.name))
        turning = sf.Joint(f"angle{name}", "revolute", axis=(0, 1, 0), parent=z.name)
        bodies += [x, z, sf.RigidBody(name, turning, sf.Inertia(1.0, moments=(4e-3,) * 3))]
        contacts.append(sf.Contact(f"floor_{name}", (name, None), GROUND, restitution=0.0, friction=0.5, radius=0.1))
    sizes: dict[str, Any] = {"surface": "sphere", "radius": 0.1, "surface_radius": 0.1}
    contacts.append(sf.Contact("pair", ("b", None), ("a", None), restitution=0.0, friction=0.5, **sizes))
    return sf.compile(sf.System("rolling", tuple(bodies), connections=tuple(contacts)))


@pytest.mark.parametrize(("steps", "most"), [({"method": "dopri5"}, 2000), ({"method": "rk4", "dt": 1e-3}, 60_000)])
def test_balls_that_roll_behind_each_other_are_idle(steps: dict[str, Any], most: int) -> None:
    """The one lifts the other by friction, lets it go, again and again; then both roll at one speed, by no force."""
    run = sf.simulate(rolling_balls(), [0, 0.1, 0, 0.5, 0.1, 0], [1, 0, 10, 0, 0, 0], 1.0, **steps)
    assert run.outcome.ok and all("persists" in note for note in run.outcome.notes), run.outcome
    assert run.statistics.evaluations < most and 8 <= len(run.events) <= 10
    # The one that lifts comes back within 1e-6 of the time so far, 0.35 s, which leaves it 9.81 m/s^2 times that.
    assert run.v[-1] == pytest.approx([0.2967645, 0.0, 2.967645, 0.2967645, 0.0, 2.967645], abs=1e-6)
    assert run.q[-1, [1, 4]] == pytest.approx(0.1, abs=1e-9) and run.q[-1, 3] - run.q[-1, 0] == pytest.approx(0.2)
