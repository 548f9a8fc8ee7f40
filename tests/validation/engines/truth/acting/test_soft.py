"""Truths of soft limits and dry friction: a row alone in closed form, several by the conditions that they meet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from validation.engines.interface import Slot
from validation.engines.models import soft as models
from validation.engines.proving.pieces import Layout
from validation.engines.truth.acting import soft
from validation.engines.truth.dynamics import Point, Truth, digits, random_state

_CHARTS = {"revolute": "angle", "prismatic": "length"}
_B, _K = 2.0 / (0.95 * 0.02), 1.0 / (0.95 * 0.02) ** 2


def _truth(name: str) -> tuple[Truth, Point, tuple[np.ndarray, np.ndarray]]:
    """Truth, state, accelerations and forces of rows along the speeds."""
    tree = models.trees()[name]
    n = len(tree.links)
    layout = Layout(n, n, tuple((Slot(_CHARTS[x.joints[0].kind], (k,), (k,)),) for k, x in enumerate(tree.links)))
    truth, state = Truth(tree, layout), random_state(tree, layout, 5)
    s = Point.of(replace(state, tau=4.0 * state.tau))
    return truth, s, (digits(truth.value(soft.acceleration, s)), digits(truth.value(soft.forces, s)))


@pytest.mark.parametrize("name", models.trees())
def test_forces_make_the_accelerations(name: str) -> None:
    truth, s, (a, f) = _truth(name)
    M, h = (digits(truth.value(of, s)) for of in (lambda t, s: t.M(s.q), lambda t, s: t.h(s.q, s.v)))
    passive = digits(truth.value(lambda t, s: t.own.applied(s.q, s.v), s))
    np.testing.assert_allclose(M @ a + h, digits(s.tau) + passive + f, atol=1e-10)


@pytest.mark.parametrize(("name", "limit"), [("hinge below its limit", 4.0), ("hinge within its limits", None)])
def test_a_limit_alone_is_a_spring_of_its_impedance(name: str, limit: float | None) -> None:
    """(M + M d / (1 - d)) a = tau - h + M d / (1 - d) aref, with d = 0.95 beyond a millimetre."""
    truth, s, ((a,), (f,)) = _truth(name)
    if limit is None:
        assert f == 0.0
        return
    (M,), h = digits(truth.M(s.q)), digits(truth.value(lambda t, s: t.h(s.q, s.v), s))[0]
    q, v, tau = (float(x[0]) for x in (s.q, s.v, s.tau))
    aref = -_B * v - _K * 0.95 * (q - limit)
    assert a == pytest.approx(0.05 * (tau - h) / M[0] + 0.95 * aref, rel=1e-9)


def test_dry_friction_stays_within_its_bound() -> None:
    _, _, (_, (f,)) = _truth("hinge with dry friction")
    assert abs(f) == pytest.approx(0.25)
    _, _, ((a,), (f,)) = _truth("slide with much dry friction")
    assert abs(f) <= 64.0 and abs(a) < 1e3


def test_floors_lift_balls_that_are_below_them() -> None:
    """The forces along the speeds are those of the balls' heights; what is above its floor feels none."""
    truth, s, (_, f) = _truth("balls below floors and above one")
    forces = truth.value(soft.floor_forces, s)
    assert [force > 0 for force in forces] == [True, False, True] and forces[1] == 0
    heights = [truth.kinematics.held(s.q, one.ends[0]).J[2] for one in truth.tree.constraints]
    np.testing.assert_allclose(f, digits(sum(J * force for J, force in zip(heights, forces, strict=True))), rtol=1e-12)
