"""Races: sides are checked before they are timed, and every side computes what native C does."""

from __future__ import annotations

import itertools
from functools import partial

import numpy as np
import pytest

from validation.environments import race, sides
from validation.environments.in_casadi import CASADI
from validation.environments.record import NATIVE, OURS
from validation.environments.sides import Offer, Side, Subject, native
from validation.mechanics.geometry import Array


@pytest.fixture(scope="module")
def subject() -> Subject:
    return Subject.of("planar2R", 3)


@pytest.mark.parametrize("states", [1, 3])
def test_native_gradients_are_those_of_native_derivatives(subject: Subject, states: int) -> None:
    for base in ("forward_dynamics", "inverse_dynamics"):
        slopes = native(subject, f"{base}_derivatives", states).results().reshape(states, 3, 2, 2)
        gradient = native(subject, f"{base}_vjp", states).results().reshape(states, 3, 2)
        np.testing.assert_allclose(np.einsum("nkij,ni->nkj", slopes, subject.cotangent[:states]), gradient, rtol=1e-12)


def test_native_derivatives_are_those_of_the_native_function(subject: Subject) -> None:
    for base in ("forward_dynamics", "inverse_dynamics"):
        slopes = native(subject, f"{base}_derivatives", 3).results().reshape(3, 3, 2, 2)
        value, h = native(subject, base, 3).results(), 1e-6
        for k, name in enumerate(("q", "v", "w")):
            for j in range(2):
                moved = Subject(**{**vars(subject), name: getattr(subject, name) + h * np.eye(2)[j]})
                change = (native(moved, base, 3).results() - value) / h
                np.testing.assert_allclose(slopes[:, k, :, j], change, rtol=1e-4, atol=1e-4)


def _offer(who: str, results: Array, function: str, states: int) -> Side:
    return Side(who, lambda: None, lambda: results)


def test_a_side_that_differs_or_fails_is_told_and_not_timed(subject: Subject, monkeypatch: pytest.MonkeyPatch) -> None:
    right = native(subject, "forward_dynamics", 3).results()
    told: list[tuple[str, str]] = []

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
    rows = list(race.rows("jax", subject, offers, "forward_dynamics", 3, 2, lambda *said: told.append(said)))
    assert [row.who for row in rows] == [NATIVE, OURS]
    # Each call takes a millisecond of that clock, so that four are a turn: a quarter of one each, of three states.
    assert all(row.least == pytest.approx(1e6 / 4 / 3) and row.ratio == 1.0 and row.error == 0.0 for row in rows)
    assert [who for who, _ in told] == ["coarse", "narrow", "broken"]
    assert "1.0e-06" in told[0][1] and "inf" in told[1][1] and told[2][1] == "KeyError: 'no such\\nfunction'"


def test_readers_of_urdf_find_an_inertia_in_every_link(subject: Subject) -> None:
    text = subject.urdf()
    assert text.count("<link ") == text.count("<inertial>") and '<mass value="1"/>' in text


@pytest.mark.parametrize("states", [1, 3])
def test_casadis_functions_are_native_cs(subject: Subject, states: int) -> None:
    """Ours, and the recursion in its virtual machine: every function of the race."""
    peers = [CASADI.own, next(peer for peer in CASADI.peers if peer.name == "recursion, VM")]
    offers = [(peer.name, peer.offer(subject)) for peer in peers]
    for function in CASADI.functions:
        rows = race.rows("casadi", subject, offers, function, states, 1, pytest.fail)
        assert [row.who for row in rows] == [NATIVE, OURS, "recursion, VM"]


def test_a_derivative_is_of_its_function() -> None:
    assert sides.plain("forward_dynamics_vjp") == "forward_dynamics"
    assert sides.plain("inverse_dynamics") == "inverse_dynamics" and sides.plain("dynamics") == "dynamics"
