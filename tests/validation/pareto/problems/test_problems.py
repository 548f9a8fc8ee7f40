"""Problems move alike in every engine, closed forms satisfy their equations, errors are of the motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ellipk

import symofros as sf
from tests.models import sampled
from validation.pareto.front import usable
from validation.pareto.problems import closed_forms, four_bar, robot, soft_pendulum, spin_up
from validation.pareto.race import race
from validation.pareto.report import PROBLEMS


@pytest.mark.parametrize("name", sampled(("arm", "four_bar", "andrews", "walls"), ["four_bar"]))
def test_references_agree_and_sides_give_the_same_motion(name: str) -> None:
    problem = PROBLEMS[name]
    found = race(problem, quick=True)
    assert found.agreement <= problem.trust
    by: dict[str, float] = {}
    for p in usable(found.points):
        by[p.who] = min(by.get(p.who, math.inf), p.error)
    # Every side comes near the reference: they are models of one motion.
    assert by["symofros"] < 1e-4 and all(error < 2e-2 for error in by.values()), by
    assert all(p.seconds > 0 for p in usable(found.points))


def test_closed_forms_are_periodic_and_start_right() -> None:
    period = 4.0 * ellipk(np.sin(0.5) ** 2)
    t = np.array([0.0, period / 4, period / 2, period])
    np.testing.assert_allclose(closed_forms.swinging(1.0, 1.0, t), [1.0, 0.0, -1.0, 1.0], atol=1e-12)
    t = np.linspace(0.0, 1e-4, 3)
    psi = closed_forms.turning(0.3, 2.0, t)
    assert psi[0] == pytest.approx(np.pi) and (psi[2] - psi[0]) / 1e-4 == pytest.approx(0.3, rel=1e-6)


def test_the_closed_form_of_the_four_bar_satisfies_its_equation() -> None:
    solved = four_bar.four_bars.exact(1, tuple(four_bar.TIMES.tolist()))[0]
    assert four_bar.far(solved) < 1e-9 and four_bar.far(solved + 1e-3) == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.slow  # In every run: rods against Exudyn's exact elements.
def test_rods_come_within_a_hundred_thousandth_of_the_references() -> None:
    """The largest shares of deflection, effect of flexibility, length that are left at steps that are fine enough."""
    spun = spin_up.judged_model("rod", spin_up.exact_rod(6, 2)).measured(method="rodas4", rtol=1e-6, atol=1e-8)
    arms = robot.judged_model("rods", sf.compile(robot.rod_robot(5, 2))).measured(method="rodas4", rtol=1e-6, atol=1e-8)
    swung = soft_pendulum.judged_model("rod", soft_pendulum.model(7, 2)).measured(method="rodas4", rtol=1e-6, atol=1e-8)
    assert max(spun.error, arms.error, swung.error) < 1e-5
    floor = soft_pendulum.judged_model("x", soft_pendulum.model(5, theory="second_order"))
    assert not floor.measured(method="dop853", rtol=1e-9).error < 1e-2, "second order does not serve"
