"""Inputs that prescribe a motion belong to one motion, or are refused."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
import symofros.blocks as blocks
from symofros.simulation.prescribed_motions import _INTERVALS, _between_samples
from tests.diagrams.parts import moving
from tests.simulation.mechanisms import turned


@cache
def crane() -> sf.Model:
    """A hoist whose angle is prescribed, with a bob that swings."""
    hoist = sf.Joint("th", "revolute", axis=(0, -1, 0), prescribed=True)
    tip = (sf.Frame("e", (0, 0, -1)),)
    arm = sf.RigidBody("hoist", hoist, sf.Inertia(1, (0, 0, -0.5), (0.1, 0.1, 0.01)), tip)
    swing = sf.Joint("q", "revolute", "hoist", "e", axis=(0, -1, 0))
    bob = sf.RigidBody("bob", swing, sf.Inertia(1.0, (0, 0, -0.5), (0.05, 0.05, 0.01)))
    return sf.compile(sf.System("crane", (arm, bob)))


@cache
def carried() -> sf.Model:
    return sf.compile(turned())


T = np.linspace(0, 2, 81)
HELD = np.diff(np.sin(3 * np.linspace(0, 2.025, 82))) / 0.025  # Until the next sample.
GOOD: dict[str, Any] = {
    "position": {"th": "0.3*t"},
    "all three": {"th": "sin(30*t)", "dth": "30*cos(30*t)", "ddth": "-900*sin(30*t)"},
    "an angle that stays": {"th": 0.7, "dth": 0.0},
    "samples": {
        "th": sf.Signal(T, np.sin(3 * T)),
        "dth": sf.Signal(T, 3 * np.cos(3 * T)),
        "ddth": sf.Signal(T, -9 * np.sin(3 * T)),
    },
    "held samples": {
        "th": sf.Signal(T, np.sin(3 * T), "hold"),
        "dth": sf.Signal(T, HELD, "hold"),
        "ddth": sf.Signal(T, np.append(np.diff(HELD), 0.0) / 0.025, "hold"),
    },
    "all by one signal": sf.Signal(T, np.array([0.1 + 0 * T, 0 * T, 0 * T]).T),
}
BAD: dict[str, Any] = {
    "speed alone": {"dth": "0.3"},
    "number alone": {"dth": 0.3},
    "acceleration alone": {"ddth": 0.5},
    "contradicting": {"th": "0.3*t", "dth": "0.1"},
    "another acceleration": {"th": "sin(t)", "dth": "cos(t)", "ddth": 0.0},
    "samples that end early": {
        "th": sf.Signal([0, 1], [0, 0.3]),
        "dth": sf.Signal([0, 1], [0.3, 0.3]),
        "ddth": 0.0,
    },
    "an array": np.array([0.2, 0.3, 0.0]),
    "all by one signal": sf.Signal([0, 2], [[0.1, 0.2, 0.0], [0.1, 0.2, 0.0]]),
}


@pytest.mark.parametrize("how", GOOD)
def test_consistent_prescribed_motions_run(how: str) -> None:
    """And bears no note."""
    run = sf.simulate(crane(), t_end=2.0, u=GOOD[how])
    assert run.outcome.kind == "finished"
    assert not [note for note in run.outcome.notes if "prescribe" in note]
    assert "finished" in str(sf.simulate_batch(crane(), np.zeros((2, 1)), t_end=2.0, u=GOOD[how]).outcome((0,)))


@pytest.mark.parametrize("how", BAD)
def test_inconsistent_prescribed_motions_are_refused(how: str) -> None:
    """By single runs and batches, with both rates and a remedy."""
    for simulate, q0 in ((sf.simulate, np.zeros(1)), (sf.simulate_batch, np.zeros((2, 1)))):
        with pytest.raises(sf.SymofrosError, match="prescribe no one motion"):
            simulate(crane(), q0, t_end=2.0, u=BAD[how])


JUMPS = {
    "0.1*abs(t - 1)": ("dth", 1.0, 0.2),
    "min(t, 0.73)": ("dth", 0.73, -1.0),
    "max(0, t - 0.37)": ("dth", 0.37, 1.0),
    "0.1*sign(t - 1.2)": ("th", 1.2, 0.2),
    "1e3 + sin(2*t) + 0.01*abs(t - 1.5)": ("dth", 1.5, 0.02),
    "abs(sin(7*t))": ("dth", np.pi / 7, 14.0),
}
SMOOTH = [
    "0.4*(1 - cos(pi*min(t, 1)))",
    "max(0, t - 1)^2",
    "abs(t - 1)^3",
    "1e6 + 0.001*sin(t)",
    "1e8*t",
    "sin(300*t)",
    "exp(-1e4*(t - 1)^2)",
    "tanh(500*(t - 1.1))",
    "0.3",
]


@pytest.mark.parametrize("law", JUMPS)
def test_prescribed_motions_that_jump_are_refused(law: str) -> None:
    """A hoist that stops within an instant throws its bob, by an impulse that no step has: at rest it stayed."""
    name, t, size = JUMPS[law]
    for simulate, q0 in ((sf.simulate, np.zeros(1)), (sf.simulate_batch, np.zeros((2, 1)))):
        with pytest.raises(sf.SymofrosError, match="prescribes a motion that jumps") as refused:
            simulate(crane(), q0, t_end=2.0, u={"th": law})
        assert f"at t = {t:.6g} s '{name}' changes by {size:.4g} " in str(refused.value)
    stated = {"th": "min(t, 0.73)", "dth": "0.5 + 0.5*sign(0.73 - t)", "ddth": "0"}
    with pytest.raises(sf.SymofrosError, match="jumps"):
        sf.simulate(crane(), t_end=2.0, u=stated)


@pytest.mark.parametrize("law", SMOOTH)
@pytest.mark.parametrize("t0", [0.0, 1e7])
def test_motions_that_bend_sharply_are_no_jumps(law: str, t0: float) -> None:
    """Accelerations may jump, speeds may change fast."""
    moved = re.sub(r"\bt\b", f"(t - {t0!r})", law)
    run = sf.simulate(crane(), t0=t0, t_end=t0 + 2.0, u={"th": moved}, dt=0.05)
    assert run.outcome.kind == "finished"


@pytest.mark.parametrize("axis", "xyz")
def test_the_rate_that_is_named_is_the_one_that_is_stated(axis: str) -> None:
    """Of an angular velocity: by single runs and by batches, where one trajectory states it."""
    for simulate, stated in ((sf.simulate, 0.3), (sf.simulate_batch, np.array([0.0, 0.3]))):
        q0 = np.zeros(1) if simulate is sf.simulate else np.zeros((2, 1))
        with pytest.raises(sf.SymofrosError, match=rf"'p\.w{axis}' is 0\.3, and 'p\.qx' changes at 0"):
            simulate(carried(), q0, t_end=1.0, u={f"p.w{axis}": stated})


@pytest.mark.parametrize("seed", range(2))
def test_angular_velocities_belong_to_their_quaternions(seed: int) -> None:
    """About a random axis at a random speed, and with another speed."""
    rng = np.random.default_rng(seed)
    axis, w = rng.normal(size=3), float(rng.uniform(0.5, 20.0))
    axis /= np.linalg.norm(axis)
    law = {f"p.q{x}": f"{a!r}*sin({w!r}*t/2)" for x, a in zip("xyz", axis.tolist(), strict=True)} | {
        "p.qw": f"cos({w!r}*t/2)"
    }
    spin = {f"p.w{x}": float(w * a) for x, a in zip("xyz", axis, strict=True)}
    assert sf.simulate(carried(), t_end=1.0, u=law | spin).outcome.kind == "finished"
    for wrong in ({}, {name: -value for name, value in spin.items()}, {name: 1.01 * w for name, w in spin.items()}):
        with pytest.raises(sf.SymofrosError, match="prescribe no one motion"):
            sf.simulate(carried(), t_end=1.0, u=law | wrong)


@cache
def free_base() -> tuple[sf.Model, dict[str, str]]:
    """A pendulum on a base that is moved as a whole, and inputs that turn it by 3 rad/s about z."""
    base = sf.RigidBody("base", sf.Joint("f", "free", prescribed=True), sf.Inertia(1.0, (0, 0, 0), (1.0, 1.0, 1.0)))
    swing = sf.Joint("q", "revolute", "base", position=(0.3, 0, 0), axis=(0, -1, 0))
    arm = sf.RigidBody("arm", swing, sf.Inertia(1.0, (0.5, 0, 0), (0.001, 0.1, 0.1)))
    turning = {"f.qz": "sin(1.5*t)", "f.qw": "cos(1.5*t)", "f.wz": "3"}
    return sf.compile(sf.System("moved", (base, arm))), turning


@pytest.mark.parametrize(
    ("velocity", "said"),
    [
        ({}, "'f.vx' is 0, and 'f.px' changes at"),
        ({"f.vx": "0.6*cos(2*t)"}, "'f.vx' is .*, and 'f.px' changes at"),
        ({"f.vx": "0.6*cos(2*t)*cos(3*t)", "f.vy": "0.6*cos(2*t)*sin(3*t)"}, "'f.vy' is .*, and 'f.py' changes at"),
        ({"f.vx": "0.6*cos(2*t)*cos(3*t)", "f.vy": "-0.6*cos(2*t)*sin(3*t)"}, ""),
    ],
)
def test_velocities_of_a_free_joint_belong_to_its_place_and_rotation(velocity: dict[str, str], said: str) -> None:
    """They are those in its own axes; where they are right the motion is."""
    model, turning = free_base()
    u = {"f.px": "0.3*sin(2*t)", **turning, **velocity}
    if said:
        with pytest.raises(sf.SymofrosError, match=said):
            sf.simulate(model, [0.7], t_end=4.0, u=u)
        return
    run = sf.simulate(model, [0.7], t_end=4.0, u=u)
    assert run.q[-1, 0] == pytest.approx(-0.31714839, abs=1e-7) and not run.outcome.notes  # SciPy, DOP853 at 1e-12.


def test_prescribed_motions_of_python_functions_are_judged_by_their_values() -> None:
    """It may have a state, so that it is not called beforehand: a note."""
    wrong = sf.simulate(crane(), t_end=1.0, u=lambda t, q, v: [0.3 * t, 0.1, 0.0], dt=1e-2)
    right = sf.simulate(crane(), t_end=1.0, u=lambda t, q, v: [0.3 * t, 0.3, 0.0], dt=1e-2)
    assert [note for note in wrong.outcome.notes if "prescribe no one motion" in note]
    assert not [note for note in right.outcome.notes if "prescribe" in note]


@pytest.mark.parametrize(("rate", "noted"), [(0.3, False), (0.1, True)])
def test_prescribed_motions_of_wires_are_judged_by_their_values(rate: float, noted: bool) -> None:
    """Compiled and interpreted."""
    hoist = sf.RigidBody("hoist", sf.Joint("th", "revolute", axis=(0, 1, 0), prescribed=True), sf.Inertia(1.0))
    bob = sf.RigidBody(
        "bob", sf.Joint("q", "revolute", "hoist", position=(0, 0, -1), axis=(0, 1, 0)), sf.Inertia(1.0, (0, 0, -0.5))
    )
    diagram = moving(sf.System("plant", (hoist, bob)), u="th.y")
    diagram.add(blocks.Ramp(name="th", slope=[0.3, 0.0, 0.0], start=[0.0, rate, 0.0]))
    simulation = sf.Simulation(diagram)
    for run in (simulation.run(0.5, dt=1e-3, record=0.01), simulation.interpret(0.5, dt=1e-3, record=0.01)):
        assert run.outcome.kind == "finished"
        assert noted == any("prescribe no one motion" in note for note in run.outcome.notes)


@pytest.mark.parametrize(("q", "dq"), [(0.1667, 0.35), (1 / 6, 0.350002), (0.1667, 0.350002), (1 / 6, 0.35)])
def test_stated_starts_beside_prescribed_motions_are_noted_where_they_change(q: float, dq: float) -> None:
    """In a diagram: coordinates and speeds, each where its last digits were taken otherwise."""
    hoist = sf.RigidBody("hoist", sf.Joint("th", "revolute", axis=(0, 1, 0), prescribed=True), sf.Inertia(1.0))
    bob = sf.RigidBody("bob", sf.Joint("q", "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, (0, 0, -0.5)))
    geared = sf.System("plant", (hoist, bob), constraints=(sf.Coupling("gear", "q - th/2"),))
    diagram = moving(geared, start={"q": q, "dq": dq}, u="th.y")
    diagram.add(blocks.Ramp(name="th", slope=[0.7, 0.0, 0.0], start=[1 / 3, 0.7, 0.0]))
    run = sf.Simulation(diagram).run(0.01, dt=1e-3)
    noted = {note.split(" = ")[0].split()[-1]: note for note in run.outcome.notes if "was taken as" in note}
    assert set(noted) == ({"q"} if q != 1 / 6 else set()) | ({"dq"} if dq != 0.35 else set())
    assert all(f"{value:g} was taken as" in noted[name] for name, value in {"q": q, "dq": dq}.items() if name in noted)


@pytest.mark.parametrize("samples", [3, _INTERVALS, 5 * _INTERVALS])
def test_intervals_between_samples_reach_over_the_run(samples: int) -> None:
    """All of a few, some of many."""
    times = np.linspace(-1.0, 3.0, samples)
    pairs = _between_samples([times, times[::2]], (0.0, 2.5))
    assert pairs[0][0] == 0.0 and pairs[-1][1] == 2.5 and len(pairs) <= _INTERVALS
    inner = times[(times > 0.0) & (times < 2.5)]
    if len(inner) < _INTERVALS:
        assert [pair[1] for pair in pairs] == [*inner, 2.5]
    assert all(np.searchsorted(inner, a, side="right") == np.searchsorted(inner, b, side="left") for a, b in pairs)


def test_a_batch_starts_where_its_motions_are_at_that_time() -> None:
    """Whether a start is on its constraints depends on inputs by formulas of the time at which the run begins."""
    hoist = sf.RigidBody("hoist", sf.Joint("th", "revolute", axis=(0, 1, 0), prescribed=True), sf.Inertia(1.0))
    bob = sf.RigidBody("bob", sf.Joint("q", "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, (0, 0, -0.5)))
    gear = sf.Coupling("gear", sf.formula("q - 2*th"))
    model = sf.compile(sf.System("geared", (hoist, bob), constraints=(gear,)), sf.Options(backend="tape"))
    law = {"th": "0.3*t + 0.1*t^2", "dth": "0.3 + 0.2*t", "ddth": 0.2}
    at = {t: ([0.6 * t + 0.2 * t**2], [0.6 + 0.4 * t]) for t in (0.0, 1.5)}
    runs = sf.simulate_batch(model, [at[0.0][0], at[1.5][0]], [at[0.0][1], at[1.5][1]], 1.6, t0=1.5, u=law, dt=0.01)
    assert runs.ok.tolist() == [False, True]
    np.testing.assert_allclose(runs.q_last[1], 0.6 * 1.6 + 0.2 * 1.6**2, atol=1e-6)
