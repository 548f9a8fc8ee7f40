"""The nouns of a description refuse values of other types in words; whatever they take can be compared and hashed."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import MISSING, fields
from typing import Any

import numpy as np
import pytest
import sympy

import symofros as sf
from symofros.description.beams.beam import BeamLoad
from symofros.description.beams.shapes import Samples

NOUNS: tuple[Any, ...] = (
    *(sf.System, sf.RigidBody, sf.Beam, sf.Joint, sf.Frame, sf.Inertia, sf.Parameter, sf.Input, sf.Limits),
    *(sf.Closure, sf.Rod, sf.Rolling, sf.KnifeEdge, sf.Nonholonomic, sf.Coupling, sf.Connection, BeamLoad, Samples),
    *(sf.Friction, sf.Spring, sf.Damper, sf.Stop, sf.Load, sf.Rotor, sf.VirtualPower, sf.Potential, sf.Rotation),
)
# Entries without a default.
STATED = {
    **{"name": "n", "first": ("a", None), "second": ("b", None), "anchor": ("a", None), "energy": "x", "value": 1.0},
    **{"residual": "x", "forces": {"dq": 1.0}, "coefficients": {"dq": 1.0}, "joint": sf.Joint("j"), "length": 1.0},
    **{"rhoA": 1.0, "xi": (0, 0.2, 0.6, 1), "values": (0, 1, 2, 3), "stiffness": 1.0, "coefficient": 1.0},
    **{"dynamic": 1.0, "inertia": 1.0, "radius": 1.0},
}
NONSENSE: tuple[Callable[[], Any], ...] = tuple(
    lambda value=value: value  # type: ignore[misc]
    for value in (
        *(None, True, 3, -1.5, float("nan"), float("inf"), 10**400, 1j, Ellipsis, "", "x", "1+", "a b", b"x", object()),
        *([], [1], [[1, 2], [3, 4]], [[1], 2, "x"], (1, 2, 3), ("a", "b"), (("a", None),), {}, {"a": 1}, {1, 2, 3}),
        *(sf.Frame("f"), sf.Spring(1.0), sf.Rotation(), sf.Joint("j"), sf.Limits(), int, len, range(3)),
        *(np.zeros(3), np.zeros((3, 3)), np.array([[None]]), np.array(1.0), sympy.Symbol("x"), sympy.Matrix([1, 2])),
    )
) + (lambda: iter([1]), lambda: (x for x in "ab"))


def entries() -> list[tuple[Any, str]]:
    return [(noun, item.name) for noun in NOUNS for item in fields(noun) if item.init]


def required(noun: Any) -> dict[str, Any]:
    stated = (item.name for item in fields(noun) if item.default is MISSING and item.default_factory is MISSING)
    return {name: STATED[name] for name in stated}


@pytest.mark.parametrize(("noun", "entry"), entries(), ids=lambda value: getattr(value, "__name__", value))
def test_invalid_values_are_refused_with_a_rule_or_give_a_usable_object(noun: Any, entry: str) -> None:
    noun(**required(noun))
    for value in NONSENSE:
        try:
            made = noun(**required(noun) | {entry: value()})
        except sf.SymofrosError as error:
            assert all(problem.what and problem.rule for problem in error.problems), str(error)
        else:
            assert made == made and isinstance(repr(made), str)
            if noun is not sf.System:
                hash(made)


@pytest.mark.parametrize("maker", ["rpy", "axis_angle", "quaternion", "matrix"])
def test_rotations_refuse_nonsense_with_library_errors_only(maker: str) -> None:
    make = getattr(sf.Rotation, maker)
    names = list(inspect.signature(make).parameters)
    sound = {"axis": (0, 0, 1), "rows": np.eye(3)}
    for name in names:
        for value in NONSENSE:
            arguments = [value() if other == name else sound.get(other, 0.0) for other in names]
            try:
                make(*arguments)
            except sf.SymofrosError as error:
                assert error.problem.found
    with pytest.raises(TypeError, match="unexpected keyword argument"):
        make(nonsense=1)


TURN = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


@pytest.mark.parametrize("rows", [TURN, [list(row) for row in TURN], np.array(TURN)])
def test_a_rotation_is_given_by_the_rows_of_its_matrix(rows: Any) -> None:
    stated = sf.Rotation.matrix(TURN)
    assert sf.Joint("j", "revolute", rotation=rows) == sf.Joint("j", "revolute", rotation=stated)
    assert sf.Frame("f", (0, 0, 0), rows).rotation == stated
    assert sf.Inertia(1.0, (0, 0, 0), (1, 1, 1), rotation=rows).rotation == stated
    assert sf.Joint("g", "general", coordinates=["a"], moving_rotation=rows).moving_rotation == stated
    formulas = sf.Frame("f", rotation=[["cos(a)", "-sin(a)", 0], ["sin(a)", "cos(a)", 0], [0, 0, 1]])  # type: ignore[arg-type]
    assert formulas.rotation.kind == "matrix" and len(formulas.rotation.values) == 9


@pytest.mark.parametrize("value", [(0, 0, 0, 1), (0.1, 0.2, 0.3), [[1, 0], [0, 1]], "rpy", 1.0])
def test_a_rotation_that_is_not_a_matrix_is_refused_with_the_remedy(value: Any) -> None:
    with pytest.raises(sf.DescriptionError, match=r"sf.Rotation.rpy\(roll, pitch, yaw\)"):
        sf.Joint("j", "revolute", rotation=value)


def test_rotors_among_joint_elements_are_refused() -> None:
    with pytest.raises(sf.DescriptionError, match=r"Joint 'j': elements\[0\] is not a Spring or a Damper"):
        sf.Joint("j", "revolute", elements=[sf.Rotor(1.0)])  # type: ignore[list-item]


def test_negative_limits_are_refused() -> None:
    with pytest.raises(sf.DescriptionError, match="velocity is negative"):
        sf.Limits(velocity=-1.0)
    assert sf.Limits(-2.0, -1.0, 0.0, float("inf")).lower == -2.0
