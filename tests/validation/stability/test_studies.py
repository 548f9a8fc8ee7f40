"""Studies of the atlas against closed forms, written here a second time."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from tests.models import sampled
from validation.stability.catalogue import STUDIES
from validation.stability.closed_loops import baumgarte, four_bars
from validation.stability.flexible import beams
from validation.stability.rigid import light_bodies, stick_slip
from validation.stability.study import Cell, Maps, survey


class CoarseMaps(dict[str, Maps]):
    """Of each study that is asked for."""

    def __missing__(self, name: str) -> Maps:
        self[name] = survey(STUDIES[name], quick=True)
        return self[name]


@pytest.fixture(scope="module")
def maps() -> dict[str, Maps]:
    return CoarseMaps()


JUDGED = ("baumgarte", "stiff_beam", "damped_beam", "light_link")


@pytest.mark.parametrize("name", sampled(JUDGED, JUDGED[2:]))
def test_a_verdict_follows_from_its_maps(maps: dict[str, Maps], name: str) -> None:
    """Maps without a bad run have no edge: words change, and a claim about the edge is missed."""
    study = STUDIES[name]
    flat = {
        key: replace(one, cells=tuple(tuple(Cell(study.bound / 2) for _ in row) for row in one.cells))
        for key, one in maps[name].items()
    }
    verdict, other = study.judge(maps[name]), study.judge(flat)
    assert other.statement != verdict.statement and all(finding.ok for finding in verdict.findings)
    assert not all(finding.ok for finding in other.findings)


# Closed forms, written here a second time.
@pytest.mark.parametrize(("method", "bound"), [("rk4", 2 * math.sqrt(2)), ("semi_implicit_euler", 2.0)])
@pytest.mark.parametrize("modes", [1, 3])
def test_explicit_steps_hold_up_to_the_closed_form(method: str, bound: float, modes: int) -> None:
    k = [1.8751040687, 4.6940911330, 7.8547574382][modes - 1]
    omega = k**2 * math.sqrt(beams.EI / beams.RHO_A)
    below, above = (beams.ring(modes, method, share * bound / omega) for share in (0.997, 1.003))
    assert below.outcome.ok and beams.growth(below) < beams.BOUND
    assert not above.outcome.ok or beams.growth(above) > beams.BOUND


def test_overdamped_modes_bound_the_step_by_the_damping() -> None:
    omega, c = float(beams.frequencies(3)[-1]), 1.0
    assert beams.closed_form(c) == pytest.approx(2.7852936 / (c * omega**2), rel=1e-3)
    assert beams.closed_form(1e-9) == pytest.approx(2 * math.sqrt(2) / omega, rel=1e-3)


@pytest.mark.parametrize(("method", "bound"), [("rk4", 2.7852936), ("euler", 2.0)])
def test_gains_hold_up_to_the_closed_form(method: str, bound: float) -> None:
    h = 1e-4
    held, lost = (baumgarte.swing(method, h, share * bound / h, 1.0) for share in (0.95, 1.01))
    assert held.outcome.ok and baumgarte.violation(held) < baumgarte.BOUND
    assert lost.outcome.kind == "diverged" and "dt below" in lost.outcome.advice


def test_a_light_link_rings_as_the_model_says() -> None:
    m = light_bodies.pendulum(light_bodies.STIFFNESS).with_parameters(m2=1e-4)
    found = sf.modes(m, np.zeros(2)).frequencies[-1]
    assert light_bodies.fastest(1e-4, light_bodies.STIFFNESS) == pytest.approx(float(found), rel=1e-9)


def test_exact_stick_slip_is_a_motion() -> None:
    """Continuous, never backwards, and with the force balance m x'' = k e - F while it slips."""
    t = np.linspace(0.0, 4.0, 400001)
    x = stick_slip.exact(t)
    v = np.gradient(x, t)
    assert np.abs(np.diff(x)).max() < 1e-5 and v.min() > -1e-6
    slipping = (v[2:-2] > 0.01) & (v[:-4] > 0.01) & (v[4:] > 0.01)
    force = stick_slip.SPRING * (stick_slip.PULL * t - x) - stick_slip.DYNAMIC
    np.testing.assert_allclose(np.gradient(v, t)[2:-2][slipping], force[2:-2][slipping], atol=2e-3)


def test_the_row_of_four_bars_keeps_its_energy() -> None:
    (angle, speed), J = four_bars.START, four_bars.inertia(2)
    later = four_bars.exact(2, (0.0, 3.0))[:, -1]
    energy = [J[0] / 2 * w**2 + J[1] * math.sin(a) for a, w in ((angle, speed), later)]
    assert energy[1] == pytest.approx(energy[0], rel=1e-11)
