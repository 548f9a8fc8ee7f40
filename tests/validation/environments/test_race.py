"""Races: sides are checked before they are timed, and every side computes what native C does."""

from __future__ import annotations

import itertools
from functools import partial

import pytest

from validation.environments import race
from validation.environments.in_casadi import CASADI
from validation.environments.record import NATIVE, OURS
from validation.environments.sides import Offer, Side, Subject, native
from validation.mechanics.geometry import Array


@pytest.fixture(scope="module")
def subject() -> Subject:
    return Subject.of("planar2R", 3)


def _offer(who: str, results: Array, function: str, states: int) -> Side:
    return Side(who, lambda: None, lambda: results)


def test_a_framework_that_differs_or_fails_is_reported_and_not_timed(
    subject: Subject, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = native(subject, "forward_dynamics", 3).results()
    reported: list[tuple[str, str]] = []

    def broken(function: str, states: int) -> Side:
        raise KeyError("no such\nfunction")

    offers: list[tuple[str, Offer]] = [
        (OURS, partial(_offer, OURS, right)),
        ("coarse", partial(_offer, "coarse", right * (1 + 1e-6))),
        ("narrow", partial(_offer, "narrow", right[:, :1])),
        ("broken", broken),
        ("without", lambda function, states: None),
    ]
    clock = itertools.count(0, 1_000_000)
    monkeypatch.setattr(race, "perf_counter_ns", lambda: next(clock))
    rows = list(race.rows("jax", subject, offers, "forward_dynamics", 3, 2, lambda *said: reported.append(said)))
    assert [row.who for row in rows] == [NATIVE, OURS]
    # Each call takes a millisecond of that clock, so that four are a turn: a quarter of one each, of three states.
    assert all(row.least == pytest.approx(1e6 / 4 / 3) and row.ratio == 1.0 and row.error == 0.0 for row in rows)
    assert [who for who, _ in reported] == ["coarse", "narrow", "broken"]
    assert (
        "1.0e-06" in reported[0][1] and "inf" in reported[1][1] and reported[2][1] == "KeyError: 'no such\\nfunction'"
    )


@pytest.mark.parametrize("states", [1, 3])
def test_casadis_functions_are_native_cs(subject: Subject, states: int) -> None:
    """Ours, and the recursion in its virtual machine: every function of the race."""
    peers = [CASADI.own, next(peer for peer in CASADI.peers if peer.name == "recursion, VM")]
    offers = [(peer.name, peer.offer(subject)) for peer in peers]
    for function in CASADI.functions:
        rows = race.rows("casadi", subject, offers, function, states, 1, pytest.fail)
        assert [row.who for row in rows] == [NATIVE, OURS, "recursion, VM"]
