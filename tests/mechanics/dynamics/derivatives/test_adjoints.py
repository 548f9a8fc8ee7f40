"""Vector-Jacobian products: <w, J x> = <J^T w, x>, at a cost that no number of inputs raises."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.base.functions import FUNCTIONS
from symofros.base.routes import taken
from symofros.compiler import Compilation
from symofros.generator.passes.count import count_operations
from symofros.mechanics.dynamics.applied.forces import coordinate_rates
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.functions import Methods, Request, form_program
from tests.models import model, system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities

TRANSPOSED = tuple(row.transposes for row in FUNCTIONS.values() if row.transposes)
# Run-time parameters, friction, ball and free joints, loops, rolling.
SCENES = ("friction_arm", "gyroscope", "slider_crank", "rolling_disc")
# Most operations for each one of the function: two products and an addition beside each product, and its own values.
MOST = 4.0


@pytest.mark.parametrize("case", SCENES)
def test_products_are_the_changes_of_the_weighted_sum(case: str) -> None:
    assert_agrees(identities.transposed, system(case))


@pytest.mark.parametrize("case", ["joints2", "heavy_top", "gyroscope", "friction_arm", "slider_crank", "puma560"])
def test_reverse_mode_needs_at_most_four_times_the_operations(case: str) -> None:
    tree = Compilation(system(case)).tree
    for name in TRANSPOSED:
        e = Equations(tree)
        frame = tree.frames[-1].name if FUNCTIONS[name].of_frame and tree.frames else ""
        if FUNCTIONS[name].of_frame and not frame:
            continue
        way = "factors" if e.route_figures["distant_rotors"] else "articulated"
        methods = Methods(taken("acceleration of trees", way), way)
        program = form_program(e, [Request(name, frame), Request(f"{name}_vjp", frame)], methods)
        of, sweep = (count_operations(program.graph, function.edges()).total for function in program.functions)
        # What is linear in an input adds cotangents, and takes no operation itself; N of q' = N v is swept, too.
        added = sum(len(output.edges) for output in program.functions[0].outputs)
        rates = count_operations(program.graph, [*coordinate_rates(e.kinematics).values()]).total
        assert sweep <= MOST * (of + rates) + added, name


def test_cotangents_have_the_shapes_of_outputs(rng: np.random.Generator) -> None:
    m = model("double_pendulum")
    q = np.array([[0.3, -0.2], [0.1, 0.5]])
    W = rng.normal(size=(2, 2, 2))
    by_q = m.vjp("mass_matrix", q=q, M_bar=W)["q"]
    flat = m.evaluate("mass_matrix_vjp", q=q, M_bar=W.reshape(2, 4))[0]
    np.testing.assert_array_equal(by_q, flat)
    with pytest.raises(sf.ShapeError, match="M_bar has the wrong shape"):
        m.vjp("mass_matrix", q=q, M_bar=rng.normal(size=3))
    with pytest.raises(sf.UnknownNameError, match="did you mean 'mass_matrix'"):
        m.vjp("mass_matrx", q=q, M_bar=W)
    with pytest.raises(sf.ShapeError, match="no cotangent for mass_matrix"):
        m.vjp("mass_matrix", q=q)


def test_a_transposed_cotangent_is_refused_though_it_has_as_many_entries(rng: np.random.Generator) -> None:
    m = model("double_pendulum")
    frame, q = m.names.frames[-1], np.array([0.3, -0.2])
    J_bar = rng.normal(size=(6, m.nv))
    group = next(iter(FUNCTIONS["frame_jacobian"].cotangents))
    m.vjp("frame_jacobian", frame, q=q, **{group: J_bar})
    with pytest.raises(sf.ShapeError, match=r"\(\.\.\., 6, nv\)"):
        m.vjp("frame_jacobian", frame, q=q, **{group: J_bar.T})


def test_empty_inputs_may_be_omitted(rng: np.random.Generator) -> None:
    """A tree has no multipliers: `lam_bar`, or `lam`, is empty, and says nothing."""
    m = model("double_pendulum")
    given = {"q": rng.normal(size=2), "v": rng.normal(size=2), "u": np.zeros(m.nu)}
    named = m.vjp("forward_dynamics", a_bar=np.ones(2), **given)
    for arrays in ({}, {"lam_bar": []}):
        by_q, *_ = m.evaluate("forward_dynamics_vjp", a_bar=np.ones(2), **given, **arrays)
        np.testing.assert_array_equal(by_q, named["q"])
    M = m.evaluate("implicit_terms", a=np.zeros(2), **given)[0]
    np.testing.assert_array_equal(M, m.mass_matrix(given["q"]))
    with pytest.raises(sf.ShapeError, match="no a_bar"):
        m.evaluate("forward_dynamics_vjp", **given)
    loop = model("slider_crank")
    with pytest.raises(sf.ShapeError, match="no lam_bar"):
        loop.evaluate("forward_dynamics_vjp", q=loop.neutral(), v=np.zeros(loop.nv), a_bar=np.ones(loop.nv))
