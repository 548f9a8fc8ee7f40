"""Friction that sticks: held exactly, sliding by closed forms, one set of modes at an instant (constraints.md, 14)."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.yaml.yaml_writer import write_yaml

_G = 9.81
_ACCURATE: dict[str, Any] = {"method": "dopri5", "rtol": 1e-11, "atol": 1e-13}


def on_slide(*elements: Any, slope: float = 0.0, mass: float = 2.0, **fields: Any) -> sf.Model:
    """A block that slides down a plane."""
    axis = (math.cos(slope), 0.0, -math.sin(slope))
    block = sf.RigidBody("block", sf.Joint("s", "prismatic", axis=axis, elements=elements), sf.Inertia(mass))
    return sf.compile(sf.System("on_slide", (block,), **fields))


def names_of(run: sf.Trajectory) -> list[str]:
    """What was met, in order."""
    return [found.name for found in run.events]


@cache
def incline(share: float) -> sf.Model:
    """A block on a plane whose friction is that share of what holds it."""
    slope = 0.3
    return on_slide(sf.Friction(share * 2.0 * _G * math.sin(slope), sticks=True), slope=slope)


@pytest.mark.parametrize("options", [{"dt": 1e-3}, {"method": "dopri5"}, {"method": "rodas4"}])
def test_a_block_on_an_incline_is_held_or_slides(options: dict[str, Any]) -> None:
    """At mu = tan(alpha) (1 +- 1e-3): it stays to the last bit, or accelerates by the closed form to 1e-12 g.

    A compiler that fuses products and sums leaves a rounding of the acceleration, which no step adds to the speed.
    """
    held = sf.simulate(incline(1.001), [0.7], t_end=5.0, **options)
    assert held.outcome.kind == "finished" and not held.outcome.notes and not held.events
    assert (held.q == 0.7).all() and not held.v.any() and np.abs(held.a).max() < 1e-15
    assert held.lam == pytest.approx(np.full_like(held.lam, -2.0 * _G * math.sin(0.3)), rel=1e-14)
    slides = sf.simulate(incline(0.999), [0.7], t_end=5.0, **options)
    a = 0.001 * _G * math.sin(0.3)
    assert slides.outcome.kind == "finished" and not slides.outcome.notes and not slides.events
    assert np.abs(slides.v[-1, 0] / 5.0 - a) < 1e-12 * _G and np.abs(slides.a - a).max() < 1e-12 * _G


def test_a_million_steps_move_nothing() -> None:
    """Held displacement is zero, exactly; the friction that is smooth creeps by 0.2 m in the same time."""
    run = sf.simulate(incline(1.001), t_end=1000.0, dt=1e-3, every=100_000)
    assert run.statistics.steps == 1_000_000 and not run.q.any() and not run.v.any() and not run.events


@pytest.mark.parametrize(
    "options",
    [
        _ACCURATE,
        {"dt": 1e-3},
        {"method": "rodas4", "rtol": 1e-9, "atol": 1e-11},
        {"method": "generalized_alpha", "dt": 1e-4},
        {"method": "dop853", "rtol": 1e-10, "stabilisation": "baumgarte"},
    ],
)
def test_an_oscillator_loses_amplitude_by_the_closed_form(options: dict[str, Any]) -> None:
    """2 F/k each half period, and it stops where the spring holds no longer than friction, for good."""
    k, F, start = 100.0, 4.0, 1.0
    model = on_slide(sf.Spring(k), sf.Friction(F, sticks=True), mass=1.0)
    run = sf.simulate(model, [start], t_end=6.0, **options)
    turns = math.ceil((k * start / F - 1.0) / 2.0)
    assert names_of(run) == ["s slides"] * (turns - 1) + ["s sticks"] and turns == 12
    tolerance = 1e-5 if options.get("method") == "generalized_alpha" else 1e-8
    ends = np.array([found.q[0] for found in run.events])
    expected = (start - 2.0 * F / k * np.arange(1, turns + 1)) * (-1.0) ** np.arange(1, turns + 1)
    assert np.abs(ends - expected).max() < tolerance
    assert np.abs([found.t - math.pi / 10 * (i + 1) for i, found in enumerate(run.events)]).max() < 10 * tolerance
    last = run.t >= run.events[-1].t
    assert np.ptp(run.q[last]) == 0.0 and not run.v[last][1:].any()
    assert (np.diff(run.energy) <= 1e-9 * run.energy[0]).all()


def test_a_pendulum_stops_where_its_energy_says() -> None:
    """Between two turns m g l (cos b - cos a) = F |b - a|: the closed form, turn after turn."""
    F, m, length = 0.15, 1.3, 0.8
    joint = sf.Joint("q", "revolute", axis=(0, 1, 0), elements=(sf.Friction(F, sticks=True),))
    model = sf.compile(
        sf.System("pendulum", (sf.RigidBody("arm", joint, sf.Inertia(m, (0, 0, -length), (0.02, 0.02, 0))),))
    )
    run = sf.simulate(model, [1.2], t_end=60.0, **_ACCURATE)
    turns = np.array([1.2, *(found.q[0] for found in run.events)])
    weight = m * _G * length
    assert np.abs(weight * (np.cos(turns[1:]) - np.cos(turns[:-1])) - F * np.abs(np.diff(turns))).max() < 1e-8
    assert names_of(run)[-1] == "q sticks" and "q sticks" not in names_of(run)[:-1]
    assert weight * math.sin(abs(turns[-1])) < F < weight * math.sin(abs(turns[-2]))


def slipping_on_a_belt(t_end: float, V: float, k: float, m: float, Fs: float, Fk: float) -> list[float]:
    """Instants at which a mass between a spring and a moving belt slips and sticks, by closed forms and bisection."""
    w, t, instants = math.sqrt(k / m), Fs / (k * V), []
    offset = (Fs - Fk) / k

    def slip(s: float) -> float:
        return -offset * w * math.sin(w * s) + V * math.cos(w * s) - V

    low, high = math.pi / w, 2.0 * math.pi / w - 1e-6  # It comes back to the speed of the belt once in there.
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slip(middle) < 0.0 else (low, middle)
    at = Fk / k + offset * math.cos(w * low) + V / w * math.sin(w * low)
    while t < t_end:
        instants += [t, t + low]
        t += low + (Fs / k - at) / V
    return [t for t in instants if t < t_end]


def test_stick_slip_on_a_belt() -> None:
    """Breakaway above dynamic friction: against the motion put together of its closed forms, to 1e-8."""
    V, k, m, Fs, Fk = 0.1, 50.0, 1.0, 6.0, 4.0
    belt = sf.RigidBody("belt", sf.Joint("belt", "prismatic", axis=(1, 0, 0), prescribed=True), sf.Inertia(1.0))
    joint = sf.Joint("slip", "prismatic", "belt", axis=(1, 0, 0), elements=(sf.Friction(Fk, Fs, sticks=True),))
    spring = sf.Potential("spring", f"{k}/2*(belt + slip)^2")
    bodies = (belt, sf.RigidBody("block", joint, sf.Inertia(m)))
    model = sf.compile(sf.System("on_belt", bodies, gravity=(0, 0, 0), potentials=(spring,)))
    run = sf.simulate(model, t_end=8.0, u={"belt": f"{V}*t"}, **_ACCURATE)
    expected = slipping_on_a_belt(8.0, V, k, m, Fs, Fk)
    assert names_of(run) == [f"slip {'sticks' if i % 2 else 'slides'}" for i in range(len(expected))]
    assert len(expected) > 9 and np.abs([found.t for found in run.events] - np.array(expected)).max() < 1e-8


def test_friction_falls_from_static_to_dynamic_over_the_stribeck_velocity() -> None:
    """The force while it slides is Stribeck's law and viscous friction, of the speed's sign."""
    friction = sf.Friction(2.0, 5.0, viscous=0.3, stribeck_velocity=0.2, sticks=True)
    model = on_slide(friction, inputs=(sf.Input("pull"),), virtual_power=(sf.VirtualPower("pull", {"ds": "pull"}),))
    run = sf.simulate(model, t_end=4.0, u={"pull": "7*sin(2*t)"}, **_ACCURATE)
    sliding = run.par_over_time[:, 0] != 2.0
    v, mode = run.v[sliding, 0], run.par_over_time[sliding, 0]
    expected = mode * (2.0 + 3.0 * np.exp(-((v / 0.2) ** 2))) + 0.3 * v
    assert np.abs(7.0 * np.sin(2.0 * run.t[sliding]) - 2.0 * run.a[sliding, 0] - expected).max() < 1e-9
    assert set(mode) == {1.0, -1.0} and run.v[sliding, 0] * mode == pytest.approx(np.abs(v), abs=1e-12)
    assert run.events[0].t == pytest.approx(math.asin(5.0 / 7.0) / 2.0, abs=1e-10)


def arm(n: int, levels: Sequence[float], **fields: Any) -> sf.Model:
    """A chain of n links about alternating axes, each joint with friction that sticks."""
    bodies, parent = [], "world"
    for i in range(n):
        axis = [(0, 1, 0), (0, 0, 1), (0, 1, 0.3)][i % 3]
        joint = sf.Joint(
            f"q{i}",
            "revolute",
            parent,
            axis=axis,
            elements=(sf.Friction(levels[i], sticks=True),),
            frame="end" if i else None,
        )
        inertia = sf.Inertia(1.0 + 0.1 * i, (0.2, 0.01, 0.02), (0.01, 0.02, 0.02))
        bodies.append(sf.RigidBody(f"b{i}", joint, inertia, (sf.Frame("end", (0.4, 0, 0)),)))
        parent = f"b{i}"
    return sf.compile(sf.System("arm", tuple(bodies), **fields))


def agreeing_modes(model: sf.Model, q: Any, levels: Any) -> list[tuple[float, ...]]:
    """All sets of modes at rest that agree with their motion, by enumeration."""
    found, par = [], np.array(model.parameter_values)
    for modes in itertools.product((2.0, 1.0, -1.0), repeat=model.nv):
        par[[one.mode for one in model.record.sticking]] = modes
        a, lam, _ = model.constrained_dynamics(q, np.zeros(model.nv), np.zeros(0), par=par)
        held = np.array(modes) == 2.0
        if (np.abs(lam) <= levels)[held].all() and (np.array(modes) * a >= -1e-12)[~held].all():
            found.append(modes)
    return found


def test_the_modes_of_several_joints_are_the_only_consistent_set() -> None:
    """Of all 3^4 sets, at random postures and levels; Gauss's principle leaves one acceleration."""
    rng, sizes = np.random.default_rng(5), set()
    for _ in range(6):
        levels = np.array([9.0, 4.0, 2.0, 0.6]) * rng.uniform(0.1, 1.6, 4)
        model = arm(4, levels.tolist())
        for _ in range(3):
            q = rng.uniform(-2.0, 2.0, 4)
            run = sf.simulate(model, q, t_end=1e-6, dt=1e-6)
            (expected,) = agreeing_modes(model, q, levels)
            assert tuple(run.par) == expected
            sizes.add(expected.count(2.0))
    assert len(sizes) > 2


