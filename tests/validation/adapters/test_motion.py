"""Engines through time with their own solvers: what the atlas runs, on motions that are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from validation.adapters.exudyn.motion import bars
from validation.adapters.mujoco.motion import move
from validation.stability.closed_loops import four_bars
from validation.stability.rigid.energy import MJCF


def exudyn_row(loops: int, h: float, t_end: float) -> np.ndarray | None:
    hinges = [(i, 1.0, loops + 1 + i, 0.0) for i in range(loops)]
    hinges += [(loops + 1 + i, 1.0, i + 1, 1.0) for i in range(loops)]
    return bars(four_bars.links(loops), hinges, range(loops + 1), h, t_end, 0.9)


def test_exudyn_converges_to_the_exact_row_of_four_bars() -> None:
    errors = []
    for h in (4e-3, 2e-3):
        ends = exudyn_row(2, h, 0.4)
        assert ends is not None and ends.shape == (5, 2)
        errors.append(four_bars.tip_error(2, 0.4, ends[0]))
    # Generalised-alpha is of second order.
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.5) and errors[1] < 1e-5


def test_exudyn_carries_all_bars_along() -> None:
    ends = exudyn_row(1, 1e-3, 0.3)
    assert ends is not None
    first, second, coupler = ends
    np.testing.assert_allclose(second, first + [1.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(coupler, second, atol=1e-9)


def test_mujoco_conserves_the_energy_of_a_pendulum_by_rk4_alone() -> None:
    swings = {name: move(MJCF.format(h=1e-3, name=name), np.zeros(1), np.zeros(1), 2.0) for name in ("RK4", "Euler")}
    assert np.ptp(swings["RK4"].energy) < 1e-9 < 1e-3 < np.ptp(swings["Euler"].energy)
    assert swings["RK4"].violation == 0.0 and swings["RK4"].warning == "" and len(swings["RK4"].energy) == 201


@pytest.mark.parametrize("stated_at", [np.pi / 2, 0.0])
def test_mujoco_starts_from_the_same_posture_wherever_it_is_stated(stated_at: float) -> None:
    m = four_bars.linkage(1)
    q, v = four_bars.state(m, *four_bars.START)
    text = four_bars.mjcf(1, "RK4", 1e-3, "0.002 1", "0.9999 0.9999 0.001", stated_at)
    run = move(text, q - four_bars.state(m, stated_at, 0.0)[0], v, 0.5)
    angle = stated_at + run.q[0]
    assert run.violation < 1e-6
    assert four_bars.tip_error(1, 0.5, np.array([np.cos(angle), np.sin(angle)])) < 1e-6


def test_a_failed_mujoco_run_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And writes no log into the working directory."""
    monkeypatch.chdir(tmp_path)
    text = '<mujoco><option timestep="0.1"/><worldbody><body><joint type="hinge" stiffness="-1e9"/>'
    text += '<inertial pos="1 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>'
    assert move(text, np.ones(1), np.zeros(1), 10.0).warning
    assert not list(tmp_path.iterdir())
