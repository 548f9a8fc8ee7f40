"""Constraint dynamics: the truth against what defines it, Pinocchio and MuJoCo against the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from validation.engines.identities import held
from validation.engines.interface import STEP, Unsupported
from validation.engines.matrix import SEED, Judged, Truths, asked, judged
from validation.engines.models.loops import trees
from validation.engines.plugins import OWN
from validation.engines.truth import constraints, derived
from validation.engines.truth.arithmetic import Exact, exact
from validation.engines.truth.dynamics import Point, Truth, digits
from validation.engines.verdicts import judge
from validation.engines.workers import Job, answered

TREES = trees()
DYNAMICS = ("constraint_jacobian", "constrained_acceleration", "constraint_forces", "mass_matrix", "bias")


def _judged(engine: str, name: str, *functions: str) -> dict[str, Judged]:
    plugin = OWN[engine]
    job = Job(engine, TREES[name], tuple(functions), SEED)
    return {one.cell.function: one for one in judged(plugin, job, Truths())}


def _closed(name: str) -> tuple[Truth, Point]:
    """A truth and a state that satisfies its constraints."""
    tree = replace(TREES[name], asked="")
    (answer,) = answered(Job("mujoco", tree, ("sizes",), SEED))
    assert answer.layout is not None and answer.state is not None
    return Truth(tree, answer.layout), Point.of(answer.state)


@pytest.mark.parametrize("name", ["point between branches", "weld on the world", "cable over four points"])
def test_constraint_dynamics_obey_the_equations_that_define_them_to_all_digits(name: str) -> None:
    truth, s = _closed(name)

    def residuals(t: Truth, s: Point) -> object:
        a, f = constraints.motion(t, s.q, s.v, s.tau)
        J = constraints.jacobian(t, s.q)
        assert f is not None
        return np.concatenate([t.ID(s.q, s.v, a) - s.tau - J.T @ f, J @ a + constraints.products(t, s.q, s.v)])

    assert np.max(np.abs(digits(truth.value(residuals, s)))) < 1e-30
    assert np.max(np.abs(digits(truth.value(lambda t, s: constraints.jacobian(t, s.q) @ s.v, s)))) < 1e-13


def test_constraint_forces_have_no_power_on_a_closed_state() -> None:
    truth, s = _closed("weld between branches")
    power = truth.value(
        lambda t, s: np.array([constraints.forces(t, s.q, s.v, s.tau) @ (constraints.jacobian(t, s.q) @ s.v)]), s
    )
    assert abs(float(power[0])) < 1e-12


@pytest.mark.parametrize("kind", ["weld", "point"])
def test_bodies_that_are_bound_in_a_step_keep_their_momentum(kind: str) -> None:
    name = f"{kind} between free bodies"
    truth, s = _closed(name)

    def closing(t: Truth, s: Point) -> Exact:
        return constraints.jacobian(t, s.q) @ constraints.after_step(t, s)

    def left(t: Truth, s: Point) -> Exact:
        """What the bodies' linear momenta gain together, which the constraint has no part in."""
        free = s.v2 + exact(STEP)[()] * t.FD(s.q, s.v2, s.tau)
        return (derived.centroidal_matrix(t, s.q) @ (constraints.after_step(t, s) - free))[:3]

    assert np.max(np.abs(digits(truth.value(closing, s)))) < 1e-30
    assert np.max(np.abs(digits(truth.value(left, s)))) < 1e-13
    assert np.max(np.abs(digits(truth.value(lambda t, s: constraints.jacobian(t, s.q) @ s.v2, s)))) > 0.1
    assert set(asked(OWN["drake"], TREES[name])) == {"step_bound"} and not asked(OWN["pinocchio"], TREES[name])


