"""Instants of formulas of time: where they bend, jump or change fast."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.expr.instants import InstantKind
from symofros.generator.codegen import interpreted
from symofros.runtime.calls.binding import constants
from symofros.runtime.instants import find_instants
from tests.models import compiled


@pytest.fixture(scope="module")
def model() -> sf.Model:
    return compiled("cart_pole")


def instants(model: sf.Model, formula: str, t_end: float = 10.0) -> np.ndarray:
    return model.formula_instants([formula], model.parameter_values, 0.0, t_end)


@pytest.mark.parametrize("width", [2.0, 1e-2, 1e-4, 1e-6])
def test_corners_of_pulses_of_any_width_are_found(model: sf.Model, width: float) -> None:
    for at in np.random.default_rng(0).uniform(2.5, 7.5, 10):
        corners = [at - width, at + width]
        tent = instants(model, f"max(0, 1 - abs(t - {at})/{width})")
        parabola = instants(model, f"max(0, 1 - (t - {at})^2/{width}^2)")
        plateau = instants(model, f"sign(t - {corners[0]}) - sign(t - {corners[1]})")
        for found, wanted in ((tent, [at, *corners]), (parabola, corners), (plateau, corners)):
            nearest = np.abs(found[:, np.newaxis] - wanted).min(axis=0)
            assert nearest.max() <= 1e-7 * width + 1e-14 * at


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("formula", ["exp(-((t - 4.2)/{})^2)", "1 - tanh((t - 4.2)/{})^2", "1/(1 + ((t - 4.2)/{})^2)"])
def test_narrow_pulses_are_bracketed(model: sf.Model, formula: str, width: float) -> None:
    found = instants(model, formula.format(width))
    assert 8 <= len(found) <= 12 and np.abs(found - 4.2).min() < 1e-3 * width
    gaps = np.diff(found)
    assert 0.4 * width < gaps.min() <= width and found[0] < 4.2 - 7 * width and found[-1] > 4.2 + 7 * width


@pytest.mark.parametrize("width", [1e-1, 1e-3])
@pytest.mark.parametrize(
    "formula", ["exp(-({0} + 0.3*{0}^2)^2)", "exp(-({0} + exp({0})/8)^2)", "1/(1 + ({0} + {0}^4)^2)"]
)
def test_instants_of_a_formula_that_runs_backwards_are_mirrored(model: sf.Model, formula: str, width: float) -> None:
    """Narrow parts that are steeper on one side."""
    forth, back = (instants(model, formula.format(f"({sign}*(t - 5)/{width})")) for sign in ("1", "-1"))
    assert len(forth) >= 8
    np.testing.assert_allclose(np.sort(10.0 - back), forth, rtol=0, atol=1e-6 * width)


def test_every_kink_of_a_wave_is_found(model: sf.Model) -> None:
    found = instants(model, "abs(sin(20*t))")
    zeros = np.arange(1, 64) * np.pi / 20
    assert np.abs(found[found > 0.1][:, np.newaxis] - zeros).min(axis=0).max() < 1e-12
    assert len(instants(model, "cos(t)*max(0, sin(t))")) == 4  # One of them just after the start.


def test_parameters_shift_instants_and_state_factors_do_not() -> None:
    parameter = sf.Parameter("late", 3.0)
    slide = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True)
    body = sf.RigidBody("b", slide, sf.Inertia(1.0, moments=(1, 1, 1)))
    cart = sf.compile(sf.System("cart", (body,), parameters=(parameter,)))
    law = "x*max(0, t - late)"
    assert cart.formula_instants([law], np.array([3.0]), 0.0, 10.0) == pytest.approx([3.0])
    assert cart.formula_instants([law], np.array([7.0]), 0.0, 10.0) == pytest.approx([7.0])
    assert len(cart.formula_instants([law], np.array([7.0]), 0.0, 5.0)) == 0


def test_instant_kinds_match_the_header() -> None:
    assert {kind.name: kind.value for kind in InstantKind} == {
        kind.name: constants()[f"SYM_INSTANT_{kind.name}"] for kind in InstantKind
    }


def test_operands_of_a_description_are_a_function_of_its_model() -> None:
    """Inner ones first, each once; parameters move them."""
    load = sf.Load(force=("max(0, 1 - abs(t - late)) + abs(t - late)", "exp(-t*late)", "1/(late - t) + abs(x)*sin(t)"))
    slide = sf.Joint("x", "prismatic", axis=(1, 0, 0))
    body = sf.RigidBody("b", slide, sf.Inertia(1.0, moments=(1, 1, 1)), loads=(load,))
    system = sf.System("cart", (body,), parameters=(sf.Parameter("late", 3.0),))
    for backend in ("interpreter", "c"):
        model = sf.compile(system, sf.Options(functions=("instant_operands",), backend=backend))
        operands, kinds = model.evaluate("instant_operands", t=2.5, par=[3.5])
        np.testing.assert_allclose(np.abs(operands), [1.0, 0.0, 8.75, 1.0])
        np.testing.assert_array_equal(kinds, [InstantKind.KINK, InstantKind.KINK, InstantKind.NARROW, InstantKind.END])


def test_search_memory_grows_with_the_number_of_instants() -> None:
    """More instants than a package's memory holds."""
    teeth = find_instants([0, 0, 0], lambda i, t: np.sin((300 + 7 * i) * np.pi * t + 0.1), 0.0, 3.0)
    assert len(teeth) > constants()["SYM_INSTANT_CAPACITY"]
    np.testing.assert_array_equal(np.unique(teeth), teeth)


def test_exceptions_of_operands_propagate() -> None:
    def fail(operand: int, t: np.ndarray) -> np.ndarray:
        raise ArithmeticError(f"operand {operand}")

    with pytest.raises(ArithmeticError, match="operand 0"):
        find_instants([0], fail, 0.0, 1.0)


def test_how_formulas_are_evaluated_is_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not once more in each run, whatever its parameters: of the description's formulas, and of a law's."""
    made = list[object]()

    class Counted(interpreted.Evaluation):
        def __init__(self, *given: Any) -> None:
            made.append(given)
            super().__init__(*given)

    monkeypatch.setattr(interpreted, "Evaluation", Counted)
    slide = sf.Joint(
        "x", "prismatic", axis=(1, 0, 0), actuated=True, effort=("-tanh(dx/5) - p*exp(-((t - 0.5)/0.7)^2)",)
    )
    body = sf.RigidBody("b", slide, sf.Inertia(1.0))
    cart = sf.compile(sf.System("cart", (body,), parameters=(sf.Parameter("p", 1.0),)), sf.Options(backend="tape"))
    counts = []
    for p in (1.0, 1.0, 2.0):
        sf.simulate(cart.with_parameters(p=p), v0=[1.0], t_end=0.5, u={"x": "max(0, t - 0.2)*abs(x)"}, method="dopri5")
        counts.append(len(made))
    assert counts[0] > 2 and counts[1:] == counts[:1] * 2
