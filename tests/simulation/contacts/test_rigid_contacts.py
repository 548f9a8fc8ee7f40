"""Rigid contacts with friction: closed forms, laws of impact, modes (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from math import cos, sin, sqrt, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import bounds
from tests.simulation.rigid_scenes import FINE, GROUND, G, ball, ball_system, box, guided, point, rested, rod


@pytest.mark.parametrize("share", [1 + 1e-3, 1 - 1e-3])
def test_a_mass_on_an_incline_stays_or_slides_as_coulomb_says(share: float) -> None:
    """No creep in 5000 steps; above its level the acceleration of the closed form to 1e-12 g.

    Not by a bit, or, where a compiler fuses products and sums, by less than 1e-20 m.
    """
    angle = 0.4
    model = point(tan(angle) * share, (G * sin(angle), 0, -G * cos(angle)))
    run = sf.simulate(model, t_end=0.5, dt=1e-4, method="rk4")
    assert run.outcome.ok and not run.events
    expected = G * (sin(angle) - tan(angle) * share * cos(angle)) if share < 1 else 0.0
    if share > 1:
        assert np.abs(run.q).max() < 1e-20 and np.abs(run.v).max() < 1e-19
    assert abs(run.v[-1, 0] / 0.5 - expected) < 1e-12 * G and np.abs(run.v[:, 1:]).max() < 1e-19
    # Force along x: what holds it, or the share that friction has of the weight.
    assert run.lam[-1, 1] == pytest.approx(-2.0 * G * sin(angle) * min(1.0, share), rel=1e-12)


@pytest.mark.parametrize("steps", [FINE, {"method": "rk4", "dt": 1e-2}])
def test_a_mass_slides_to_its_stop_and_back(steps: dict[str, Any]) -> None:
    """Pushed up an incline that does not hold it: instant and place of the turn, exact by fixed steps, too."""
    angle, mu = 0.4, 0.2
    model = point(mu, (G * sin(angle), 0, -G * cos(angle)))
    run = sf.simulate(model, v0=[-1.0, 0, 0], t_end=1.0, **steps)
    up, down = G * (sin(angle) + mu * cos(angle)), G * (sin(angle) - mu * cos(angle))
    (turn,) = run.events
    assert turn.name == "foot turns" and turn.t == pytest.approx(1 / up, abs=1e-12)
    assert run.q[-1, 0] == pytest.approx(-0.5 / up + 0.5 * down * (1 - 1 / up) ** 2, abs=1e-11)


def test_a_mass_slides_along_a_curve() -> None:
    """At the angle of friction the speed and its part down the slope add up to what they were: |v| + v_x stays."""
    angle = 0.3
    model = point(tan(angle), (G * sin(angle), 0, -G * cos(angle)))
    run = sf.simulate(model, v0=[0, 2.0, 0], t_end=1.5, output=np.linspace(0, 1.5, 200), **FINE)
    speed = np.hypot(run.v[:, 0], run.v[:, 1])
    # d|v|/dt = g sin(a) (v_x/|v| - 1) and dv_x/dt = g sin(a) (1 - v_x/|v|).
    assert speed + run.v[:, 0] == pytest.approx(2.0, abs=1e-8) and run.v[-1, 0] > 0.9


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_a_bouncing_ball_comes_to_rest(method: str) -> None:
    """By the closed form to 1e-12 until the strikes accumulate, which is noted; then at rest."""
    model, e, h = ball(), 0.5, 0.2
    q = rested(model, 0.1 + h)
    run = sf.simulate(model, q, t_end=2.0, method=method, dt=1e-2, **bounds(method, 1e-10, 1e-13))
    strikes = np.array([found.t for found in run.events])
    first, n = sqrt(2 * h / G), np.arange(len(strikes))
    known = first * (1 + 2 * e * (1 - e**n) / (1 - e))
    assert len(strikes) > 15 and strikes[:15] == pytest.approx(known[:15], abs=1e-12)
    assert strikes == pytest.approx(known, abs=1e-10)  # A speed of 1e-6 m/s: 1e-17 m, the rounding of 0.1, is 1e-11 s.
    assert [found.name for found in run.events[:2]] == ["floor strikes"] * 2 and run.events[-1].name == "floor sticks"
    assert run.events[0].energy_lost == pytest.approx((1 - e**2) * 0.4 * G * h, rel=1e-12)
    assert run.events[0].impulse[0] == pytest.approx((1 + e) * 0.4 * sqrt(2 * G * h), rel=1e-12)
    assert run.outcome.notes == (f"event 'floor': the contact persists from t = {strikes[-1]:.12g} s on",)
    assert run.q[-1, 2] == pytest.approx(0.1, abs=1e-15) and np.abs(run.v[-1]).max() < 1e-12
    assert run.lam[-1, 0] == pytest.approx(0.4 * G, rel=1e-12)


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
def test_no_step_over_the_end_of_a_slip_is_rejected(method: Any) -> None:
    """It is as smooth beyond rest as before (41b)."""
    run = sf.simulate(point(0.5), None, [3.0, 1.2, 0.0], 1.0, method=method)
    (sticks,) = run.events
    assert sticks.t == pytest.approx(np.hypot(3.0, 1.2) / (0.5 * G), abs=1e-12)
    assert run.statistics.rejected == 0


def test_a_ball_with_backspin_slides_until_it_rolls() -> None:
    """Friction mu m g acts until v = R w: at (v0 - R w0) 2/(7 mu g), with (5 v0 + 2 R w0)/7."""
    v0, spin, mu, r = 2.0, -30.0, 0.5, 0.1
    run = sf.simulate(ball(), rested(ball(), r), {"free.vx": v0, "free.wy": spin}, t_end=1.5, **FINE)
    (rolls,) = run.events
    assert rolls.name == "floor sticks" and rolls.t == pytest.approx(2 * (v0 - r * spin) / (7 * mu * G), abs=1e-12)
    assert run.v[-1, 4] * r == pytest.approx((5 * v0 + 2 * r * spin) / 7, rel=1e-10)
    before = run.t < rolls.t
    assert run.lam[before, 1] == pytest.approx(-mu * 0.4 * G, rel=1e-11)
    # Contact forces follow the modes of the run, on both sides of the event: mu m g against the slip, then the weight.
    force, slides = run.contact_forces().force[:, 0] / (0.4 * G), np.arange(len(run)) <= before.sum()
    np.testing.assert_allclose(force, np.outer(slides, [-mu, 0.0, 0.0]) + [0.0, 0.0, 1.0], atol=1e-10)


@pytest.mark.parametrize(("vx", "spin"), [(0.5, 0.0), (4.0, 0.0), (1.0, -25.0)])
def test_a_ball_strikes_at_an_angle(vx: float, spin: float) -> None:
    """Friction takes mu (1 + e) v_n, or what makes a ball roll; the normal velocity comes back e times."""
    model, h, e, mu, r = ball(0.7, 0.3), 0.3, 0.7, 0.3, 0.1
    run = sf.simulate(model, rested(model, r + h), {"free.vx": vx, "free.wy": spin}, t_end=0.3, **FINE)
    strike, vn = run.events[0], sqrt(2 * G * h)
    slip = vx - spin * r
    taken = min(mu * (1 + e) * vn, 2 / 7 * slip)
    turned = sf.simulate(model, rested(model, r + h), {"free.vx": vx, "free.wy": spin}, t_end=strike.t, **FINE)
    velocity = model.frame_velocity("ball", turned.q[-1], strike.v_after)
    assert velocity[0] == pytest.approx(vx - taken, rel=1e-9, abs=1e-10) and velocity[2] == pytest.approx(
        e * vn, rel=1e-11
    )
    assert velocity[4] * r == pytest.approx(spin * r + 2.5 * taken, rel=1e-9, abs=1e-10)


def impact(W: Any, u: Any, mu: float, e: float, n: int) -> Any:
    """Stronge's impact in steps of the normal impulse, by its definition alone."""
    u, dp = np.array(u, dtype=float), -u[1] / W[1, 1] / n
    work, target = 0.0, np.inf
    P = np.zeros(2)
    while work < target:
        stick = -W[0, 1] / W[0, 0]
        if abs(u[0]) > 2 * abs(W[0, 1]) * dp + 2 * mu * W[0, 0] * dp:
            h = -mu * np.sign(u[0])
        else:
            h = stick if abs(stick) <= mu else -mu * np.sign(W[0, 1])
        step = np.array([h, 1.0]) * dp
        if u[1] < 0 <= (u + W @ step)[1]:
            target, work = e**2 * -work, 0.0
        u, work, P = u + W @ step, work + (u[1] + 0.5 * (W @ step)[1]) * dp, P + step
    return P


