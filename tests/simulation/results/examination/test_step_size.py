"""Notes on fixed steps: where the method is unstable or its error is large, and there alone."""

from __future__ import annotations

import itertools
import math
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.stepping.methods import METHODS, stability_limit
from symofros.simulation.stepping.resolution import TOLERANCE
from tests.models import GUESSES, compiled
from tests.simulation.oscillator import exact, fixed, oscillator

JUDGED = tuple(name for name, method in METHODS.items() if method.family.judged)
# Step [s], and step times the undamped frequency.
H, STIFFNESS = 1e-2, np.geomspace(1e-3, 5.0, 19)


def step_notes(run: sf.Trajectory) -> list[str]:
    return [note for note in run.outcome.notes if note.startswith(("the step of", "steps of"))]


def oscillation(method: str, z: float, damping: float, steps: int, **options) -> tuple[sf.Trajectory, float]:
    """A run, and its largest error, relative to the largest displacement from the start and speed."""
    k, c = (z / H) ** 2, 2.0 * damping * z / H
    options = {"adaptive": fixed(method)} | options
    run = sf.simulate(oscillator(), [1.0], [0.3 * z / H], steps * H, method=method, dt=H, par=[k, c], **options)
    x, v = exact(k, c, 1.0, 0.3 * z / H, run.t)
    if not run.outcome.ok:
        return run, math.inf
    return run, max(
        np.abs(run.q[:, 0] - x).max() / np.abs(x - 1.0).max(), np.abs(run.v[:, 0] - v).max() / np.abs(v).max()
    )


@pytest.mark.parametrize("damping", [0.0, 0.05, 1.5])
@pytest.mark.parametrize("method", JUDGED)
def test_only_large_errors_are_noted(method: str, damping: float) -> None:
    """The tolerance of a tenth is met within a factor of three: shares and modes are those of a few states.

    Runs of order 1 are held as a whole, too, to 0.03.
    """
    silent = (0.1 if METHODS[method].order == 1 else 0.5) * TOLERANCE
    for z in STIFFNESS:
        for steps in (20, 300):
            run, error = oscillation(method, z, damping, steps)
            if error > 3.0 * TOLERANCE:
                assert step_notes(run), (z, steps, error)
            elif error < silent:
                assert not step_notes(run), (z, steps, error)


@pytest.mark.parametrize("method", ["semi_implicit_euler", "rk4", "dop853"])
def test_a_note_names_limit_mode_and_energy(method: str) -> None:
    limit = METHODS[method].imaginary_limit
    run, _ = oscillation(method, 1.05 * limit, 0.0, 100)
    (note,) = step_notes(run)
    assert f"stable up to {limit / (1.05 * limit / H):.4g} s" in note
    assert f"oscillates at {1.05 * limit / H:.4g} rad/s" in note
    appeared = float(note.split(" J appeared")[0].split()[-1])
    assert appeared == pytest.approx(run.energy[-1] - run.energy[0], rel=0.01)


@pytest.mark.parametrize("method", ["semi_implicit_euler", "rk4"])
def test_a_run_that_its_steps_let_diverge_says_so_and_what_mends_it(method: str) -> None:
    """That the states have grown is not the reason; an input that is no number is another one."""
    limit = METHODS[method].imaginary_limit
    run, _ = oscillation(method, 1.6 * limit, 0.0, 3000)
    assert run.outcome.kind == "diverged" and run.t[-1] < 3000 * H
    assert f"past the limit of stability of '{method}'" in run.outcome.reason
    assert f"dt below {H / 1.6:.3g} s" in run.outcome.advice, run.outcome
    k = (1.6 * limit / H) ** 2
    broken = sf.simulate(oscillator(), [1.0], t_end=1.0, method=method, dt=H, par=[k, 0.0], u={"x": "sqrt(0.055 - t)"})
    assert broken.outcome.kind == "input failed" and "sqrt" in broken.outcome.reason


