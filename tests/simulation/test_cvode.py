"""SUNDIALS' CVODE behind `sf.simulate`."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS


def moving(name: str) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    model = sf.compile(MODELS[name])
    q, v = model.random_state(np.random.default_rng(3))
    return model, q, 0.3 * v


@pytest.mark.parametrize("method", ["cvode", "cvode_adams"])
@pytest.mark.parametrize("name", ["double_pendulum", "heavy_top", "joint_zoo"])
def test_it_follows_its_tolerance(name: str, method: str) -> None:
    model, q, v = moving(name)
    exact = sf.simulate(model, q, v, 1.0, method="dop853", rtol=1e-12, atol=1e-13)
    for tolerance in (1e-6, 1e-9):
        run = sf.simulate(model, q, v, 1.0, method=method, rtol=tolerance, atol=tolerance)
        assert run.outcome.kind == "finished" and run.t[-1] == 1.0
        # Errors add up over some hundred steps, and grow with the motion.
        assert np.abs(model.difference(exact.q[-1], run.q[-1])).max() < 3e3 * tolerance


def test_output_events_and_laws() -> None:
    model = sf.compile(MODELS["pendulum"])
    run = sf.simulate(
        model,
        [1.0],
        t_end=2.0,
        u={"q": "0.1*sin(t)"},
        method="cvode_adams",
        rtol=1e-9,
        atol=1e-10,
        output=0.1,
        events={"down": sf.Event("q", "falling"), "up": sf.Event("q", "rising", terminal=True)},
    )
    same = sf.simulate(
        model,
        [1.0],
        t_end=2.0,
        u={"q": "0.1*sin(t)"},
        method="dop853",
        rtol=1e-11,
        atol=1e-12,
        events={"up": sf.Event("q", "rising", terminal=True)},
    )
    assert [event.name for event in run.events] == ["down", "up"]
    assert run.outcome.kind == "event" and run.outcome.t == pytest.approx(same.outcome.t, abs=1e-7)
    np.testing.assert_allclose(run.t[:-1], 0.1 * np.arange(len(run) - 1), atol=1e-12)
    np.testing.assert_allclose(run["q"], np.interp(run.t, same.t, same["q"]), atol=2e-2)
    np.testing.assert_allclose(run.u[:, 0], 0.1 * np.sin(run.t), atol=1e-15)


def test_a_stiff_model_costs_little() -> None:
    model = sf.compile(MODELS["flyball_governor"])
    start = [0, np.pi / 6, np.pi / 6, 0.5]
    stiff = sf.simulate(model, start, [6.28, 0, 0, 0], 2.0, method="cvode", rtol=1e-6, atol=1e-7)
    plain = sf.simulate(model, start, [6.28, 0, 0, 0], 2.0, method="dopri5", rtol=1e-6, atol=1e-7)
    assert 5 * stiff.statistics.evaluations < plain.statistics.evaluations
    np.testing.assert_allclose(stiff.q[-1], plain.q[-1], atol=1e-4)


def test_constraints_by_gains_only() -> None:
    model = sf.compile(MODELS["slider_crank"])
    closed = sf.assemble(model, [0.3, -0.1, -0.2], [10.0, 0.0, 0.0])
    with pytest.raises(sf.SymofrosError, match="stabilisation='baumgarte'"):
        sf.simulate(model, closed.q, closed.v, method="cvode")
    run = sf.simulate(model, closed.q, closed.v, 1.0, method="cvode", stabilisation="baumgarte", rtol=1e-9, atol=1e-10)
    assert np.abs(model.constraint(run.q)).max() < 1e-6


def test_ends() -> None:
    model = sf.compile(MODELS["pendulum"])

    def call(t, q, v):
        if t > 0.2:
            raise RuntimeError("no more")
        return [0.0]

    run = sf.simulate(model, [1.0], t_end=1.0, u=call, method="cvode_adams")
    assert run.outcome.kind == "input failed" and 0 < run.t[-1] < 0.3
    assert sf.simulate(model, [1.0], t_end=100.0, method="cvode", max_steps=20).outcome.kind == "interrupted"


def test_without_fmpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fmpy.sundials.libraries", None)
    with pytest.raises(sf.SymofrosError, match="CVODE is not at hand"):
        sf.simulate(sf.compile(MODELS["pendulum"]), method="cvode")
