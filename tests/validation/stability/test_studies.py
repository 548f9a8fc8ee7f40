"""Studies of the atlas against closed forms, written here a second time."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from tests.models import sampled
from validation.adapters.exudyn import contact as exudyn_contact
from validation.stability.closed_loops import baumgarte
from validation.stability.contact import bounces, impact, incline
from validation.stability.flexible import beams
from validation.stability.report import STUDIES
from validation.stability.study import Cell, Maps, survey


class CoarseMaps(dict[str, Maps]):
    """Coarse maps of each study that is asked for."""

    def __missing__(self, name: str) -> Maps:
        self[name] = survey(STUDIES[name], quick=True)
        return self[name]


@pytest.fixture(scope="module")
def maps() -> dict[str, Maps]:
    return CoarseMaps()


JUDGED = ("baumgarte", "stiff_beam", "damped_beam", "light_link", "incline", "impact", "bounces", "touching", "strikes")


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


@pytest.mark.parametrize(("method", "bound"), [("rk4", 2.7852936), ("euler", 2.0)])
def test_gains_hold_up_to_the_closed_form(method: str, bound: float) -> None:
    h = 1e-4
    held, lost = (baumgarte.swing(method, h, share * bound / h, 1.0) for share in (0.95, 1.01))
    assert held.outcome.ok and baumgarte.violation(held) < baumgarte.BOUND
    assert lost.outcome.kind == "diverged" and "dt below" in lost.outcome.advice


@pytest.mark.parametrize(("k", "h"), [(1e4, 1e-3), (1e6, 3e-4), (1e6, 3e-3)])
def test_a_penalty_by_semi_implicit_steps_is_mujocos_stiff_contact(k: float, h: float) -> None:
    ours = impact.off(float(impact.thrown("semi_implicit_euler", k, h).v[-1, 0]))
    assert ours == pytest.approx(impact.by_mujoco(k, h).value, rel=1e-3, abs=1e-12)


def test_smooth_friction_creeps_where_its_polynomial_carries_the_load() -> None:
    """Up to half of the limit it is all but linear: 15/8 of the load's share, over 15/8 of the speed."""
    assert incline.creep(0.01) == pytest.approx(0.01 * incline.SLOW, rel=1e-4)
    assert incline.creep(1 - 1e-9) == pytest.approx(15 / 8 * incline.SLOW, rel=2e-3)
    assert incline.beyond(1.1, (0.2, 0.3), 0.2 + 3.0 + 50 * 0.1 * 0.5 * 9.81 / math.hypot(1, 0.55)) < 1e-12


def test_exudyns_block_creeps_by_the_share_of_its_zone_of_speeds() -> None:
    gx, gz = incline.gravity(0.6)
    (x, v), (later, _) = exudyn_contact.slid(0.5, 0.1, 1e5, (gx, gz), 1e-3, (0.5, 1.0))
    assert v == pytest.approx(0.6e-3, rel=1e-9) and later - x == pytest.approx(0.5 * v, rel=1e-9)


def test_bounces_are_those_of_a_geometric_series() -> None:
    fall = math.sqrt(2 / 9.81)
    assert bounces.instant(1, 0.5) == pytest.approx(fall) and bounces.instant(3, 0.5) == pytest.approx(2.5 * fall)
    assert bounces.accumulation(0.5) == pytest.approx(bounces.instant(200, 0.5))
    assert len(bounces.stepped(0.5)) > 5 and bounces.stepped(0.5)[0] == pytest.approx(fall, abs=2e-3)