@pytest.mark.parametrize("seed", range(6))
def test_a_rod_strikes_by_stronges_coefficient(seed: int) -> None:
    """Impulses against a fine sum by the definition; the energy falls, and friction stays within its cone."""
    rng = np.random.default_rng(seed)
    mu, e, angle = rng.uniform(0.1, 0.6), rng.uniform(0.2, 0.9), rng.uniform(-1.2, 1.2)
    model = rod(round(mu, 2), round(e, 2))
    v = np.array([rng.uniform(-3, 3), 0.0, rng.uniform(-2, 2)])
    v[1] = -1.0 - abs(v[2])
    q = np.array([0.0, cos(angle), angle])
    run = sf.simulate(model, q, v, t_end=1e-6, **FINE)
    strike = run.events[0]
    J = np.array([[1, 0, -cos(angle)], [0, 1, sin(angle)]])
    Minv = np.diag([1.0, 1.0, 3.0])
    P = impact(J @ Minv @ J.T, J @ strike.v, round(mu, 2), round(e, 2), 100_000)
    assert Minv @ J.T @ P == pytest.approx(strike.v_after - strike.v, abs=3e-4)
    assert strike.energy_lost >= 0.0
    assert abs(strike.impulse[1]) <= round(mu, 2) * strike.impulse[0] * (1 + 1e-9)
    assert strike.impulse[[1, 0]] == pytest.approx(P, abs=3e-4)


