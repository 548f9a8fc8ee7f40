"""Every public name, called with nonsense in each of its arguments in turn, answers in words: never a raw traceback."""

from __future__ import annotations

import inspect
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.description.hostile.test_nonsense import NONSENSE, NOUNS

# Pages and windows wait for a browser; nouns have a test of their own; the others are modules.
_APART = {"view", "Viewer", "record", "interop", "solids", "sections", *(noun.__name__ for noun in NOUNS)}
# Minutes of work that is sound: what takes a model compiles C, or searches.
_LONG = {"compile_library", "advise", "export"}
# A call of these forms derivatives anew, or runs: a part of the values.
_SEARCHES = {"equilibrium", "inverse_kinematics", "joint_motion", "modes", "state_space", "rollout", "simulate"}


def _is_called(name: str) -> bool:
    value = getattr(sf, name)
    made = callable(value) and not (inspect.isclass(value) and issubclass(value, BaseException))
    return made and not name.startswith("_") and name not in _APART


NAMES = [name for name in dir(sf) if _is_called(name)]


@pytest.fixture(scope="module")
def sound() -> dict[str, Any]:
    """Arguments that make sense, by name."""
    link = sf.RigidBody("a", sf.Joint("a", "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1)))
    system = sf.System("s", (link,))
    model = sf.compile(system, sf.Options(backend="interpreter"))
    zero = np.zeros(1)
    sound = {"model": model, "system": system, "source": system, "path": "none.yaml", "t_end": 0.01, "dt": 0.005}
    sound |= {"options": sf.Options(), "functions": ["mass_matrix"], "target": "urdf", "folder": "out", "formula": "a"}
    sound |= {"targets": {"a": sf.Target(position=(0.1, 0.0, 0.5))}, "frame": "a", "samples": 20}
    sound |= {"t": [0.0, 1.0], "values": [1.0, 2.0], "diagram": sf.Diagram("d"), "u": np.zeros((3, 0))}
    sound |= dict.fromkeys(("positions", "velocities", "accelerations"), np.zeros((1, 3)))
    return sound | dict.fromkeys(("q", "v", "a", "q0", "v0"), zero)


@pytest.mark.parametrize("name", NAMES)
def test_public_functions_meet_nonsense_with_library_errors_only(
    name: str, sound: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    function = getattr(sf, name)
    try:
        parameters = [p for p in inspect.signature(function).parameters.values() if p.kind not in (2, 4)]
    except ValueError:  # A type of Python's own, such as Literal.
        return
    required = [p.name for p in parameters if p.default is p.empty]
    # A search from nonsense goes on to its bound.
    bounds = {"iterations": 2} if "iterations" in (p.name for p in parameters) else {}
    for parameter in parameters:
        values = NONSENSE[::7] if name in _SEARCHES else NONSENSE
        for make in (*values, lambda: np.ma.masked_array([1.0], [True]), lambda: sound["system"]):
            value = make()
            stated = {other: sound.get(other, value) for other in required} | bounds | {parameter.name: value}
            if name in _LONG and isinstance(value, sf.System):
                continue
            _called(function, stated, f"{name}({parameter.name}={value!r:.60})")


def _called(function: Any, stated: dict[str, Any], shown: str) -> None:
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            function(**stated)
    except sf.SymofrosError as error:
        assert all(p.what and p.found and p.rule and p.remedy for p in error.problems), f"{shown}: {error}"
    except TypeError as error:  # Python's own, of a call that does not fit the signature.
        traceback = error.__traceback__
        assert traceback is not None and traceback.tb_next is not None, shown
        assert traceback.tb_next.tb_next is None and "argument" in str(error), f"{shown}: {error}"
    except Exception as error:
        raise AssertionError(f"{shown}: {type(error).__name__}: {error}") from error


@pytest.mark.parametrize("value", ["a", None, 1j, [1.0], np.zeros(2)])
def test_formulas_are_evaluated_at_numbers(value: Any) -> None:
    formula = sf.formula("x + 1")
    assert math.isclose(sf.evaluate(formula, {"x": 2}), 3.0)
    with pytest.raises(sf.ArgumentError, match="the value of 'x'"):
        sf.evaluate(formula, {"x": value})
    with pytest.raises(sf.UnknownNameError, match="'x' has no value"):
        sf.evaluate(formula, {"y": 1.0})


@pytest.mark.parametrize("call", ["equilibrium", "modes", "assemble"])
@pytest.mark.parametrize("name", ["q", "v", "u"])
def test_functions_of_one_state_refuse_batches(call: str, name: str, sound: dict[str, Any]) -> None:
    function = getattr(sf, call)
    if name in inspect.signature(function).parameters:
        stated = {"q": np.zeros(1)} | {name: np.zeros((2, 1))}
        with pytest.raises(sf.ShapeError, match=f"{name} has |{name} does not fit"):
            function(sound["model"], **stated)


def test_masked_values_are_refused(sound: dict[str, Any]) -> None:
    model = sound["model"]
    masked = np.ma.masked_array([0.1], [True])
    for values in (masked, [masked]):
        with pytest.raises(sf.ShapeError, match="q is not an array of numbers"):
            model.mass_matrix(values)
    whole = np.ma.masked_array([0.1], [False])
    assert np.array_equal(model.mass_matrix(whole), model.mass_matrix(np.array([0.1])))


@pytest.mark.parametrize(
    "option",
    [{"output": [math.nan]}, {"output": [0.0, math.nan]}, {"output": 1e-12}, {"output": [0.0, math.inf]}]
    + [{"realtime": pace} for pace in (-1, -0.5, math.inf)],
)
def test_options_that_mean_nothing_are_refused(option: dict[str, Any], sound: dict[str, Any]) -> None:
    with pytest.raises(sf.SymofrosError, match="output|record|pace"):
        sf.simulate(sound["model"], [0.0], [0.0], 0.01, **option)
