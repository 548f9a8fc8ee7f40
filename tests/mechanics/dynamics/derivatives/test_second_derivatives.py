"""Second derivatives of the inverse dynamics against the change of the first, their symmetries, and each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import random_tree
from symofros.expr.numerics.evaluate import interpret
from symofros.expr.program import Function, Output, Program
from symofros.mechanics.dynamics.derivatives.second_derivatives import (
    Tensor,
    bias_second_derivatives,
    by_two_speeds,
    mass_matrix_derivatives,
)
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.topology.tree import build_tree
from tests.models import MOTORS, system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities

CASES = (
    "double_pendulum",
    "heavy_top",
    "friction_arm",
    "gyroscope",
    "space_arm",
    "joint_zoo",
    "flexible_pendulum",
)


@pytest.mark.parametrize("name", [*CASES, *MOTORS])
def test_second_derivatives_match_differences_of_the_first(name: str) -> None:
    """And Hessian-vector products are the tensors, contracted."""
    assert_agrees(identities.twice_differentiated, MOTORS.get(name) or system(name))


@pytest.mark.parametrize(("prescribed", "seed"), [(False, 4), (True, 6)])
def test_the_mass_matrix_determines_the_bias_by_two_speeds(
    prescribed: bool, seed: int, rng: np.random.Generator
) -> None:
    """(11a) against h differentiated twice on the graph, whether or not a joint of the tree is driven."""
    stated = random_tree(seed, kinds=("revolute", "universal", "ball", "free"))
    body = next(b for b in stated.bodies[1:] if b.joint is not None and b.joint.kind in ("revolute", "universal"))
    assert body.joint is not None
    if prescribed:
        stated = stated.with_bodies(replace(body, joint=replace(body.joint, prescribed=True, actuated=False)))
    e, m = Equations(build_tree(stated)), sf.compile(stated, sf.Options(("mass_matrix",), backend="interpreter"))
    q, v = m.random_state(rng)
    inputs = {"q": q[None], "v": v[None], "u": rng.normal(size=(1, m.nu))}
    of_mass = bias_second_derivatives(e.kinematics, e.M, mass_matrix_derivatives(e.kinematics, e.M))
    of_graph = by_two_speeds(e.kinematics, e.by_v(e.h))
    one, other = (values(e, tensor, inputs) for tensor in (of_mass, of_graph))
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())


def values(e: Equations, tensor: Tensor, inputs: dict[str, np.ndarray]) -> np.ndarray:
    edges = tuple(edge for matrix in tensor for row in matrix for edge in row)
    function = Function("tensor", "", tuple(inputs), (Output("T", (e.nv, e.nv, e.nv), edges),))
    return interpret(Program("tensor", e.g, {}, (function,)), function, inputs, 1)[0]