def test_an_arm_of_seven_joints_comes_to_rest() -> None:
    """Each joint stops in its turn; energy falls by what friction takes, and at the end nothing moves at all."""
    levels = [6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.5]
    model = arm(7, levels, gravity=(0, 0, -1.0))
    run = sf.simulate(
        model, np.linspace(0.5, -0.4, 7), np.linspace(-1.5, 2.0, 7), t_end=12.0, method="dopri5", rtol=1e-9
    )
    assert run.outcome.kind == "finished", run.outcome
    assert (np.diff(run.energy) <= 1e-7 * np.abs(run.energy).max()).all()
    assert (run.par_over_time[-1] == 2.0).all() and not run.v[-1].any() and np.abs(run.lam[-1]).max() > 1.0
    power = -np.abs(run.v) @ np.array(levels)
    taken = np.sum((power[1:] + power[:-1]) / 2 * np.diff(run.t))
    assert run.energy[-1] - run.energy[0] == pytest.approx(taken, rel=2e-3)


def test_a_brake_holds_and_slips_above_its_torque() -> None:
    """It holds an arm level, slips where the load is above its torque, and lets go by a parameter."""
    brake = sf.Brake("torque", "shut")
    joint = sf.Joint("q", "revolute", axis=(0, -1, 0), elements=(brake,))
    parameters = (sf.Parameter("torque", 10.0), sf.Parameter("shut", 1.0), sf.Parameter("m", 1.0))
    body = sf.RigidBody("arm", joint, sf.Inertia("m", (1.0, 0, 0), (0.1, 0.1, 0)))
    model = sf.compile(sf.System("braked", (body,), parameters))
    events = {"load": sf.Event("t - 1", action={"m": 1.5}), "open": sf.Event("t - 2", action={"shut": 0})}
    run = sf.simulate(model, t_end=3.0, events=events, **_ACCURATE)
    level = run.t <= 1.0
    assert names_of(run)[:2] == ["load", "open"] and not run.q[level].any()
    after = int(np.argmax(run.t > 1.0)) + 1
    assert run.a[after, 0] == pytest.approx((10.0 - 1.5 * _G) / 1.6, rel=1e-2)
    shut = sf.simulate(model, t_end=3.0, par={"torque": 15.0}, events={"load": events["load"]}, **_ACCURATE)
    assert not shut.q.any() and not shut.v.any() and shut.lam[-1, 0] == pytest.approx(1.5 * _G, rel=1e-12)


