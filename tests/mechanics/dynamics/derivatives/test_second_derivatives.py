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

CASES = (
    "double_pendulum",
    "heavy_top",
    "friction_arm",
    "gyroscope",
    "space_arm",
    "joint_zoo",
    "flexible_pendulum",
)
NAMES = ("inverse_dynamics_second_derivatives", "inverse_dynamics_hvp", "inverse_dynamics_derivatives", "mass_matrix")
STEP = 1e-3


@pytest.fixture(scope="module", params=[*CASES, *MOTORS])
def m(request: pytest.FixtureRequest) -> sf.Model:
    stated = MOTORS.get(request.param) or system(request.param)
    return sf.compile(stated, sf.Options(NAMES, backend="interpreter"))


def change(of, along) -> np.ndarray:
    """Derivative of of(along(step)) at zero, from differences of sixth order."""
    pairs = ((1, 45 / 60), (2, -9 / 60), (3, 1 / 60))
    return sum(w * (of(*along(k * STEP)) - of(*along(-k * STEP))) for k, w in pairs) / STEP


def test_second_derivatives_match_differences_of_the_first(m: sf.Model, rng: np.random.Generator) -> None:
    q, v = m.random_state(rng)
    a = rng.normal(size=m.nv)
    second = m.inverse_dynamics_second_derivatives(q, v, a)
    first = [lambda q, v, i=i: m.inverse_dynamics_derivatives(q, v, a)[i] for i in range(2)]
    for k, e in enumerate(np.eye(m.nv)):

        def by_q(step: float, e: np.ndarray = e) -> tuple[np.ndarray, np.ndarray]:
            return m.integrate(q, step * e), v

        def by_v(step: float, e: np.ndarray = e) -> tuple[np.ndarray, np.ndarray]:
            return q, v + step * e

        for tensor, reference in (
            (second.d2tau_dq2[..., k], change(first[0], by_q)),
            (second.d2tau_dv2[..., k], change(first[1], by_v)),
            (second.d2tau_dqdv[..., k], change(first[0], by_v)),
            (second.d2tau_dqdv[:, k], change(first[1], by_q)),
            (second.d2tau_dadq[..., k], change(lambda q, v: m.mass_matrix(q), by_q)),
        ):
            np.testing.assert_allclose(tensor, reference, rtol=0, atol=1e-8 * max(1.0, np.abs(reference).max()))


def test_hessian_vector_products_are_the_tensors_contracted(m: sf.Model, rng: np.random.Generator) -> None:
    q, v = m.random_state(rng)
    a, w, dq, dv, da = rng.normal(size=(5, m.nv))
    qq, vv, qv, aq = (np.einsum("i,ijk->jk", w, T) for T in m.inverse_dynamics_second_derivatives(q, v, a))
    expected = (qq @ dq + qv @ dv + aq.T @ da, qv.T @ dq + vv @ dv, aq @ dq)
    for product, reference in zip(m.inverse_dynamics_hvp(q, v, a, w, dq, dv, da), expected, strict=True):
        np.testing.assert_allclose(product, reference, rtol=0, atol=1e-12 * max(1.0, np.abs(reference).max()))


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
