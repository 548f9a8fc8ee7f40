"""The truth against closed forms, Lagrange's equations and itself."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal

import mpmath
import numpy as np
import pytest
import sympy

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import STEP, End, Joint, Link, Slot, State, Tendon, Tree
from validation.engines.models.kinds import tree_of
from validation.engines.proving.pieces import Layout
from validation.engines.proving.shrink import Case, size, smallest
from validation.engines.truth import displacements
from validation.engines.truth.arithmetic import cos_sin, exact, many_digits, rate, solve
from validation.engines.truth.charts import CHARTS, GEOMETRIES
from validation.engines.truth.dynamics import Point, Truth, digits, neutral, random_state
from validation.oracle import kane
from validation.truth_data.descriptions import system

_UNIT_INERTIA = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
HINGES = Layout(3, 3, tuple((Slot("angle", (k,), (k,)),) for k in range(3)))


def test_sine_and_cosine_have_all_digits() -> None:
    with many_digits(), mpmath.workdps(140):
        for angle in (Decimal("0.1"), Decimal(-2), Decimal("1e-9"), Decimal(40)):
            cosine, sine = cos_sin(angle)
            assert abs(mpmath.mpf(str(cosine)) - mpmath.cos(mpmath.mpf(str(angle)))) < mpmath.mpf(10) ** -115
            assert abs(mpmath.mpf(str(sine)) - mpmath.sin(mpmath.mpf(str(angle)))) < mpmath.mpf(10) ** -115


def test_differences_refuse_to_be_taken_in_few_digits() -> None:
    with pytest.raises(ArithmeticError):
        rate(lambda x: x * x, exact([1.0]), exact([1.0]))


def test_derivatives_are_in_proportion_to_the_direction_however_long_it_is() -> None:
    """Tiny bodies reach speeds of 1e14, at which points of a fixed step are far from each other."""
    with many_digits():
        at, along, long = exact([0.5]), exact([1.0]), Decimal(10) ** 14
        slope = rate(lambda x: cos_sin(x[0])[0], at, along)
        assert abs(rate(lambda x: cos_sin(x[0])[0], at, long * along) / (long * slope) - 1) < Decimal("1e-30")
        assert abs(slope + cos_sin(at[0])[1]) < Decimal("1e-30")


@pytest.mark.parametrize("speed", [1.0, 100.0, 1000.0])
def test_a_step_along_the_rate_of_a_quaternion_turns_by_the_arc_tangent(speed: float) -> None:
    """q (+) h w of unit length: tan(angle / 2) = h |w| / 2, where the step along the manifold turns by h |w|."""
    tree = replace(tree_of("ball"), links=tree_of("ball").links[:1], gravity=(0.0, 0.0, 0.0))
    tree = replace(tree, links=(replace(tree.links[0], com=(0.0, 0.0, 0.0), inertia=_UNIT_INERTIA),))
    ball = Layout(4, 3, ((Slot("quaternion xyzw, parent speeds", (0, 1, 2, 3), (0, 1, 2)),),))
    state = State(np.array([0.0, 0.0, 0.0, 1.0]), np.array([0.0, 0.0, speed]), *np.zeros((2, 3)), *np.zeros((2, 3)))
    with many_digits():
        ends = [
            digits(FUNCTIONS[f"step_{name}"].truth(Truth(tree, ball), Point.of(state)))
            for name in ("semi_implicit_normalized", "semi_implicit", "semi_implicit_straight")
        ]
    half = STEP * speed / 2.0
    cosine = 1.0 / math.hypot(1.0, half)
    np.testing.assert_allclose(ends[0][[2, 3]], [half * cosine, cosine], rtol=1e-15)
    np.testing.assert_allclose(ends[1][[2, 3]], [math.sin(half), math.cos(half)], rtol=1e-15)
    np.testing.assert_allclose(ends[2][[2, 3]], [half, 1.0], rtol=1e-15)


def test_newton_euler_forces_match_lagrange() -> None:
    tree = tree_of("revolute y")
    truth, point = Truth(tree, HINGES), Point.of(random_state(tree, HINGES, 1))

    def lagrange(t: Truth, s: Point) -> object:
        momentum_rate = rate(t.M, s.q, s.v) @ s.v
        unit = np.array(exact(np.eye(3)))
        lost = [rate(lambda q: t.T(q, s.v) - t.V(q), s.q, unit[k]) for k in range(3)]
        return momentum_rate - np.array(lost)

    difference = truth.value(lambda t, s: lagrange(t, s) - t.h(s.q, s.v), point)
    assert np.max(np.abs(digits(difference))) < 1e-30


@pytest.mark.parametrize("name", sorted(CHARTS))
def test_coordinates_stay_on_their_manifold_along_the_rates(name: str) -> None:
    chart = CHARTS[name]
    joint = Joint(
        "any", axis=(2 / 3, -1 / 3, 2 / 3), second=(0.0, 1.0, 0.0), pitch=0.3, radii=(1.0, 2.0, 3.0), sequence="ZYX"
    )
    q = chart.sample(joint, np.random.default_rng(1))
    with many_digits():
        R, p = chart.pose(joint, exact(q))
        assert R.shape == (3, 3) and p.shape == (3,) and chart.rates(joint, exact(q)).shape == (chart.nq, chart.nv)
        for k in range(chart.nv):
            spin = rate(lambda x: chart.pose(joint, x)[0], exact(q), chart.rates(joint, exact(q))[:, k]) @ R.T
            assert np.max(np.abs(digits(spin + spin.T))) < 1e-30


def test_the_armature_of_a_tendon_pulls_on_what_it_holds() -> None:
    """T = A l'' of the way l from a point beside a slide to it, across the slide by its share 1/l."""
    ends = (End("", p=(0.0, 1.0, 0.0)), End("a"))
    slide = Link("a", -1, (Joint("prismatic", axis=(1.0, 0.0, 0.0)),))
    tree = Tree("pulled", (slide,), gravity=(0.0, 0.0, 0.0), tendons=(Tendon("path", ends, armature=0.75),))
    x, v, a = 0.75, 0.5, -2.0
    state = State(*(np.array([value]) for value in (x, v, a, 0.0, 0.0, 0.0)))
    with many_digits():
        held = digits(FUNCTIONS["joint_wrenches"].truth(Truth(tree, Layout.ours(tree)), Point.of(state)))[0]
    way = math.hypot(x, 1.0)
    tension = 0.75 * ((v**2 + x * a) / way - (x * v) ** 2 / way**3)
    np.testing.assert_allclose(held[:3], [a + tension * x / way, -tension / way, 0.0], rtol=1e-15, atol=1e-15)


def test_forward_and_inverse_dynamics_undo_each_other_to_all_digits() -> None:
    tree = tree_of("revolute y")
    truth, point = Truth(tree, HINGES), Point.of(random_state(tree, HINGES, 2))
    again = truth.value(lambda t, s: t.FD(s.q, s.v, t.ID(s.q, s.v, s.a)) - s.a, point)
    assert np.max(np.abs(digits(again))) < 1e-30
    both = truth.value(
        lambda t, s: displacements.integrated_dv(t, s) - solve(displacements.difference_dq2(t, s), exact(np.eye(3))),
        point,
    )
    assert np.max(np.abs(digits(both))) < 1e-30


def test_shrinking_keeps_the_fault_and_halves_the_case() -> None:
    tree = tree_of("helical oblique")
    case = Case(tree, ((), (), ()))
    smaller = smallest(
        case, lambda one: any(own.joints[0].kind == "helical" and own.mass > 0.5 for own in one.tree.links), most=60
    )
    kinds = [own.joints[0].kind for own in smaller.tree.links]
    assert "helical" in kinds and size(smaller) < size(case) / 2


_ACROSS = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
_INERTIA = ((0.5, 0.03125, -0.0625), (0.03125, 0.625, 0.015625), (-0.0625, 0.015625, 0.75))


def _exact_tree() -> Tree:
    """A hinge and a slide across it, of numbers that have no rounding in any program."""
    joints = (
        Joint("revolute", axis=(1.0, 0.0, 0.0), p=(0.5, 0.25, -0.125)),
        Joint("prismatic", axis=(0.0, 1.0, 0.0), R=_ACROSS, p=(0.25, -0.5, 0.375)),
    )
    links = tuple(
        Link("abc"[k], k - 1, (joint,), 1.5 + k, (0.125, -0.25, 0.0625 * k), _INERTIA) for k, joint in enumerate(joints)
    )
    return Tree("exact", links, gravity=(1.0, -2.0, -9.5))


def test_the_truth_and_sympys_derivations_agree_to_thirty_digits() -> None:
    """Newton's and Euler's equations by differences against Kane's by symbols: no line in common."""
    tree = _exact_tree()
    layout = Layout(2, 2, ((Slot("angle", (0,), (0,)),), (Slot("length", (1,), (1,)),)))
    q, v = (0.375, -0.5), (0.25, -0.75)
    derived_model = kane.derive(system(tree))
    names = ("mass_matrix", "bias")
    point = {**dict(zip(derived_model.q, q, strict=True)), **dict(zip(derived_model.v, v, strict=True))}
    with mpmath.workdps(60):
        function = sympy.lambdify(
            [*point, *derived_model.shorts], [list(derived_model.values[n]) for n in names], "mpmath"
        )
        theirs = function(*map(mpmath.mpf, point.values()), *derived_model.shorts.values())
        truth = Truth(tree, layout)
        ours = (
            truth.value(lambda t, _: t.M(exact(q)), None),  # type: ignore[arg-type]
            truth.value(lambda t, _: t.h(exact(q), exact(v)), None),  # type: ignore[arg-type]
        )
        for mine, other in zip(ours, theirs, strict=True):
            apart = [abs(mpmath.mpf(str(a)) - b) for a, b in zip(np.ravel(mine), other, strict=True)]
            assert max(apart) < mpmath.mpf(10) ** -30


@pytest.mark.parametrize("chart", CHARTS)
def test_states_near_zero_are_near_where_nothing_has_moved(chart: str) -> None:
    kind = next((kind for kind, own in GEOMETRIES.items() if own == chart), "free" if "free" in chart else "ball")
    kind = "revolute" if chart == "cos sin" else "planar" if "planar" in chart else kind
    joint = Joint(kind, radii=(0.5, 0.25, 1.0), sequence="XYZ", pitch=0.5)
    tree = Tree("near", (Link("a", -1, (joint,)),), near=20)
    layout = Layout(
        CHARTS[chart].nq,
        CHARTS[chart].nv,
        ((Slot(chart, tuple(range(CHARTS[chart].nq)), (*range(CHARTS[chart].nv),)),),),
    )
    state = random_state(tree, layout, 3)
    truth = Truth(tree, layout)
    with many_digits():
        near, still = (digits(truth.kinematics.flat_poses(exact(q)))[0] for q in (state.q, neutral(layout)))
    assert 0.0 < np.abs(near - still).max() < 6 * 2.0**-20
    R = near[3:].reshape(3, 3)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-15)
    assert max(np.abs(part).max() for part in (state.v, state.tau, state.v2)) <= 2.0**-20 < np.abs(state.a).max()
