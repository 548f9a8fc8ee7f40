"""sf.simulate against closed forms and SciPy: inputs, outputs, events, constraints, ends."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

import symofros as sf
from reference_models import MODELS
from reference_models.closed.four_bars import n_four_bar
from tests.models import compiled


@pytest.fixture(scope="module")
def pendulum() -> sf.Model:
    return compiled("pendulum")


@pytest.fixture(scope="module")
def cart_pole() -> sf.Model:
    return compiled("cart_pole")


@pytest.fixture(scope="module")
def four_bar() -> sf.Model:
    return compiled("four_bar")


def moving_four_bar(model: sf.Model) -> tuple[np.ndarray, np.ndarray]:
    q, v = model.random_state(np.random.default_rng(3))
    assembled = sf.assemble(model, q, 0.3 * v)
    return assembled.q, assembled.v


def test_the_period_of_a_pendulum_matches_theory(pendulum: sf.Model) -> None:
    amplitude, low = 1.2, {"low": sf.Event("q", terminal=True)}
    # A quarter of the period: from rest at the amplitude to the lowest point.
    run = sf.simulate(pendulum, [amplitude], [0.0], 10.0, method="dop853", rtol=1e-12, atol=1e-12, events=low)
    small = sf.modes(pendulum, [0.0], [0.0], [0.0]).frequencies[0]
    quarter = ellipk(np.sin(amplitude / 2) ** 2) / small
    assert run.outcome.kind == "event"
    assert run.outcome.t == pytest.approx(quarter, rel=1e-9)
    assert run.t[-1] == run.outcome.t and abs(run.q[-1, 0]) < 1e-11


class TestInputs:
    def test_signals_interpolate_and_hold_their_ends(self, cart_pole: sf.Model) -> None:
        name = cart_pole.names.u[0]
        signal = sf.Signal([0.1, 0.2, 0.3], [1.0, 3.0, 2.0])
        run = sf.simulate(cart_pole, t_end=0.4, u={name: signal}, dt=0.01)
        np.testing.assert_allclose(run[name], np.interp(run.t, signal.t, signal.values), atol=1e-12)
        held = sf.simulate(cart_pole, t_end=0.4, u={name: sf.Signal([0.1, 0.2], [1.0, 3.0], "hold")}, dt=0.05)
        np.testing.assert_array_equal(held[name][[0, 3, 5]], [1.0, 1.0, 3.0])

    def test_rates_of_a_prescribed_motion_follow_from_its_formula(self) -> None:
        """A hub that is driven by a formula: its rates come by themselves, and as if they were given."""
        hub = sf.RigidBody(
            "hub", sf.Joint("turn", "revolute", axis=(0, 1, 0), prescribed=True), frames=[sf.Frame("end", (1, 0, 0))]
        )
        bar = sf.RigidBody(
            "bar", sf.Joint("q", "revolute", "hub", "end", axis=(0, 1, 0)), sf.Inertia(1.0, (0.5, 0, 0), (0, 0.1, 0.1))
        )
        model = sf.compile(sf.System("driven", [hub, bar]))
        alone = sf.simulate(model, t_end=0.5, u={"turn": "sin(3*t)^2"})
        stated = {"turn": "sin(3*t)^2", "dturn": "3*sin(6*t)", "ddturn": "18*cos(6*t)"}
        np.testing.assert_allclose(alone.q, sf.simulate(model, t_end=0.5, u=stated).q, atol=1e-12)
        np.testing.assert_allclose(alone["dturn"], 3 * np.sin(6 * alone.t), atol=1e-13)
        with pytest.raises(sf.UnknownNameError, match="without its speeds"):
            sf.simulate(model, u={"turn": sf.Signal([0, 1], [0, 1])})
        with pytest.raises(sf.DescriptionError, match="depends on 'q'"):
            sf.simulate(model, u={"turn": "q"})


class TestOutput:
    def test_energy_and_acceleration_are_recorded(self, four_bar: sf.Model) -> None:
        run = sf.simulate(four_bar, *moving_four_bar(four_bar), 1.0)
        np.testing.assert_allclose(run.energy, run.energy[0], atol=1e-9 * abs(run.energy[0]) + 1e-9)
        np.testing.assert_allclose(run.a, four_bar.forward_dynamics(run.q, run.v, run.u), atol=1e-12)
        assert run.lam.shape == (len(run), four_bar.nc)
        p, R = run.frames[four_bar.names.frames[-1]]
        assert p.shape == (len(run), 3) and R.shape == (len(run), 3, 3)


class TestConstraints:
    def test_projection_keeps_constraints_and_without_it_they_drift(self) -> None:
        """A crank that turns five times: left to accelerations alone, phi drifts as h^4."""
        model = compiled("slider_crank")
        turning = sf.assemble(model, [0.3, -0.1, -0.2], [10.0, 0.0, 0.0])

        def worst(kind, dt: float) -> float:
            run = sf.simulate(model, turning.q, turning.v, 10.0, dt=dt, stabilisation=kind)
            return float(np.abs(model.constraint(run.q)).max())

        drift = worst("none", 0.01)
        assert worst("projection", 0.01) < 1e-12 < worst("baumgarte", 0.01) < drift
        assert np.log2(drift / worst("none", 0.005)) == pytest.approx(4.0, abs=0.2)

    def test_a_first_state_off_the_constraints_is_refused(self) -> None:
        model = compiled("slider_crank")
        turning = sf.assemble(model, [0.3, -0.1, -0.2], [10.0, 0.0, 0.0])
        q, v = turning.q, turning.v
        for start in ((q + [0.1, 0, 0], v), (q, v + [0.1, 0, 0])):
            with pytest.raises(sf.AssemblyError, match="the first state does not keep"):
                sf.simulate(model, *start)
        pulled = sf.simulate(model, q + [1e-3, 0, 0], v, 2.0, stabilisation="baumgarte")
        assert np.abs(model.constraint(pulled.q[-1])).max() < 1e-8


class TestEnds:
    def test_divergence_is_an_outcome(self, pendulum: sf.Model) -> None:
        run = sf.simulate(pendulum, [1.0], [1e200], 1.0, method="euler", u={"q": "1e300*q*q"}, dt=0.1)
        assert run.outcome.kind == "diverged" and not run.outcome.ok
        assert "smaller dt" in run.outcome.advice and np.all(np.isfinite(run.q))

    def test_divergence_is_reported_for_models_with_stepping_functions_only(self) -> None:
        arm = sf.RigidBody("arm", sf.Joint("q", "revolute", actuated=True), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
        model = sf.compile(sf.System("alone", (arm,)), sf.Options(("forward_dynamics",)))
        run = sf.simulate(model, [1.0], [1e200], 1.0, method="euler", u={"q": "1e300*q*q"}, dt=0.1)
        assert run.outcome.kind == "diverged"

    @pytest.mark.parametrize("method", ["rk4", "dopri5", "dop853", "rodas4"])
    def test_a_model_without_speeds_comes_to_its_end(self, method: str) -> None:
        arm = sf.RigidBody("arm", sf.Joint("q", "revolute", prescribed=True), sf.Inertia(1.0, (1, 0, 0), (1, 1, 1)))
        run = sf.simulate(sf.compile(sf.System("given", (arm,))), t_end=0.1, u={"q": "t"}, method=method, output=0.05)
        assert run.outcome.ok and run.t[-1] == pytest.approx(0.1) and run["q"][-1] == pytest.approx(0.1)

    def test_a_massless_speed_is_named(self) -> None:
        """Massless by a parameter, which compilation can't know; and light, which is no fault.

        By articulated bodies the mass of a point cancels, and what is found is the limit of less and less of it.
        """
        first = sf.RigidBody(
            "first",
            sf.Joint("a", "revolute", axis=(0, 1, 0)),
            sf.Inertia(1.0, (0, 0, -1.0)),
            (sf.Frame("end", (0, 0, -1.0)),),
        )
        joint = sf.Joint("b", "revolute", "first", "end", axis=(0, 1, 0))
        last = sf.RigidBody("last", joint, sf.Inertia(sf.formula("m", "mass"), (0, 0, -1.0)))
        system = sf.System("light", (first, last), parameters=(sf.Parameter("m", 1.0),))
        model, other = (
            sf.compile(system, sf.Options(forward_dynamics=way)).with_parameter_checks(False)
            for way in ("factors", "articulated")
        )
        run = sf.simulate(model.with_parameters(m=0.0), [0.1, 0.2], t_end=0.1)
        assert run.outcome.kind == "singular" and "moves no mass" in run.outcome.reason and run.outcome.t == 0.0
        light = sf.simulate(model.with_parameters(m=1e-9), [0.1, 0.2], t_end=0.1)
        limit = sf.simulate(other.with_parameters(m=0.0), [0.1, 0.2], t_end=0.1)
        assert light.outcome.ok and limit.outcome.ok
        np.testing.assert_allclose(limit.q[-1], light.q[-1], rtol=1e-7)

    def test_an_unbounded_jump_diverges(self, pendulum: sf.Model) -> None:
        run = sf.simulate(pendulum, [0.1], [0.0], 1.0, method="dopri5", u={"q": "1/(0.5 - t)^2"}, rtol=1e-9)
        assert run.outcome.kind in ("step too small", "diverged")
        assert run.t[-1] == pytest.approx(0.5, abs=1e-2)

    def test_real_time_pace_is_kept(self, pendulum: sf.Model) -> None:
        run = sf.simulate(pendulum, [0.1], t_end=0.2, dt=0.01, realtime=True)
        assert run.statistics.seconds > 0.18
        # It sleeps between steps.
        assert 0.0 < run.statistics.worked < 0.5 * run.statistics.seconds
        assert run.statistics.late_steps <= 20

    @pytest.mark.parametrize(
        ("settings", "words"),
        [
            ({"method": "rk5"}, "no method 'rk5'"),
            ({"dt": 0.0}, "step is not positive"),
            ({"t_end": -1.0}, "no span of time"),
            ({"method": "rk4", "adaptive": True}, "does not adapt"),
            ({"every": 0}, "nothing would be recorded"),
            ({"output": [0.5, 0.2]}, "output times"),
            ({"q0": [np.nan]}, "not finite"),
            ({"stabilisation": "hope"}, "stabilisation is not one of"),
            ({"method": "rodas4", "u": lambda t, q, v: [0.0]}, "derivatives of the inputs"),
        ],
    )
    def test_invalid_settings_are_refused(self, pendulum: sf.Model, settings, words: str) -> None:
        with pytest.raises(sf.SymofrosError, match=words):
            sf.simulate(pendulum, **settings)

    def test_an_interpreted_model_is_refused(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = sf.compile(MODELS["pendulum"], sf.Options(backend="interpreter"))
        with pytest.raises(sf.SymofrosError, match="interpreted model"):
            sf.simulate(model)


CTRL_C = Path(__file__).with_name("ctrl_c.py.in").read_text()


def test_ctrl_c_interrupts_a_run() -> None:
    """The signal reaches Python between two spells of C, within a tenth of a second or so."""
    with subprocess.Popen([sys.executable, "-c", CTRL_C], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None and child.stdout.readline() == "moving\n"
        child.send_signal(signal.SIGINT)
        assert child.communicate(timeout=60)[0] == "interrupted True True\n"


class TestStructure:
    def test_variational_keeps_energy_and_rk4_does_not(self) -> None:
        """Over 2000 periods: bounded against drifting."""
        model = compiled("double_pendulum")
        spans = {}
        for method in ("variational", "rk4"):
            run = sf.simulate(model, [0.6, 0.3], [0.0, 0.0], 400.0, method=method, dt=0.02, every=10)
            off = np.abs(run.energy - run.energy[0])
            half = len(off) // 2
            spans[method] = (off[:half].max(), off[half:].max())
        early, late = spans["variational"]
        assert late < 1.2 * early
        early, late = spans["rk4"]
        assert late > 1.5 * early


@pytest.mark.parametrize("t0", [0.0, 100.0])
def test_a_passage_within_a_step_is_dated_to_a_sixteenth_of_it(t0: float) -> None:
    model = sf.compile(n_four_bar(1))
    upright = np.array([1.0 if name.startswith("crank") else -1.0 for name in model.names.q])
    run = sf.simulate(model, np.pi / 2 * upright, -upright, t0 + 1.0, t0=t0, dt=0.05)
    (when,) = (
        float(found[1]) for note in run.outcome.notes if (found := re.search(r"posture at t = ([\d.]+) s", note))
    )
    assert abs(when - t0 - 0.70845) < 0.05 / 16 + 1e-3 * (t0 > 0)
    assert not sf.simulate(model, np.pi / 2 * upright, -upright, t0 + 0.3, t0=t0, dt=2e-3).outcome.notes


def test_progress_is_passed_to_a_function(pendulum: sf.Model) -> None:
    reported: list[float] = []
    sf.simulate(pendulum, [0.5], t_end=2.0, dt=1e-4, progress=reported.append)
    assert reported == sorted(reported) and reported[-1] == pytest.approx(2.0)


def test_a_short_run_takes_few_calls_around_its_steps() -> None:
    """Python's part of a small run, its judgement included, counted in calls of functions: 3174 once."""
    model = compiled("double_pendulum")

    def run() -> None:
        assert sf.simulate(model, [0.3, -0.4], method="dopri5").outcome.ok

    run()  # What is made once.
    calls = 0

    def count(_frame: Any, event: str, _argument: Any) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        run()
    finally:
        sys.setprofile(None)
    assert calls < 1300
