"""Spin-up of a cantilever on a driven hub (Kane, Ryan & Banerjee 1987) against the exact inextensible rod."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf
from tests.reference.beams import data

REFERENCE = data("spin_up")
LENGTH, EI, RHO_A, END, RATE = 8.0, 566.7095928, 0.20187837656, 15.0, 6.0


def drive(t: float) -> tuple[float, float, float]:
    """Angle of the hub, its rate and second rate."""
    if t >= END:
        return RATE * (t - END / 2), RATE, 0.0
    k = 2 * np.pi / END
    angle = RATE / END * (t**2 / 2 + (np.cos(k * t) - 1.0) / k**2)
    return angle, RATE / END * (t - np.sin(k * t) / k), RATE / END * (1.0 - np.cos(k * t))


def tip(times: list[float], modes: int, **changed: Any) -> np.ndarray:
    """Displacement of the tip (n, 2) along and across the undeformed beam."""
    hub = sf.Joint("hub", "revolute", prescribed=True)
    beam = sf.Beam("b", hub, LENGTH, RHO_A, EI_z=EI, bend_y=modes, family="clamped_free", **changed)
    functions = ("forward_dynamics", "frame_pose")
    m = sf.compile(sf.System("s", [beam], gravity=(0, 0, 0)), sf.Options(functions, ("tip",)))

    def rate(t: float, state: np.ndarray) -> np.ndarray:
        return np.concatenate([state[modes:], m.forward_dynamics(state[:modes], state[modes:], drive(t))])

    run = solve_ivp(rate, (0.0, max(times)), np.zeros(2 * modes), "DOP853", times, rtol=1e-7, atol=1e-9)
    still = np.zeros(3)  # Seen from the hub.
    return m.frame_pose("tip", run.y[:modes].T, u=still)[0][:, :2] - (LENGTH, 0.0)


@pytest.mark.slow
def test_three_functions_follow_the_exact_rod() -> None:
    """Within 2.5 mm, of which 2.1 mm are the second-order model's own and no number of functions removes them."""
    rod = REFERENCE["exact_inextensible_rod"]
    times = sorted({*rod["t"], *np.arange(0.5, 20.01, 0.05).round(2).tolist()})
    found = tip(times, 3)
    chosen = [times.index(t) for t in rod["t"]]
    error = np.abs(found[chosen] - np.stack([rod["tip_x"], rod["tip_y"]], axis=-1)).max(axis=0)
    assert error[0] < 2e-4 and error[1] < 0.0025, error
    known = REFERENCE["foreshortening_model"]["3"]
    assert found[:, 1].min() == pytest.approx(known["peak_y"], abs=1e-5)
    assert found[:, 1].min() == pytest.approx(REFERENCE["peak"]["tip_y"], abs=0.0025)
    # The published tables list the error over the whole run; at the table's own instants it can't be larger.
    assert error[1] < known["max_abs_err_y"] * 1.01


def test_the_tip_diverges_without_foreshortening() -> None:
    (found,) = tip([8.0], 3, foreshortening=False, retain="all")
    assert found[1] < -LENGTH
