"""Settings of runs: what a run does not start from."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf


@pytest.fixture(scope="module")
def top() -> sf.Model:
    spin = sf.Joint("spin", "free")
    return sf.compile(sf.System("top", (sf.RigidBody("top", spin, sf.Inertia(1.0, (0, 0, 0), (1, 2, 3))),)))


@pytest.mark.parametrize("length", [0.0, 0.998, 1.002])
def test_invalid_quaternions_are_refused(top: sf.Model, length: float) -> None:
    q = top.neutral()
    q[3:] *= length
    with pytest.raises(sf.ShapeError, match=f"length {length:g}"):
        sf.simulate(top, q, t_end=0.1)
    with pytest.raises(sf.ShapeError, match=f"length {length:g}"):
        sf.simulate_batch(top, t_end=0.1, q0=np.stack([top.neutral(), q]))


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        *(("t", "t_end"), ("T", "t_end"), ("duration", "t_end"), ("tmax", "t_end"), ("t_ends", "t_end")),
        *(("step", "dt"), ("solver", "method"), ("x0", "q0"), ("params", "par"), ("inputs", "u"), ("metod", "method")),
        *(("z", "z0"), ("states", "z0")),
    ],
)
def test_option_names_of_other_tools_are_answered_with_ours(top: sf.Model, written: str, meant: str) -> None:
    for simulate in (sf.simulate, sf.simulate_batch):
        with pytest.raises(sf.UnknownNameError, match=f"no option '{written}'(.|\n)*did you mean '{meant}'"):
            simulate(top, **{written: 1.0})


@pytest.mark.parametrize(("t0", "t_end", "parts"), [(0.0, 0.35, 350), (0.0, 0.7, 7), (0.1, 1.0, 9), (-0.3, 0.6, 3)])
@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("step", [1e-2, 1e-5])
def test_an_interval_that_divides_the_run_records_its_end(
    top: sf.Model, t0: float, t_end: float, parts: int, method: str, step: float
) -> None:
    """However short steps are: rounding may put the last of the times behind the end."""
    run = sf.simulate(top, t0=t0, t_end=t_end, output=(t_end - t0) / parts, method=method, dt=step, max_step=step)
    assert len(run.t) == parts + 1 and run.t[-1] == t_end
    assert np.allclose(np.diff(run.t), (t_end - t0) / parts, rtol=1e-9)


@pytest.mark.parametrize("output", [[0.2, 0.1], [0.2, 0.2], [-0.1, 0.2], [0.5, 1.5], [[0.1]], [], [np.nan]])
def test_output_times_are_within_the_run_and_increase(top: sf.Model, output: list[float]) -> None:
    with pytest.raises(sf.ShapeError, match="output times do not fit"):
        sf.simulate(top, t_end=1.0, dt=0.1, output=output)
    assert sf.simulate(top, t_end=1.0, dt=0.1, output=[0.0, 0.3, 1.0]).t.tolist() == [0.0, 0.3, 1.0]


def test_fixed_steps_are_no_longer_than_stated(top: sf.Model) -> None:
    """They were dt long whatever `max_step` said."""
    options: list[dict[str, Any]] = [{}, {"method": "dopri5", "adaptive": False}]
    for given in options:
        with pytest.raises(sf.SymofrosError, match="longer than max_step\n  found:  dt = 0.001, max_step = 0.0001"):
            sf.simulate(top, t_end=0.01, max_step=1e-4, **given)
    assert sf.simulate(top, t_end=0.01, max_step=1e-3).outcome.ok


@pytest.mark.parametrize("given", [{"rtol": 1e-9}, {"atol": 1e-12}, {"rtol": 1e-8, "atol": 1e-11}])
@pytest.mark.parametrize("method", [{}, {"method": "generalized_alpha"}, {"method": "dopri5", "adaptive": False}])
def test_bounds_of_errors_are_refused_where_steps_are_fixed(
    top: sf.Model, method: dict[str, Any], given: dict[str, Any]
) -> None:
    """They did nothing, in silence."""
    ways = (sf.simulate, sf.Stepper, lambda model, **options: sf.Steppers(model, 2, **options), sf.simulate_batch)
    for way in ways[: 2 if method.get("method") == "generalized_alpha" else 4]:
        with pytest.raises(sf.SymofrosError, match="an option of adaptive steps, '[ra]tol'(.|\n)*estimate no error"):
            way(top, **method, **given)
    assert sf.simulate(top, t_end=0.01, method="dopri5", **given).outcome.ok


def test_records_after_so_many_steps_are_refused_beside_times(top: sf.Model) -> None:
    with pytest.raises(sf.SymofrosError, match="an option of runs without `output`, 'every'"):
        sf.simulate(top, t_end=0.1, every=10, output=0.05)


@pytest.mark.parametrize("method", ["cvode", "ida"])
def test_sundials_keeps_no_pace(top: sf.Model, method: str) -> None:
    """It ran as fast as it could, whatever pace was asked for."""
    with pytest.raises(sf.SymofrosError, match=f"'{method}' keeps no pace against the clock"):
        sf.simulate(top, t_end=0.01, method=method, realtime=True)
