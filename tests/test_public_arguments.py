"""Every public method with every argument of a wrong type or value: done, or refused in four parts."""

from __future__ import annotations

import datetime
import inspect
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, is_dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.base.arguments import check_argument, checked

ROOT = Path(sf.__file__).parents[1]
MODELS = ROOT / "reference_models"
WRONG: tuple[Any, ...] = (
    *(None, 3, -1, 0, 2.5, float("nan"), float("inf"), True, 10**400, "abc", "", "1", b"x", object(), int, set()),
    *([], ["abc"], [1, "a"], [None], [[1, 2], [3]], {}, {"abc": 1}, {1: 2}, {"q": "abc"}, Path("nosuch.yaml")),
    *(np.array(["a"]), np.array([1 + 2j]), np.zeros((2, 0)), datetime.date(2020, 1, 1)),
)
Q, V, U = (0.1, 0.2), (0.0, 0.0), (0.0,)


@cache
def system() -> sf.System:
    return sf.load(MODELS / "rigid/cart_pole.yaml")


@cache
def model() -> sf.Model:
    return sf.compile(system())


def stepped_once(u: Any = None, steps: Any = 1) -> bool:
    return sf.Stepper(model()).step(u, steps)


def diagram() -> sf.Diagram:
    d = sf.Diagram("d")
    d.add(blocks.Constant(name="one", value=1.0))
    d.add(blocks.Integrator(name="sum"), u="one.y")
    return d


# Methods (functions are asked in tests/test_public_nonsense.py): name -> a function, and arguments that it takes.
CALLS: dict[str, Callable[[], tuple[Callable[..., Any], dict[str, Any]]]] = {
    "Stepper.reset": lambda: (sf.Stepper(model()).reset, {"q": Q}),
    "Stepper.step": lambda: (stepped_once, {"u": U}),
    "Stepper.restore": lambda: (sf.Stepper(model()).restore, {"state": None}),
    "Simulation.run": lambda: (sf.Simulation(diagram()).run, {"t_end": 0.01}),
    "DiagramStepper.reset": lambda: (sf.Simulation(diagram()).stepper().reset, {}),
    "DiagramStepper.step": lambda: (sf.Simulation(diagram()).stepper().step, {"steps": 2}),
    "Simulation.interpret": lambda: (sf.Simulation(diagram()).interpret, {"t_end": 1.0, "dt": 0.5, "compiled": False}),
    "Diagram.add_model": lambda: (diagram().add_model, {"name": "m", "system": system()}),
    "Diagram.add": lambda: (diagram().add, {"block": blocks.Constant(name="two", value=2.0)}),
    "Diagram.connect": lambda: (diagram().connect, {"source": "one.y", "target": "sum.v"}),
    "Diagram.include": lambda: (diagram().include, {"name": "p", "part": diagram()}),
    "Diagram.with_model": lambda: (diagram().with_model, {"name": "m"}),
    "Trajectory.save": lambda: (sf.simulate(model(), Q, t_end=0.002).save, {"path": "run.npz"}),
    "mass_matrix": lambda: (model().mass_matrix, {"q": Q}),
    "dynamics": lambda: (model().dynamics, {"q": Q, "v": V, "u": U}),
    "forward_dynamics": lambda: (model().forward_dynamics, {"q": Q, "v": V, "u": U}),
    "linearize": lambda: (model().linearize, {"q": Q, "v": V, "u": U}),
    "frame_pose": lambda: (model().frame_pose, {"frame": "tip", "q": Q}),
    "frame_jacobian": lambda: (model().frame_jacobian, {"frame": "tip", "q": Q}),
    "regressor": lambda: (model().regressor, {"q": Q, "v": V, "a": V}),
    "bind": lambda: (model().bind, {"name": "mass_matrix"}),
    "evaluate": lambda: (model().evaluate, {"name": "mass_matrix", "q": Q}),
    "vjp": lambda: (model().vjp, {"name": "bias", "q": Q, "v": V, "h_bar": V}),
    "integrate": lambda: (model().integrate, {"q": Q, "dq": V}),
    "difference": lambda: (model().difference, {"q0": Q, "q1": Q}),
    "normalized": lambda: (model().normalized, {"q": Q}),
    "random_state": lambda: (model().random_state, {"rng": np.random.default_rng(0)}),
    "with_precision": lambda: (model().with_precision, {"precision": "double"}),
    "with_threads": lambda: (model().with_threads, {"threads": 2}),
    "prepare": lambda: (lambda name: model().prepare(name), {"name": "bias"}),
    "with_parameters": lambda: (lambda m_cart: model().with_parameters(m_cart=m_cart), {"m_cart": 2.0}),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    sf.save_diagram(diagram(), "d.yaml")


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_refused_in_four_parts(name: str) -> None:
    function, given = CALLS[name]()
    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    parameters = [p.name for p in inspect.signature(function).parameters.values() if p.kind in kinds]
    faults, refused = [], 0
    for parameter in parameters:
        for wrong in WRONG:
            try:
                function(**{**given, parameter: wrong})
            except sf.SymofrosError as error:
                refused += 1
                if not all(p.what and p.found and p.rule and p.remedy for p in error.problems):
                    faults.append(f"{parameter} = {wrong!r:.20}: {error}")
            except OSError:  # Paths that can't be written to.
                pass
            except Exception as error:
                faults.append(f"{parameter} = {wrong!r:.20}: {type(error).__name__}: {error}")
    assert not faults, "\n".join(faults[:8])
    assert refused > 3


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: sf.simulate(model(), t_end="1"), "t_end is not a number.*str '1'.*write 1, without quotes"),
        (lambda: sf.simulate(system()), "model is not a Model.*System.*sf.compile"),
        (lambda: sf.simulate("cart_pole.yaml"), "model is not a Model.*sf.load"),
        (lambda: sf.Stepper(diagram()), "model is not a Model.*Diagram.*sf.Simulation"),
        (lambda: sf.equilibrium(model(), held="q"), r"held is not a list.*one alone: \['q'\]"),
        (
            lambda: sf.load("a.yaml", floating=True),
            "unexpected keyword argument 'floating'.*did you mean 'floating_base'",
        ),
        (lambda: sf.compile(system(), sf.Options(backend="d")), "backend is not one of 'c', 'tape', 'interpreter'"),
        (lambda: model().frame_pose(["tip"], Q), r"no frame '\['tip'\]'"),
        (lambda: model().dynamics(Q, V, U, t=None), "t is not an array of numbers"),
    ],
)
def test_wrong_arguments_are_refused_with_the_expected_message(call: Callable[[], object], words: str) -> None:
    with pytest.raises(sf.SymofrosError) as refusal:
        call()
    assert re.search(words, str(refusal.value), re.DOTALL), str(refusal.value)