def test_painleves_paradox_of_a_rod_is_noted() -> None:
    """Below mu = 4/3 each slide has one motion; above, where the rod leans against its slide, none or several."""
    for angle in (0.3, 0.5, 0.7):
        q = [0.0, cos(angle), angle]
        coupling = 1 + 3 * sin(angle) ** 2 - 3 * 1.6 * sin(angle) * cos(angle)
        for friction, v in ((1.2, -2.0), (1.2, 2.0), (1.6, 2.0), (1.6, -2.0)):
            run = sf.simulate(rod(friction), q, [v, 0, 0], t_end=0.02, **FINE)
            paradox = friction > 4 / 3 and v < 0 and coupling < 0
            assert run.outcome.ok != paradox, (angle, friction, v)
            if paradox:
                assert "Painleve" in run.outcome.reason and run.outcome.t == 0.0


def test_two_possible_motions_of_painleves_rod_are_noted() -> None:
    """Where it turns so fast that its tip leaves by itself, and friction could press it down."""
    angle, slip = 0.5, -2.0
    w = sqrt(1.5 * G / cos(angle))
    for friction, paradox in ((1.2, False), (1.8, True)):
        run = sf.simulate(
            rod(friction), [0, cos(angle), angle], [slip + w * cos(angle), -w * sin(angle), w], t_end=0.01, **FINE
        )
        assert run.outcome.ok != paradox and ("several motions" in run.outcome.reason) == paradox


