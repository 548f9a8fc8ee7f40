"""Formulas for what a beam's approximations cost, against benchmark numbers and each other."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symofros.studio.advice import estimators
from symofros.studio.advice.estimators import tip_response

# Derived independently: residual vibration over the quasi-static deflection after a load A (1 - cos(2 pi t/T)),
# simulated (G2 of the project's benchmarks), by the number of periods r.
RESIDUALS = (
    (0.5, 2.666666666666514),
    (1.5, 1.6000000000002037),
    (2.5, 0.3809523809523765),
    (3.3, 0.16360303222802622),
    (5.5, 0.06837606837579716),
    (9.07, 0.005368695245664276),
    (14.2, 0.0058591033797724835),
    (20.5, 0.004770423371387735),
)
# Largest spin and load for a shift of the first frequency (G3): tolerance, eta on no hub, eta on a hub of one length,
# gamma, P L^2 / EI.
THRESHOLDS = (
    (0.001, 0.1439409321082294, 0.09457576753386662, 0.01573942961568135, 0.005319687179130577),
    (0.01, 0.45518119398966717, 0.2990748368656243, 0.1573942961568135, 0.05319687179130577),
    (0.05, 1.0178160918404144, 0.6687516655911961, 0.7869714807840674, 0.26598435895652883),
)


def test_residual_vibration_estimates_match_simulation() -> None:
    """Smooth, too, where the load meets the mode; its bound lets a beam be rigid."""
    for r, simulated in RESIDUALS:  # Integrated to about 1e-9 of the amplitude by the benchmark.
        assert estimators.residual(r) == pytest.approx(simulated, rel=1e-6, abs=1e-9)
        assert estimators.residual(r) <= estimators.residual_bound(r) * (1 + 1e-12)
    assert estimators.residual(1.0) == pytest.approx(estimators.residual(1.0 + 1e-5), rel=1e-4)
    for r, share in ((4.58, 0.1), (14.2, 0.01), (44.7, 0.001)):
        assert estimators.residual_bound(r) == pytest.approx(share, rel=1e-2)  # r has three digits.


@pytest.mark.parametrize(("tolerance", "eta", "eta_hub", "gamma", "load"), THRESHOLDS)
def test_stiffening_estimates_match_the_benchmark_thresholds(
    tolerance: float, eta: float, eta_hub: float, gamma: float, load: float
) -> None:
    found = (
        estimators.stiffening(eta),
        estimators.stiffening(eta_hub, eta_hub**2),
        estimators.stiffening(0.0, gamma),
        estimators.stiffening(0.0, 0.0, load),
    )
    # The benchmark's square of the first frequency is 1.4e-9 off the root of cos x cosh x = -1.
    assert found == pytest.approx([tolerance] * 4, rel=2e-9)


def test_critical_speed_is_the_first_frequency() -> None:
    """A2: without foreshortening a beam diverges at eta = 3.516; the spin-up's 6 rad/s is twice that."""
    assert estimators.critical_ratio(3.51601526850015) == pytest.approx(1.0, rel=1e-10)
    eta = 6.0 * math.sqrt(0.20187837656 * 8.0**4 / 566.7095928)
    # The benchmark's critical speed of this very beam [rad/s].
    assert estimators.critical_ratio(eta) == pytest.approx(6.0 / 2.910758394396504, rel=1e-8)


def test_static_deflections_match_formulas() -> None:
    """G3: 11 rhoA alpha L^5 / 120 EI, rhoA g L^4 / 8 EI, P L^3 / 3 EI."""
    rhoA, EI, L = 0.7, 90.0, 1.3
    turned, _ = estimators.deflection(rhoA, EI, L, 0.0, 2.0, 0.0, 0.0)
    weighed, slope = estimators.deflection(rhoA, EI, L, 9.81, 0.0, 0.0, 0.0)
    carried, _ = estimators.deflection(0.0, EI, L, 0.0, 0.0, 2.0 * 9.81, 0.0)
    turned_tip, turn = estimators.deflection(0.0, EI, L, 0.0, 0.0, 0.0, 5.0)
    assert turned == pytest.approx(11 * rhoA * 2.0 * L**5 / (120 * EI))
    assert weighed == pytest.approx(rhoA * 9.81 * L**4 / (8 * EI)) and slope == pytest.approx(weighed * 4 / 3 / L)
    assert turned_tip == pytest.approx(5.0 * L**2 / (2 * EI)) and turn == pytest.approx(5.0 * L / EI)
    assert carried == pytest.approx(2.0 * 9.81 * L**3 / (3 * EI))


@pytest.mark.parametrize("load", ["uniform", "rising", "force", "moment"])
def test_functions_converge_to_the_static_shape(load: estimators.Load) -> None:
    exact = tip_response(load)
    assert tip_response(load, 4) == pytest.approx(exact, rel=1e-12)  # x^5 is the highest power that a load asks for.
    errors = [np.abs(np.subtract(tip_response(load, n, True), exact)) for n in range(1, 7)]
    assert all(errors[n].max() < errors[n - 1].max() for n in range(1, 6))
    # Six modes: a moment's slope lacks 7 %, as modes have no moment at their tip; a spread load's nothing to speak of.
    assert errors[5].max() < {"uniform": 1e-4, "rising": 1e-5, "force": 2e-3, "moment": 0.07}[load]


def test_the_period_of_a_load_is_estimated() -> None:
    t = np.linspace(0.0, 2.5, 4001)
    load = 3.0 * (1 - np.cos(2 * np.pi * t / 2.5))
    assert estimators.characteristic_period(load, float(t[1])) == pytest.approx(2.5, rel=1e-3)
    assert math.isinf(estimators.characteristic_period(np.full(50, 9.81), 0.1))


def test_frequencies_with_light_and_heavy_tips_match_limits() -> None:
    """Dunkerley's bound meets both limits, and Rayleigh's 33/140 of the beam's mass between them within two percent."""
    assert estimators.first_frequency(1.0, 1.0, 1.0, 0.0) == pytest.approx(3.51601526850015)
    for mass in (0.5, 5.0):
        rayleigh = math.sqrt(3.0 / (mass + 33 / 140))
        assert estimators.first_frequency(1.0, 1.0, 1.0, mass) == pytest.approx(rayleigh, rel=0.02)