def test_a_brake_of_a_file_is_that_of_python(tmp_path: Any) -> None:
    """Its torque and share are formulas; what is written is read as the same friction."""
    text = "symofros: 1\nsystem: {name: b}\nparameters: {torque: 12, shut: 1}\nbodies:\n  arm:\n    joint: {name: q"
    text += ", kind: revolute, axis: [0, -1, 0], elements: [{brake: BRAKE}]}\n"
    text += "    inertia: {mass: 2, moments: [0.1, 0.1, 0.1]}\n"
    path = tmp_path / "brake.yaml"
    for stated, brake in (("{torque: 2*torque, engaged: shut}", ("2*torque", "shut")), ("{torque: 3}", (3.0,))):
        path.write_text(text.replace("BRAKE", stated))
        system = sf.load(path)
        assert system.bodies[0].joint is not None and system.bodies[0].joint.elements == (sf.Brake(*brake),)
        path.write_text(write_yaml(system))
        assert sf.load(path).bodies == system.bodies
    path.write_text(text.replace("BRAKE", "{engaged: shut}"))
    with pytest.raises(sf.DescriptionError, match="torque"):
        sf.load(path)


def test_an_impact_sets_a_held_joint_moving() -> None:
    """Friction has no impulse: what strikes a block at rest moves it, and friction stops it by the closed form."""
    rail = {"axis": (1, 0, 0)}
    held = sf.Joint("x", "prismatic", elements=(sf.Friction(3.0, sticks=True),), **rail)
    bodies = (
        sf.RigidBody("block", held, sf.Inertia(2.0)),
        sf.RigidBody("ball", sf.Joint("y", "prismatic", **rail), sf.Inertia(1.0)),
    )
    touch = sf.Closure("touch", ("block", None), ("ball", None), ("x",))
    system = sf.System(
        "struck", bodies, (sf.Parameter("hit", 0),), constraints=(touch,), switches=(sf.Switch("touch", "hit"),)
    )
    strike = sf.Event("y - x", "rising", action={"hit": 1}, restitution=1.0)
    run = sf.simulate(sf.compile(system), [0.0, -1.0], [0.0, 3.0], t_end=3.0, events={"strike": strike}, **_ACCURATE)
    assert names_of(run) == ["strike", "x sticks"]
    hit, stopped = run.events
    assert hit.v_after == pytest.approx([2.0, -1.0], abs=1e-12)
    assert stopped.t - hit.t == pytest.approx(2.0 * 2.0 / 3.0, abs=1e-9)
    assert run.q[-1, 0] == pytest.approx(2.0 * 2.0**2 / (2.0 * 3.0), abs=1e-9)