@pytest.mark.parametrize("speed", [1.0, 1e-3])
def test_displacements_are_judged_by_how_far_a_motion_comes(speed: float) -> None:
    """To and fro by a millimetre at 1 m/s for 10 s is no way of 10 m; at 1 mm/s the way is the shorter of both."""
    n, reach = 41, 2e-3
    t = np.linspace(0.0, 10.0, n)
    v, nothing = np.full((n, 1), speed), np.zeros((n, 0))
    q = 1e-3 * np.sin(t)[:, np.newaxis]
    run: Any = SimpleNamespace(
        model=SimpleNamespace(difference=lambda a, b: b - a),
        norms=lambda q, u, x: np.abs(x)[:, 0],
        rounding=lambda states: 1e-12,
        fastest=speed,
        reach=reach,
        states=[],
    )
    found = ExaminedRun.change_in_part(run, [t, q + 1e-3, v, nothing], [t, q, v, nothing])
    assert found == pytest.approx(1e-3 / min(reach, 10.0 * speed) / 3.0)


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler"])
def test_feedback_is_part_of_the_spectrum(method: str) -> None:
    """By a formula, and by a Python function."""
    gain = 1e5
    for law in ({"x": f"-{gain}*x - 10*dx"}, lambda t, q, v: -gain * q - 10.0 * v):
        fine = sf.simulate(oscillator(), [1e-3], t_end=0.2, dt=1e-4, u=law, method="rk4")
        assert not step_notes(fine)
        coarse = sf.simulate(oscillator(), [1e-3], t_end=0.2, dt=1e-2, u=law, method=method)
        assert step_notes(coarse) and f"{math.sqrt(gain):.4g} rad/s" in step_notes(coarse)[0]


def test_each_run_of_a_batch_is_judged_by_its_own_parameters() -> None:
    """Springs from slow to past the limit; the notes are those of single runs."""
    z = np.array([0.05, 1.0, 2.9, 3.5])
    par = np.stack([(z / H) ** 2, np.zeros(4)], axis=1)
    many = sf.simulate_batch(oscillator(), [1.0], t_end=100 * H, par=par, dt=H, output=10 * H)
    for i in range(4):
        alone = sf.simulate(oscillator(), [1.0], t_end=100 * H, par=par[i], dt=H, output=10 * H)
        assert [note[:60] for note in many[i].outcome.notes] == [note[:60] for note in alone.outcome.notes]
        assert bool(many.outcome(i).notes) == (z[i] > 0.5)
    assert "past the limit of stability" in many.outcome(3).notes[0] and "steps, first seen in [1]" in str(many)


def energy_notes(run: sf.Trajectory) -> list[str]:
    return [note for note in run.outcome.notes if note.startswith("energy changes by")]


@pytest.mark.parametrize("method", ["implicit_euler", "rk4"])
def test_energy_that_no_force_takes_is_noted(method: str) -> None:
    """A free oscillator must keep its energy; one that a damper or an input moves need not."""
    for z in np.geomspace(1e-3, 1.0, 13):
        k, steps = (z / H) ** 2, 200
        free = sf.simulate(oscillator(), [1.0], [0.0], steps * H, method=method, dt=H, par=[k, 0.0])
        change = np.abs(free.energy / free.energy[0] - 1.0).max()
        if change > 0.1:
            assert energy_notes(free), (z, change)
        elif change < 0.03:
            assert not energy_notes(free), (z, change)
    damped = sf.simulate(oscillator(), [1.0], [0.0], 2.0, method=method, dt=1e-3, par=[100.0, 2.0])
    driven = sf.simulate(oscillator(), [1.0], [0.0], 2.0, method=method, dt=1e-3, par=[100.0, 0.0], u={"x": "3*t"})
    assert not energy_notes(damped) and not energy_notes(driven)