@pytest.mark.parametrize("name", ["rod", "box"])
def test_multipliers_are_the_forces_of_the_motion(name: str) -> None:
    """M a + h = Q + G^T f with normal forces and friction: of a rod, and of a box that turns."""
    model, start = (rod(0.4), [0, cos(0.5), 0.5]) if name == "rod" else (box(0.3, height=0.2), None)
    q = start or rested(model, 0.2)
    v = [2.0, 0, 0] if name == "rod" else [1.0, 0.5, 0, 0, 0, 3.0]
    output = np.linspace(0, 0.05, 400)
    run = sf.simulate(model, q, v, t_end=0.05, output=output, method="dopri5", rtol=1e-12, atol=1e-14)
    modes = [one.mode for one in model.record.rigid_contacts]
    assert not run.events and (run.par_over_time[:, modes] == 1).all()
    rates = np.gradient(run.v, run.t, axis=0, edge_order=2)
    assert run.a[5:-5] == pytest.approx(rates[5:-5], abs=2e-4)
    par = np.array(run.par_over_time[1])
    par[modes] = 2.0
    G_rows = model.constraint_jacobian(run.q, u=run.u, par=par)
    M = model.mass_matrix(run.q, u=run.u)
    h = -model.forward_dynamics(run.q, run.v, run.u, par=model.parameter_values)
    force = np.einsum("nij,nj->ni", M, run.a + h)  # Of all but contact.
    assert np.einsum("nci,nc->ni", G_rows, run.lam) == pytest.approx(force, abs=1e-9)
    mu = 0.4 if name == "rod" else 0.3
    for one in model.record.rigid_contacts:
        x, y, normal = (run.lam[:, row] for row in one.rows)
        assert np.hypot(x, y) == pytest.approx(mu * normal, rel=1e-12) and normal.min() > 0.0


def test_friction_changes_the_forces_of_other_constraints() -> None:
    """Led along (2, 1), against friction; across, the line pushes what would not go there by itself."""
    mu, end = 0.3, 0.2
    model = guided(mu)
    run = sf.simulate(model, [0, 0, 0], [2.0, 1.0, 0], t_end=end, dt=1e-2)
    friction = -mu * 9.81 * np.array([2.0, 1.0]) / 5**0.5
    x = (friction[0] + 0.5 * friction[1]) / (4.0 + 0.25)  # Along the line, of 4 kg by x and 1 kg by y = x/2.
    assert run.a[:, 0] == pytest.approx(x, abs=1e-12) and run.v[-1, 0] == pytest.approx(2.0 + x * end, abs=1e-12)
    line = model.names.constraints.index("line")
    assert run.lam[:, line] == pytest.approx(0.5 * x - friction[1], abs=1e-11)


def test_a_ball_on_a_turntable_goes_in_circles() -> None:
    """Rolling on a table that turns at W its centre goes round at 2/7 W, wherever it begins and however fast."""
    spin, r = 1.5, 0.1
    table = sf.RigidBody("table", sf.Joint("turn", "revolute", axis=(0, 0, 1)), sf.Inertia(1.0, moments=(1e9,) * 3))
    body = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    floor = sf.Contact("floor", ("ball", None), ("table", None), restitution=0.0, friction=2.0, radius=r)
    model = sf.compile(sf.System("turntable", (table, body), connections=(floor,)))
    q, v = model.neutral(), np.zeros(7)
    q[1:4], v[0] = [0.5, 0.2, r], spin
    # Rolling: v = W x c - w x (-r n), at a velocity of its own.
    v[1:3] = [0.3, -0.1]
    wx, wy = (-(v[2] - spin * 0.5) / r, (v[1] + spin * 0.2) / r)
    v[4:6] = [wx, wy]
    run = sf.simulate(model, q, v, t_end=4.0, output=np.linspace(0, 4, 81), **FINE)
    assert not run.events
    rate = 2 / 7 * spin
    centre = np.array([0.5, 0.2]) + np.array([-v[2], v[1]]) / rate  # v = rate z x (c - centre)
    away = np.array([0.5, 0.2]) - centre
    c, s = np.cos(rate * run.t), np.sin(rate * run.t)
    known = centre + np.stack([c * away[0] - s * away[1], s * away[0] + c * away[1]], axis=1)
    assert run.q[:, 1:3] == pytest.approx(known, abs=1e-7)


