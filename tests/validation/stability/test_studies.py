"""Studies of the atlas against closed forms, written here a second time."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from tests.models import sampled
from validation.stability.catalogue import STUDIES
from validation.stability.closed_loops import baumgarte
from validation.stability.flexible import beams
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


@pytest.mark.parametrize(("method", "bound"), [("rk4", 2.7852936), ("euler", 2.0)])
def test_gains_hold_up_to_the_closed_form(method: str, bound: float) -> None:
    h = 1e-4
    held, lost = (baumgarte.swing(method, h, share * bound / h, 1.0) for share in (0.95, 1.01))
    assert held.outcome.ok and baumgarte.violation(held) < baumgarte.BOUND
    assert lost.outcome.kind == "diverged" and "dt below" in lost.outcome.advice
