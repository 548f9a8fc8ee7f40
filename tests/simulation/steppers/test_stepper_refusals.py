"""What a model that is stepped by hand refuses, and that no step is made by it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled
from tests.simulation.steppers.test_stepper import DT

REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "a method of SUNDIALS": ({"method": "cvode"}, r"no steps to be made by hand[\s\S]*found:[\s\S]*rule:[\s\S]*rodas4"),
    "no method": ({"method": "rk5"}, r"no method 'rk5'[\s\S]*found:[\s\S]*rule:[\s\S]*remedy:"),
    "no step": ({"dt": -1.0}, r"step is not positive[\s\S]*found:  -1.0[\s\S]*rule:[\s\S]*remedy:"),
    "records": ({"output": 0.1}, r"'output'[\s\S]*found:  0.1[\s\S]*rule:[\s\S]*leave it out"),
    "an end": ({"max_steps": 3}, r"'max_steps'[\s\S]*found:  3[\s\S]*rule:[\s\S]*leave it out"),
    "a pace": ({"realtime": True}, r"'realtime'[\s\S]*found:  True[\s\S]*rule:[\s\S]*leave it out"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_options_without_a_meaning_are_refused(case: str) -> None:
    options, said = REFUSED[case]
    with pytest.raises(sf.SymofrosError, match=said):
        sf.Stepper(compiled("cart_pole"), **options)


WRONG_INPUTS = {
    "shape": (np.zeros(2), r"found:  \(2,\)"),
    "a number": (3.0, r"found:  \(\)"),
    "not finite": (np.array([np.nan]), "found:  a number that is not finite"),
    "infinite": (np.array([np.inf]), "found:  a number that is not finite"),
    "words": ("abc", "found:  str"),
}


@pytest.mark.parametrize("case", WRONG_INPUTS)
@pytest.mark.parametrize("first", [True, False])
def test_inputs_that_do_not_fit_are_refused_and_no_step_is_made(case: str, first: bool) -> None:
    u, found = WRONG_INPUTS[case]
    stepper = sf.Stepper(compiled("cart_pole"), dt=DT)
    if not first:
        assert stepper.step([1.0])
    before = stepper.save()
    with pytest.raises(sf.ShapeError, match=rf"u does not fit[\s\S]*{found}[\s\S]*rule:[\s\S]*F[\s\S]*remedy:"):
        stepper.step(u)
    assert stepper.t == before.t and stepper.step([1.0])


def test_other_misuse_is_refused() -> None:
    stepper, other = (sf.Stepper(compiled("cart_pole"), dt=DT) for _ in range(2))
    for steps in (0, -1, 1.0, True):
        with pytest.raises(sf.SymofrosError, match=r"no number of steps[\s\S]*rule:[\s\S]*remedy:"):
            stepper.step([0.0], steps)  # type: ignore[arg-type]
    with pytest.raises(sf.SymofrosError, match=r"no state of this stepper[\s\S]*copy\(\)"):
        stepper.restore(other.save())
    with pytest.raises(sf.SymofrosError, match="no state of this stepper"):
        stepper.restore(None)  # type: ignore[arg-type]
    with pytest.raises(sf.SymofrosError, match="t is not a number"):
        stepper.reset(t=np.nan)
    with pytest.raises(sf.ShapeError, match="q0 does not fit"):
        stepper.reset([0.0])
    with pytest.raises(sf.UnknownNameError, match=r"no input 'F' by hand[\s\S]*remedy:"):
        sf.Stepper(compiled("cart_pole"), u={"F": 1.0}).step({"F": 2.0})
    loop = sf.Stepper(compiled("slider_crank"), dt=DT)
    loop.reset([0.5, 0.1, 0.4])
    for _ in range(2):
        with pytest.raises(sf.AssemblyError, match="first state does not keep"):
            loop.step([0.0])