def test_redundant_equations_leave_one_acceleration_and_no_one_force() -> None:
    truth, s = _closed("four-bar in a plane")
    a = truth.value(lambda t, s: constraints.acceleration(t, s.q, s.v, s.tau), s)
    rest = truth.value(
        lambda t, s: constraints.jacobian(t, s.q) @ exact(digits(a)) + constraints.products(t, s.q, s.v), s
    )
    assert np.max(np.abs(digits(rest))) < 1e-13
    with pytest.raises(ZeroDivisionError):
        truth.value(lambda t, s: constraints.forces(t, s.q, s.v, s.tau), s)


def test_an_impact_with_rebound_reverses_half_of_the_velocity_of_closing() -> None:
    truth, s = _closed("point held in the world")

    def closing(t: Truth, s: Point) -> object:
        after = constraints.after_impact(t, s.q, s.v2, exact(0.5)[()])
        return constraints.jacobian(t, s.q) @ (after + s.v2 / 2)

    assert np.max(np.abs(digits(truth.value(closing, s)))) < 1e-30


@pytest.mark.parametrize("engine", ["pinocchio", "mujoco"])
@pytest.mark.parametrize("name", ["point between branches", "weld of a free base's branch on the world"])
def test_engines_are_right_about_loops(engine: str, name: str) -> None:
    cells = _judged(engine, name, *DYNAMICS)
    assert {one.cell.verdict for one in cells.values()} == {"right"}
    assert [row.identity for row in held(list(cells.values())) if row.ok] == ["M a + h = tau + J^T f"]


def test_derivatives_of_point_constraints_are_right_in_the_world_and_wrong_between_two_bodies() -> None:
    function = "constrained_acceleration_dq"
    verdicts = {
        name: _judged("pinocchio", name, function)[function].cell.verdict
        for name in ("point held in the world", "point between branches")
    }
    assert verdicts == {"point held in the world": "right", "point between branches": "wrong"}


def test_functions_of_constraints_are_asked_of_trees_with_constraints_only() -> None:
    bound = TREES["point between branches"]
    free = replace(bound, constraints=())
    plugin = OWN["pinocchio"]
    assert set(asked(plugin, bound)) & set(asked(plugin, free)) == {"mass_matrix", "bias"}
    refused = OWN["pinocchio"].build(TREES["cable of two points"])
    assert isinstance(refused, Unsupported) and "path" in refused.reason


@pytest.mark.parametrize("name", [name for name in TREES if name.startswith(("coupling", "cable"))])
def test_mujoco_couples_coordinates_and_measures_cables(name: str) -> None:
    verdicts = {one.cell.verdict for one in _judged("mujoco", name, "constraint_jacobian", "delassus").values()}
    assert verdicts == {"right"}


@pytest.mark.parametrize("name", [name for name in TREES if name.startswith("polynomial")])
def test_a_polynomial_is_bound_by_its_derivative(name: str) -> None:
    truth, s = _closed(name)
    (one,) = TREES[name].constraints

    def excess(t: Truth, s: Point) -> Exact:
        slope = t.kinematics.tangent(lambda q: np.array([t.kinematics.line(q, one)[0]]), s.q)
        return slope - constraints.jacobian(t, s.q)

    assert np.max(np.abs(digits(truth.value(excess, s)))) < 1e-30
    x, y = float(s.q[1]), float(s.q[2])
    assert y == pytest.approx(np.polyval(one.coefficients[::-1], x), abs=1e-12)


def test_a_polynomial_that_is_a_line_is_a_red_cell() -> None:
    tree = TREES["polynomial of a hinge, of degree two"]
    (stated,) = tree.constraints
    line = replace(tree, constraints=(replace(stated, coefficients=stated.coefficients[:2]),))
    names = ("constraint_jacobian", "constraint_residuals")
    want = _judged("mujoco", tree.name, *names)
    for answer in answered(Job("mujoco", line, names, SEED)):
        expected = want[answer.function].want
        assert expected is not None and want[answer.function].cell.verdict == "right"
        assert judge("planted", tree, answer.function, np.asarray(answer.value), expected).verdict == "wrong"