def test_a_ball_slides_on_a_plane_that_tilts() -> None:
    """Without friction, on a plane that turns about its y axis at W: x'' = W^2 x + g sin(W t) along it."""
    spin, r = 0.8, 0.1
    plane = sf.RigidBody("plane", sf.Joint("tilt", "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, moments=(1e9,) * 3))
    body = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    floor = sf.Contact("floor", ("ball", None), ("plane", None), restitution=0.0, radius=r)
    model = sf.compile(sf.System("tilts", (plane, body), connections=(floor,)))
    q, v = model.neutral(), np.zeros(7)
    q[3], v[0], v[1] = r, spin, spin * r  # At rest on the plane, which moves it along at its height.
    run = sf.simulate(model, q, v, t_end=0.7, output=np.linspace(0, 0.7, 15), **FINE)
    assert not run.events
    c, s = np.cos(spin * run.t), np.sin(spin * run.t)
    x = run.q[:, 1] * c - run.q[:, 3] * s
    assert x == pytest.approx(G / (2 * spin**2) * (np.sinh(spin * run.t) - s), abs=1e-8)
    assert run.q[:, 1] * s + run.q[:, 3] * c == pytest.approx(r, abs=1e-9)


def test_a_stepper_makes_the_same_bits_and_can_be_set_back() -> None:
    """Steps by hand are those of `simulate`; a saved state goes on as before, directions of sliding included."""
    model = box(0.3)
    # It still slides at the end: the instants of the spiral in which a slip vanishes are those of rounding.
    q, v = rested(model, 0.15), [1.1, 0.75, 0, 0.2, 0.1, 2.15]
    run = sf.simulate(model, q, v, t_end=0.4, dt=1e-3, method="rk4")
    # Two feet land at once: rounding decides whether one or both are listed.
    assert len({round(found.t, 9) for found in run.events}) == 4
    stepper = sf.Stepper(model, dt=1e-3, method="rk4")
    stepper.reset(q, v)
    stepper.step(steps=250)
    kept = stepper.save()
    stepper.step(steps=150)
    assert np.array_equal(stepper.q, run.q[-1]) and np.array_equal(stepper.v, run.v[-1])
    stepper.restore(kept)
    stepper.step(steps=150)
    assert np.array_equal(stepper.q, run.q[-1])


def test_events_read_distances_and_slips() -> None:
    """`contact.floor.gap` and the velocities of the point of contact, in formulas of users."""
    event = sf.Event("contact.floor.gap - 0.05", "falling", terminal=True)
    run = sf.simulate(ball(), rested(ball(), 0.3), t_end=1.0, events={"near": event}, **FINE)
    assert run.t[-1] == pytest.approx(sqrt(0.3 / G), abs=1e-12)
    slip = sf.Event("contact.floor.vx - 1", "falling")
    run = sf.simulate(ball(), rested(ball(), 0.1), {"free.vx": 2.0}, t_end=0.3, events={"slow": slip}, **FINE)
    assert run.events[0].t == pytest.approx(1 / (3.5 * 0.5 * G), abs=1e-12)


def test_invalid_starts_numbers_and_methods_are_refused(tmp_path: Path) -> None:
    """Starts and numbers that mean nothing, and whatever does not choose modes, in words."""
    inside = rested(ball(), 0.09)
    assert sf.simulate(ball(), inside, t_end=0.1).outcome.kind == "input failed"
    model, system = ball(), ball_system()
    refused = {
        "equilibrium": lambda: sf.equilibrium(model),
        "export": lambda: sf.export(system, "sfunction", tmp_path / "s"),
    }
    for call in refused.values():
        with pytest.raises(sf.SymofrosError, match="is rigid"):
            call()
    with pytest.raises(sf.SymofrosError, match="restitution"):
        sf.Contact("c", ("ball", None), GROUND)
    with pytest.raises(sf.SymofrosError, match="exponent"):
        sf.Contact("c", ("ball", None), GROUND, restitution=0.5, exponent=2.0)
    body = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    for numbers in ({"restitution": 1.1}, {"restitution": -0.1}, {"restitution": 0.5, "friction": -0.1}):
        with pytest.raises(sf.DescriptionError, match="restitution|friction"):
            sf.compile(sf.System("s", (body,), connections=(sf.Contact("c", ("ball", None), GROUND, **numbers),)))
    many = sf.Contact("c", ("ball", None), GROUND, restitution=0.0, points=[(0.1 * k, 0, 0) for k in range(17)])
    model = sf.compile(sf.System("s", (body,), connections=(many,)))
    assert sf.simulate(model, t_end=0.1).outcome.kind == "input failed"


def test_a_file_holds_a_rigid_contact(tmp_path: Path) -> None:
    """Written and read again it is the same; without a stiffness or a restitution it is refused with its line."""
    path = tmp_path / "ball.yaml"
    sf.save(ball_system(), path)
    text = path.read_text()
    assert "restitution: 0.5" in text and "stiffness" not in text and "mode" not in text
    assert sf.load(path).contacts == ball_system().contacts
    path.write_text(text.replace(", restitution: 0.5", ""))
    with pytest.raises(sf.DescriptionError, match="compliant or rigid"):
        sf.load(path)


def test_a_body_that_moves_carries_the_plane() -> None:
    """A mass on a belt that is driven at a speed slides until it goes with it, by friction that works on both."""
    belt = sf.RigidBody("belt", sf.Joint("belt", "prismatic", axis=(1, 0, 0)), sf.Inertia(3.0))
    x = sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0)))
    mass = sf.RigidBody("mass", sf.Joint("z", "prismatic", axis=(0, 0, 1), parent="x"), sf.Inertia(1.0))
    foot = sf.Contact("foot", ("mass", None), ("belt", None), restitution=0.0, friction=0.4)
    model = sf.compile(sf.System("belt", (belt, x, mass), connections=(foot,)))
    run = sf.simulate(model, v0=[2.0, 0.0, 0.0], t_end=1.0, **FINE)
    (caught,) = run.events
    assert caught.name == "foot sticks" and caught.t == pytest.approx(2.0 / (0.4 * G * (1 + 1 / 3)), abs=1e-12)
    assert run.v[-1] == pytest.approx([1.5, 1.5, 0.0], abs=1e-11)
    momentum = run.v[:, 0] * 3.0 + run.v[:, 1]
    assert momentum == pytest.approx(6.0, abs=1e-11)


