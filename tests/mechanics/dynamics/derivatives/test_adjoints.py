"""Vector-Jacobian products: <w, J x> = <J^T w, x>, at a cost that no number of inputs raises."""

from __future__ import annotations

from functools import cache

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

TRANSPOSED = tuple(row.transposes for row in FUNCTIONS.values() if row.transposes)
# Run-time parameters, friction, ball and free joints, loops, rolling.
SCENES = ("friction_arm", "gyroscope", "slider_crank", "rolling_disc")
# Most operations for each one of the function: two products and an addition beside each product, and its own values.
MOST = 4.0


@cache
def interpreted(case: str, name: str) -> sf.Model:
    """A function and its vector-Jacobian products."""
    frames = tuple(frame.name for frame in Compilation(system(case)).tree.frames[-1:])
    return sf.compile(system(case), sf.Options((name, f"{name}_vjp"), frames=frames, backend="interpreter"))


@pytest.mark.parametrize("case", SCENES)
@pytest.mark.parametrize("name", TRANSPOSED)
def test_products_are_the_changes_of_the_weighted_sum(case: str, name: str, rng: np.random.Generator) -> None:
    row = FUNCTIONS[name]
    if (row.of_frame and not Compilation(system(case)).tree.frames) or (row.constrained_only and not model(case).nc):
        pytest.skip("the model has no such thing")
    m = interpreted(case, name)
    q, v = m.random_state(rng)
    frame = m.names.frames[-1] if row.of_frame else ""
    sizes = {"q": m.nv, "v": m.nv, "a": m.nv, "u": m.nu, "lam": m.nc, "par": m.npar}
    moved = [group for group in sizes if group in (*row.inputs, "u", "par")]
    at = {group: rng.normal(size=sizes[group]) for group in moved} | {"q": q, "par": np.array(m.parameter_values)}
    direction = {group: rng.normal(size=sizes[group]) for group in moved}
    direction["par"] *= at["par"]

    def outputs(step: float) -> dict[str, np.ndarray]:
        given = {group: at[group] + step * direction[group] for group in moved if group != "q"}
        given["q"] = m.integrate(q, step * direction["q"])
        results = m.evaluate(name, frame, **given)
        return {array.name: value for array, value in zip(row.outputs, results, strict=False) if array.name != "rank"}

    m = m.with_parameter_checks(False)
    weights = {
        group: rng.normal(size=outputs(0.0)[of.name].shape)
        for group, of in row.cotangents.items()
        if of.name in outputs(0.0)
    }
    products = m.vjp(name, frame, **at, **weights)
    along = sum(float(products[group] @ direction[group]) for group in moved if group in products)
    h = 2e-4
    terms = [
        np.sum(
            weight * (8 * (outputs(h)[of] - outputs(-h)[of]) - (outputs(2 * h)[of] - outputs(-2 * h)[of])) / (12 * h)
        )
        for of, weight in ((row.cotangents[group].name, weight) for group, weight in weights.items())
    ]
    size = sum(float(np.abs(products[group]).sum()) for group in products)
    assert along == pytest.approx(sum(terms), rel=1e-7, abs=1e-8 * max(1.0, size))
    assert set(moved) == set(products)


@pytest.mark.parametrize("case", ["slider_crank", "rolling_disc"])
def test_multipliers_have_products_by_one_more_solution_of_the_same_system(case: str, rng: np.random.Generator) -> None:
    names = ("forward_dynamics_vjp", "forward_dynamics_derivatives", "forward_dynamics_by_par")
    for backend in ("interpreter", "c"):
        m = sf.compile(system(case), sf.Options(names, backend=backend))
        q, v = m.random_state(rng)
        u, w = rng.normal(size=m.nu), rng.normal(size=m.nv + m.nc)
        J = [*m.evaluate(names[1], q=q, v=v, u=u), *m.evaluate(names[2], q=q, v=v, u=u)]
        products = m.evaluate(names[0], q=q, v=v, u=u, a_bar=w[: m.nv], lam_bar=w[m.nv :])
        for product, of in zip(products, J, strict=True):
            np.testing.assert_allclose(product, w @ of, rtol=0, atol=1e-9 * max(1.0, np.abs(of).max(initial=0.0)))


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