def four_bar(*rubbing: str) -> sf.Model:
    """A four-bar linkage in a vertical plane with friction that sticks at some of its joints."""

    def bar(name: str, parent: str, length: float, frame: str | None) -> sf.RigidBody:
        elements = (sf.Friction(0.8, sticks=True),) if name in rubbing else ()
        joint = sf.Joint(name, "revolute", parent, axis=(0, 1, 0), elements=elements, frame=frame)
        return sf.RigidBody(
            f"{name}_bar",
            joint,
            sf.Inertia(length, (length / 2, 0, 0), (0, length**3 / 12, length**3 / 12)),
            (sf.Frame("end", (length, 0, 0)),),
        )

    bodies = (
        sf.RigidBody("world", None, frames=(sf.Frame("far", (1.2, 0, 0)),)),
        bar("a", "world", 0.4, None),
        bar("b", "a_bar", 1.1, "end"),
        bar("c", "world", 0.7, "far"),
    )
    return sf.compile(
        sf.System("four_bar", bodies, constraints=(sf.Closure("pin", ("b_bar", "end"), ("c_bar", "end"), ("x", "z")),))
    )


def test_a_loop_with_a_joint_that_sticks() -> None:
    """It stops and stays; two that would both hold its one degree of freedom end the run in words."""
    model = four_bar("a")
    start = sf.assemble(model, {"a": -0.9, "b": 0.6, "c": -1.2}).q
    run = sf.simulate(model, start, t_end=10.0, **_ACCURATE)
    assert names_of(run)[-1] == "a sticks" and not run.v[-1].any() or np.abs(run.v[-1]).max() < 1e-12
    assert (np.diff(run.energy) <= 1e-8).all() and np.abs(run.lam[-1, -1]) < 0.8
    end = run.t >= run.events[-1].t
    assert np.ptp(run.q[end][:, 0]) == 0.0
    both = sf.simulate(four_bar("a", "c"), start, t_end=10.0, **_ACCURATE)
    assert both.outcome.kind == "singular" and "is not determined" in both.outcome.reason