@cache
def two_bars(length: float, size: float, mass: float) -> sf.Model:
    """A double pendulum of the first bar's length; length and mass of the second are relative to the first's."""
    bodies, parent = [], "world"
    for name, extent, m in (("upper", length, 1.0), ("lower", size * length, mass)):
        j = m * extent**2 / 12
        joint = sf.Joint(f"q.{name}", "revolute", parent, "end" if bodies else None, axis=(0, -1, 0))
        bar = sf.Inertia(m, (extent / 2, 0, 0), (j / 100, j, j))
        bodies.append(sf.RigidBody(name, joint, bar, (sf.Frame("end", (extent, 0, 0)),)))
        parent = name
    return sf.compile(sf.System("two_bars", tuple(bodies)))


@pytest.mark.parametrize("step", [0.1, 1.0])
@pytest.mark.parametrize("method", ["rodas4", "rk4", "semi_implicit_euler", "generalized_alpha"])
def test_energy_of_motions_much_faster_than_the_step_is_judged(method: str, step: float) -> None:
    """Their power is that of a moment in which they turn little, however long the step is."""
    starts = (([1.0, 0.0], 1.0), ([1.0, 0.0], 6.3), ([1.0, 0.0], 40.0), ([0.1, 3.0], 0.0))
    for mass, steps, (start, speed) in itertools.product((0.1, 100.0), (3, 10), starts):
        model = two_bars(1.0, 1.0, mass)
        run = sf.simulate(model, start, [0.0, speed], steps * step, method=method, dt=step, adaptive=False)
        if run.outcome.ok and not run.outcome.notes:
            change = np.abs(run.energy - run.energy[0]).max() / run.kinetic_energy.max()
            assert change < 0.1, (speed, change, str(run.outcome))


def pushed(name: str) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    """A reference model with constraints, and a state of motion on them."""
    model = compiled(name)
    first = sf.assemble(model, GUESSES.get(name, model.neutral()), np.linspace(-1.0, 1.0, model.nv))
    return model, first.q, first.v


@cache
def motion_of_bricard() -> sf.Trajectory:
    """Conditions that repeat each other on the constraints alone; to 1e-10."""
    return sf.simulate(*pushed("bricard"), 0.5, method="dop853", rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("gains", [None, (20, 20)])
@pytest.mark.parametrize(
    ("method", "dt", "error"),
    [
        ("rk4", 1e-3, 2e-8),
        ("dopri5", 2e-2, 2e-6),
        ("dop853", 1e-2, 1e-9),
        ("semi_implicit_euler", 5e-3, 1e-2),
    ],
)
def test_loops_kept_by_gains_get_no_note_if_accurate(
    method: str, dt: float, error: float, gains: tuple[float, float] | None
) -> None:
    """What leaves the constraints is no mode of the motion."""
    right, options = motion_of_bricard(), {"adaptive": fixed(method), "stabilisation": "baumgarte", "gains": gains}
    run = sf.simulate(*pushed("bricard"), 0.5, method=method, dt=dt, **options)  # type: ignore[arg-type]
    assert np.abs(run.q[-1] - right.q[-1]).max() < error and np.abs(run.v[-1] - right.v[-1]).max() < error
    assert not run.outcome.notes, run.outcome


@pytest.mark.parametrize(("name", "times"), [("bricard", 1.0), ("four_bar", 1.0), ("sleigh", 2.0)])
@pytest.mark.parametrize("share", [0.9, 1.15])
@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_gains_past_the_limit_of_stability_are_named(name: str, times: float, share: float, method: str) -> None:
    """With alpha = beta they lead back at alpha; conditions on speeds, such as a blade's, at twice that."""
    gain = share * stability_limit(method, math.pi) / 2e-3 / times
    options = {"adaptive": fixed(method), "stabilisation": "baumgarte", "gains": (gain, gain)}
    run = sf.simulate(*pushed(name), 1.0, method=method, dt=2e-3, **options)  # type: ignore[arg-type]
    said = ["back to the constraints by the gains" in note and "smaller gains" in note for note in step_notes(run)]
    assert said == [True] * (share > 1.0), run.outcome
