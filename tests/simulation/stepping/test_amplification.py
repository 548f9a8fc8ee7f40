"""What one step makes of a mode, against steps that are made."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.stepping.amplification import SPECTRAL_RADIUS
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.resolution import Pull, pull_rates, resolution
from symofros.simulation.stepping.stepper import Stepper
from tests.simulation.oscillator import oscillator

GAIN = st.floats(0.1, 100.0)


@given(st.lists(st.tuples(GAIN, GAIN, st.booleans()), min_size=1, max_size=3))
def test_gains_lead_back_at_the_roots_of_their_equation(constraints: list[tuple[float, float, bool]]) -> None:
    """z^2 + 2 alpha z + beta^2 = 0, one of each pair; of conditions on speeds z + 2 alpha = 0."""
    alphas, betas, on_speeds = (list(column) for column in zip(*constraints, strict=True))
    rates = pull_rates(np.array([*alphas, *betas]), on_speeds)
    expected = np.concatenate(
        [[-2.0 * a] if on_speed else np.roots([1.0, 2.0 * a, b * b]) for a, b, on_speed in constraints]
    )
    expected = expected[np.imag(expected) >= 0.0]
    assert all(np.abs(np.array(rates) - z).min() <= 1e-6 * abs(z) for z in expected)
    assert all(np.abs(expected - z).min() <= 1e-6 * abs(z) for z in rates)


@pytest.mark.parametrize(
    ("rate", "share", "amplified"), [(-400.0, 0.5, True), (-50.0, 0.5, False), (-400.0, 0.0, True)]
)
def test_a_way_back_to_constraints_that_steps_amplify_is_the_mode(rate: float, share: float, amplified: bool) -> None:
    """Of h z = -4 Runge-Kutta steps make five times as much, whatever its share; of -0.5 they make less."""
    pull = Pull((complex(rate),), share, 2.0)
    mode = resolution(METHODS["rk4"], 0.01, 1000, [0.0], lambda _: None, [1.0], np.eye(1)[None], pull).worst
    assert (mode is not None) == amplified
    if mode is not None:
        assert (mode.rate, mode.t, mode.of_gains, mode.amplified) == (rate, 2.0, True, True)
        assert mode.factor == pytest.approx(5.0) and mode.error > 1.0


JUDGED = tuple(name for name, method in METHODS.items() if method.family.judged)


@pytest.mark.parametrize("name", JUDGED)
def test_the_factor_errs_by_the_order_of_the_method(name: str) -> None:
    method, sizes = METHODS[name], (0.4, 0.2)  # Smaller ones leave an order of eight to rounding.
    for direction in (1j, -1.0):
        errors = [abs(method.amplification(r * direction) - cmath.exp(r * direction)) for r in sizes]
        assert math.log2(errors[0] / errors[1]) > method.order + 0.5


def test_limits_of_stability_match_the_literature() -> None:
    """Hairer and Wanner II, IV.2: of Runge-Kutta methods; of semi-implicit Euler h omega = 2."""
    limits = {name: (METHODS[name].real_limit, METHODS[name].imaginary_limit) for name in JUDGED}
    assert limits["euler"] == pytest.approx((2.0, 0.0), abs=1e-8)
    assert limits["semi_implicit_euler"] == pytest.approx((2.0, 2.0), abs=1e-8)
    assert limits["rk4"] == pytest.approx((2.785294, 2.0 * math.sqrt(2.0)), abs=1e-6)
    assert limits["dopri5"][0] == pytest.approx(3.3066, abs=1e-4)
    for name in ("implicit_euler", "rodas4", "generalized_alpha", "variational"):
        assert limits[name] == (math.inf, math.inf)


def test_the_spectral_radius_equals_the_integrators_own() -> None:
    model = oscillator()
    stepper = Stepper(model, METHODS["generalized_alpha"], plan_inputs(model, None), (), model.parameter_values)
    assert stepper.run.spectral_radius == SPECTRAL_RADIUS


def test_beyond_the_stability_limit_the_semi_implicit_euler_factor_is_the_growing_one() -> None:
    """Both factors are real there: the larger one is what the steps grow by."""
    h_omega = 2.2
    factor = METHODS["semi_implicit_euler"].amplification(1j * h_omega)
    run = sf.simulate(oscillator(), [1.0], t_end=60.0, dt=1.0, par=[h_omega**2, 0.0], method="semi_implicit_euler")
    assert factor == pytest.approx(run.q[-1, 0] / run.q[-2, 0], rel=1e-9) and abs(factor) > 2.0
