"""Each verdict of the dashboard can turn bad."""

from __future__ import annotations

import math
from typing import Any

import pytest

from validation.dashboard.card import chart_of, counted
from validation.dashboard.catalogue import TOPICS

COMPARISON = {"model": "arm", "engine": "pinocchio", "quantity": "bias", "error": 1e-14, "tolerance": 1e-12, "ok": True}
CHECK: dict[str, Any] = {"ok": True, "comparisons": [COMPARISON], "models": [{}], "settings": {"states": 10}}
GROUP = {"agree": True, "error": 1e-14, "tolerance": 1e-12}
CAMPAIGN: dict[str, Any] = {
    "ok": True,
    "states": 100_000,
    "models": 30,
    "groups": [GROUP],
    "effort": {"sessions": 3, "seconds": 200.0, "executions": 210, "repeated": [4]},
}
MODEL = {"model": "arm", "planted": 10, "silent": 1, "too_small": 1, "survived": []}
MUTATION: dict[str, Any] = {"ok": True, "planted": 10, "models": [MODEL]}
ORACLE: dict[str, Any] = {"ok": True, "comparisons": [{"model": "arm", "digits": {"M": 28.0}, "required": 25.0}]}
STUDY = {"title": "Is it?", "ok": True, "checks": [{"ok": True}], "figures": []}
ACCURACY: dict[str, Any] = {"ok": True, "quick": False, "studies": {"one": STUDY}}
SCENE = {"ok": True, "checks": [{"ok": True}], "maps": {"m": {"values": [[1.0, 2.0]]}}}
STABILITY: dict[str, Any] = {"ok": True, "quick": True, "scenes": {"one": SCENE}}
ENTRY = {
    "model": "arm",
    "nv": 7,
    "function": "mass_matrix",
    "peer": "pinocchio",
    "theirs": [300.0, 310.0],
    "ratio": 3.0,
}
TIMING: dict[str, Any] = {"entries": [ENTRY, ENTRY | {"theirs": [400.0, 410.0], "ratio": 4.0}], "failed": []}
RACE = {"scene": "arm", "engine": "MuJoCo", "theirs": {"how": "RK4"}, "ratio": 9.3, "real_time": 1000.0}
SIMULATION: dict[str, Any] = {"races": [RACE], "iftomm": [{"error": 1e-9, "threshold": 1e-5}]}


@pytest.mark.parametrize(
    ("name", "data", "says"),
    [
        ("check", CHECK, "1 comparison of 1 model: all agree."),
        ("campaign", CAMPAIGN, "100 000 states of 30 models, 1 comparison: all agree."),
        ("mutation", MUTATION, "8 of 8 faults that matter are caught, in 1 model."),
        ("oracle", ORACLE, "1 derivation by SymPy of 1 model: all agree."),
        ("accuracy", ACCURACY, "1 number on 1 question: all within their bounds."),
        ("stability", STABILITY, "1 claim about 1 scene: all within their bounds (quick variant)."),
        ("simulation", SIMULATION, "Motions run up to 1000 times real time; 1 race at equal accuracy."),
    ],
)
def test_a_good_report(name: str, data: dict[str, Any], says: str) -> None:
    card = TOPICS[name].read(data)
    assert card.ok and card.headline == says and not any(fact.ok is False for fact in card.facts)


@pytest.mark.parametrize(
    ("name", "data", "says"),
    [
        ("check", CHECK | {"ok": False, "comparisons": [COMPARISON | {"ok": False, "error": None}]}, "1 do not agree"),
        ("campaign", CAMPAIGN | {"ok": False, "groups": [GROUP | {"agree": False}]}, "1 do not agree"),
        ("mutation", MUTATION | {"ok": False, "models": [MODEL | {"survived": [1]}]}, "7 of 8 faults"),
        ("oracle", ORACLE | {"ok": False}, "not all agree"),
        (
            "accuracy",
            {"ok": False, "studies": {"one": STUDY | {"ok": False, "checks": [{"ok": False}]}}},
            "1 out of bounds",
        ),
        ("stability", {"ok": False, "scenes": {"one": SCENE | {"checks": [{"ok": False}]}}}, "1 out of bounds"),
    ],
)
def test_a_bad_report(name: str, data: dict[str, Any], says: str) -> None:
    card = TOPICS[name].read(data)
    assert card.ok is False and says in card.headline


def test_a_benchmark_beyond_its_threshold_is_bad() -> None:
    card = TOPICS["simulation"].read(SIMULATION | {"iftomm": [{"error": 1e-3, "threshold": 1e-5}]})
    assert card.ok is False and card.facts[-1].ok is False


def test_a_race_counts_against_the_fastest_build_of_a_peer() -> None:
    card = TOPICS["timing"].read(TIMING)
    assert card.headline == "1 race over 1 model and 1 function; median of their time over ours: pinocchio 3×."
    assert card.ok is None
    assert card.facts[0].value == "3×"
    assert TOPICS["timing"].read(TIMING | {"failed": [1]}).ok is False


def test_speed_against_accuracy_counts_its_targets() -> None:
    point = {"who": "symofros", "seconds": 1e-3, "error": 1e-2}
    lost = {"who": "Exudyn", "seconds": 1e-3, "error": None}
    met, missed = {"found": 400.0, "ok": True}, {"found": None, "ok": False}
    scene = {"title": "t", "targets": [met, missed], "points": [point, point, lost]}
    card = TOPICS["pareto"].read({"ok": False, "scenes": {"a": scene}})
    assert card.ok is False
    assert card.headline == "1 of 2 targets met, in 1 scene."
    assert [curve.label for curve in card.charts[0].curves] == ["symofros"]
    assert len(card.charts[0].curves[0].x) == 2


def test_a_chart_of_an_older_layout_gets_the_axes_that_suit_it() -> None:
    curve = {"label": "a", "x": [1.0, 2.0], "y": [1e-8, None]}
    chart = chart_of({"title": "t", "x": "n", "y": "e", "curves": [curve, curve | {"y": [1.0, 1.0]}]})
    assert (chart.log_x, chart.log_y) == (False, True) and math.isnan(chart.curves[0].y[1])
    assert not chart_of({"title": "t", "x": "n", "y": "e", "log": [False, False], "curves": [curve]}).log_y


@pytest.mark.parametrize(
    ("number", "says"), [(0, "0 runs"), (1, "1 run"), (9999, "9999 runs"), (1234567, "1 234 567 runs")]
)
def test_numbers_are_read_with_ease(number: int, says: str) -> None:
    assert counted(number, "run") == says