@pytest.mark.parametrize("spin", [40.0, 0.0])
def test_reactions_of_a_run_hold_the_bodies_by_newtons_law(spin: float) -> None:
    """A ball that slides, or lies, on a plate that swings; the joint of the free one transmits nothing."""
    thing = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    top = sf.Frame("top", (0.2, 0.0, 0.0), sf.Rotation.rpy(0, 0, 0.4))
    hinge = sf.Joint("hinge", "revolute", axis=(0, 1, 0))
    plate = sf.RigidBody("plate", hinge, sf.Inertia(3.0, (0.5, 0, 0), (0.5,) * 3), frames=[top])
    floor = sf.Contact("floor", ("ball", None), ("plate", "top"), restitution=0.0, radius=0.1, friction=0.3)
    model = sf.compile(sf.System("rigid", [plate, thing], connections=[floor]))
    start = model.neutral()
    start[1], start[3] = 0.15, 0.1
    run = sf.simulate(model, start, {"free.wy": spin}, t_end=0.04, dt=1e-3)
    found, (p, _) = run.contact_forces(), run.frames["ball"]
    force, k = found.force[:, 0], slice(10, -5)
    acceleration = ((p[2:] - 2 * p[1:-1] + p[:-2]) / 1e-6)[9:-4]
    np.testing.assert_allclose(force[k] / 0.4 + [0, 0, -9.81], acceleration, atol=2e-2)
    across = np.linalg.norm(force[k] - found.push[k] * run.frames["plate"][1][k][:, :, 2], axis=1)
    assert across == pytest.approx(0.3 * found.push[k, 0], rel=1e-9) or spin == 0.0
    # By the run's parameters, and by the model's own, of which no ball slides.
    for wrenches in (run.joint_wrenches(), model.joint_wrenches(run.q, run.v, run.a, run.u, run.lam, t=run.t)):
        assert np.abs(wrenches[:, 1]).max() < 1e-12
        moment = (0.5 + 3.0 * 0.25) * run.a[:, 0] - 3.0 * 9.81 * 0.5 * np.cos(run.q[:, 0])
        turning = np.cross(found.point[:, 0], -force)[:, 1]
        np.testing.assert_allclose(wrenches[k, 0, 4], 0.0, atol=1e-9)
        np.testing.assert_allclose(turning[k], moment[k], atol=1e-6)
    assert np.isnan(model.contact_forces(run.q, run.v).force).all()
    np.testing.assert_array_equal(
        run.closure_wrench("floor.normal", on="first")[:, :3], -run.closure_wrench("floor.normal")[:, :3]
    )
