"""Energy along free motion: kept if everything is, nearly kept at first order."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf


def free_motion(retain: str, deflection: float, periods: int) -> tuple[np.ndarray, np.ndarray]:
    """Time in periods of the first mode, and energy relative to its start, of a beam with a tip body on a free hub.

    One function a direction, with frequencies alike, so that the integrator's steps are not those of high modes.
    """
    beam = sf.Beam(
        "b",
        sf.Joint("hub", "revolute", axis=(0, 1, 2)),
        1.0,
        1.0,
        EI_z=1.0,
        EI_y=1.5,
        GJ=0.5,
        rhoJ=0.05,
        bend_y=1,
        bend_z=1,
        twist=1,
        family="polynomial",
        retain=retain,  # type: ignore[arg-type]
    )
    load = sf.RigidBody("load", sf.Joint("weld", "fixed", "b", "tip"), sf.Inertia(0.1, moments=(0.01,) * 3))
    functions = ("forward_dynamics", "kinetic_energy", "potential_energy")
    m = sf.compile(sf.System("s", [beam, load], gravity=(0, 0, 0)), sf.Options(functions))

    def rate(t: float, state: np.ndarray) -> np.ndarray:
        return np.concatenate([state[4:], m.forward_dynamics(state[:4], state[4:], ())])

    start = np.array([0.0, deflection, -deflection, 2 * deflection, 1.0, 0.0, 0.0, 0.0])
    period = 2 * np.pi / 3.516
    times = np.linspace(0.0, periods * period, 40 * periods + 1)
    run = solve_ivp(rate, (0.0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-14)
    energy = m.kinetic_energy(run.y[:4].T, run.y[4:].T) + m.potential_energy(run.y[:4].T)
    return times / period, energy / energy[0] - 1.0


@pytest.mark.parametrize("periods", [10, pytest.param(100, marks=pytest.mark.slow)])
def test_everything_kept_conserves_energy(periods: int) -> None:
    """Over some periods, to what the integrator's tolerance of 1e-12 leaves; over a hundred with --slow."""
    _, error = free_motion("all", 0.1, periods)
    assert np.abs(error).max() < 1e-9


@pytest.mark.slow
def test_first_order_errs_by_the_square_of_the_deflection_and_does_not_drift() -> None:
    time, error = free_motion("first_order", 0.05, 20)
    early, late = (np.abs(error[part]).max() for part in (time < 10, time >= 10))
    assert 1e-7 < early < 0.01
    assert late < 1.5 * early
    _, smaller = free_motion("first_order", 0.025, 10)
    assert np.log2(early / np.abs(smaller).max()) > 1.9