@pytest.mark.parametrize("number", [1, 1.0, True, np.float32(1), np.int64(1), np.array(1.0), Fraction(1)])
def test_numbers_of_every_kind_are_numbers(number: Any) -> None:
    assert sf.simulate(model(), Q, t_end=number / 500).outcome.ok


def constructors() -> list[type]:
    """Public dataclasses that people make objects of; of the others, the library makes all."""
    made_here = {
        "Advice",
        "DiagramRun",
        "DiagramRuns",
        "DiagramStateSpace",
        "DiagramStepper",
        "EvaluationContext",
        "Expression",
        "Outcome",
        "Problem",
        "ReadableEquations",
    }
    made_here |= {"MechanismDiff", "Rollout", "Trajectories", "Trajectory"}
    classes = [getattr(module, name) for module in (sf, blocks) for name in dir(module) if name not in made_here]
    return [cls for cls in classes if isinstance(cls, type) and is_dataclass(cls)]


@pytest.mark.parametrize("cls", constructors(), ids=lambda cls: cls.__name__)
def test_a_keyword_that_no_class_has_is_refused_with_the_nearest(cls: type) -> None:
    (*_, last) = inspect.signature(cls).parameters
    with pytest.raises(
        sf.ArgumentError, match=rf"^{cls.__name__}(.|\n)*'{last}_'(.|\n)*did you mean '{last}'"
    ) as refusal:
        cls(**{f"{last}_": 1})
    assert isinstance(refusal.value, TypeError) and all(vars(refusal.value.problem)[part] for part in ("found", "rule"))
    with pytest.raises(sf.ArgumentError, match="too many positional arguments"):
        cls(*[1] * 99)


def test_type_errors_from_within_a_constructor_pass_through() -> None:
    @dataclass(frozen=True)
    class Strange(blocks.Block):
        def __post_init__(self) -> None:
            raise TypeError("from within")

    with pytest.raises(TypeError, match="^from within$"):
        Strange(name="a")


@checked
def first(names: Iterable[str], pair: tuple[str, str] = ("a", "b"), kind: type[sf.SymofrosError] | None = None) -> str:
    return next(iter(names))


def test_checks_do_not_exhaust_iterators() -> None:
    assert first(iter(["a", "b"]), ["c", "d"], sf.ShapeError) == "a"
    for wrong in (("a", "b", "c"), ("a", 1), "ab"):
        with pytest.raises(sf.ArgumentError, match="pair is not a tuple"):
            first(["a"], wrong)
    with pytest.raises(sf.ArgumentError, match="a class derived from SymofrosError, or None"):
        first(["a"], kind=int)
    check_argument("pair", ("a", "b"), tuple[str, str])