@pytest.mark.parametrize("seed", range(4))
def test_a_driven_arm_keeps_the_law_of_friction_at_every_record(seed: int) -> None:
    """Held joints are at rest and carry no more than static friction, sliding ones move as their mode says."""
    rng = np.random.default_rng(seed)
    levels = rng.uniform(0.5, 3.0, 4)
    model = arm(
        4,
        levels.tolist(),
        gravity=(0, 0, -2.0),
        inputs=(sf.Input("w"),),
        virtual_power=tuple(
            sf.VirtualPower(f"p{i}", {f"dq{i}": f"{x}*sin({2 + i}*t)*w"}) for i, x in enumerate((9, 6, 4, 2))
        ),
    )
    run = sf.simulate(model, rng.uniform(-1, 1, 4), t_end=3.0, u={"w": 1.0}, method="dopri5", rtol=1e-8, atol=1e-10)
    assert run.outcome.kind == "finished" and len(run.events) > 8, run.outcome
    modes = run.par_over_time
    held = modes == 2.0
    assert (
        not run.v[held].any()
        and (np.abs(run.lam)[held] <= np.broadcast_to(levels, held.shape)[held] * (1 + 1e-9)).all()
    )
    assert (run.v * modes)[~held].min() > -1e-12 and set(np.unique(modes)) == {-1.0, 1.0, 2.0}
