"""Problems move alike in every engine, closed forms satisfy their equations, errors are of the motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ellipk

import symofros as sf
from tests.models import sampled
from validation.adapters.exudyn.steps import Solver
from validation.adapters.exudyn.timed_systems import SlenderBeam, pendulum
from validation.pareto.catalogue import PROBLEMS
from validation.pareto.front import usable
from validation.pareto.problems import closed_forms, four_bar, robot, rod, soft_pendulum, spin_up
from validation.pareto.problems import pendulum as swing
from validation.pareto.race import race


@pytest.mark.parametrize("name", sampled(("arm", "four_bar", "andrews"), ["four_bar"]))
def test_references_agree_and_sides_move_alike(name: str) -> None:
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


def test_closed_form_of_the_four_bar_against_its_equation() -> None:
    solved = four_bar.four_bars.exact(1, tuple(four_bar.TIMES.tolist()))[0]
    assert four_bar.far(solved) < 1e-9 and four_bar.far(solved + 1e-3) == pytest.approx(1e-3, rel=1e-6)


def test_the_chain_of_links_converges_with_the_square_of_their_length() -> None:
    soft = SlenderBeam(1.0, 1.0, 1e6, 1.0, 2.0, 2.0)
    t = np.linspace(0.0, 2.0, 21)
    fine = rod.linked(soft, t, 24)
    errors = [float(np.abs(rod.linked(soft, t, n) - fine).max()) for n in (3, 6)]
    assert 3.0 < errors[0] / errors[1] < 6.0
    assert float(np.abs(rod.tip(soft, t, 6) - fine).max()) < errors[1] / 3.0


@pytest.mark.slow  # In every run: rods against Exudyn's exact elements.
def test_rods_come_within_a_hundred_thousandth_of_the_references() -> None:
    """The largest shares of deflection, effect of flexibility, length that are left at steps that are fine enough."""
    spun = spin_up.judged_model("rod", spin_up.exact_rod(6, 2)).measured(method="rodas4", rtol=1e-6, atol=1e-8)
    arms = robot.judged_model("rods", sf.compile(robot.of_rods(5, 2))).measured(method="rodas4", rtol=1e-6, atol=1e-8)
    swung = soft_pendulum.judged_model("rod", soft_pendulum.model(7, 2)).measured(method="rodas4", rtol=1e-6, atol=1e-8)
    assert max(spun.error, arms.error, swung.error) < 1e-5
    floor = soft_pendulum.judged_model("x", soft_pendulum.model(5, theory="second_order"))
    assert not floor.measured(method="dop853", rtol=1e-9).error < 1e-2, "second order does not serve"


def test_exudyn_and_the_closed_form_of_the_pendulum() -> None:
    recorded = pendulum(swing.GRAVITY).run(Solver("RK67"), 0.02, 5.0, 1.0)
    exact = np.pi / 2 + closed_forms.swinging(-np.pi / 2, swing.GRAVITY, np.arange(6.0))
    np.testing.assert_allclose(recorded.values[:, 0], exact, atol=1e-8)
    assert recorded.seconds > 0 and recorded.t.tolist() == pytest.approx(list(range(6)))
