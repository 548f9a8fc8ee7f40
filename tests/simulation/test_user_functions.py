"""Users' functions are named by file and line."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.simulation.user_functions import named_function, raised_where


class Law:
    def __call__(self) -> None:
        raise ValueError("no")


def test_functions_are_named_by_their_file_and_line() -> None:
    line = Law.__call__.__code__.co_firstlineno
    assert named_function(Law.__call__) == f"Law.__call__ (test_user_functions.py:{line})"
    assert named_function(Law()).endswith(f"(test_user_functions.py:{line})")
    assert "partial" in named_function(functools.partial(print, 1)) and "print" in named_function(print)


def test_exceptions_are_named_by_the_line_that_raised_them() -> None:
    try:
        Law()()
    except ValueError as error:
        assert raised_where(error).startswith("ValueError('no') at test_user_functions.py:")
    assert raised_where(ValueError("never raised")) == "ValueError('never raised')"


def test_so_are_a_function_of_one_input_of_progress_and_of_a_block() -> None:
    with pytest.raises(sf.ArgumentError, match="a function gives all inputs at once"):
        sf.simulate(slide(), t_end=0.01, u={"x": lambda t: 1.0})
    with pytest.raises(sf.ArgumentError, match=r"it is called with \(t\)"):
        sf.simulate(slide(), t_end=0.01, progress=lambda: None)  # type: ignore[misc,arg-type]
    with pytest.raises(sf.ArgumentError, match=r"it is called with \(t, inputs\)"):
        blocks.PythonBlock(name="law", function=lambda t: {"u": [0.0]}, outputs={"u": (1,)}, period=0.01)  # type: ignore[misc,arg-type]


@pytest.mark.parametrize("law", [lambda t: [0.0], lambda t, q, v, extra: [0.0], Law()])
def test_a_law_of_other_arguments_is_refused_before_the_run(law: Any) -> None:
    with pytest.raises(sf.ArgumentError, match=r"takes other arguments(.|\n)*it is called with \(t, q, v\)"):
        sf.simulate(slide(), t_end=0.01, u=law)


def _tuned(law: Any) -> Any:
    return functools.wraps(law)(lambda t, q, v: law(t, q, v, 1.0))


LAWS = [
    lambda t, q, v: [1.0],
    lambda *state: [1.0],
    lambda t, q, v, gain=1.0: [gain],
    _tuned(lambda t, q, v, gain: [gain]),
]


@pytest.mark.parametrize("law", LAWS)
def test_a_law_that_can_be_called_so_is_taken(law: Any) -> None:
    assert sf.simulate(slide(), t_end=0.01, u=law).v[-1, 0] == pytest.approx(0.01)


def test_a_law_is_named_where_the_model_has_states_of_forces() -> None:
    """There it is wrapped, which is no name that its author knows."""

    class Wrong:
        def __call__(self, t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
            return [0.0, 0.0]

    def wrong(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        return [0.0, 0.0]

    for law, name in ((wrong, "wrong (test_user_functions.py"), (Wrong(), "Wrong (test_user_functions.py")):
        run = sf.simulate(slide(sf.ForceState("T", 1.0)), t_end=0.01, u=law)
        assert name in run.outcome.reason


def slide(*states: sf.ForceState) -> sf.Model:
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True)
    return sf.compile(sf.System("slide", (sf.RigidBody("body", joint, sf.Inertia(1.0)),), states=states))
