"""Scores of faults, of synthetic cells; and what other test suites print."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from validation.engines.verdicts import Cell, Verdict
from validation.faults.entry import Fault, Subject, faults
from validation.faults.environment import NotAskedError
from validation.recall import suites
from validation.recall.report import TOPIC
from validation.recall.scoring import LOST, Scored, Stated, has, scored

FAULT = replace(
    faults()["dart_inverse_mass_of_weld"],
    name="some",
    engine="toy",
    wrong="1.0",
    right="2.0",
    kind="dynamics",
    fault="getInvMassMatrix loses what zebras transmit.",
    subject=Subject(["getInvMassMatrix"], []),
    script="import toy\ntoy.set_up()\nprint(toy.getInvMassMatrix())",
)
NATIVES = {"mass_matrix_inverse": "getInvMassMatrix", "bias": "h", "link_poses": "set_up"}


def cells(**verdicts: Verdict) -> list[Cell]:
    """Cells on one tree; "__" in a name of a function is a tree's name after it."""
    named = {name.partition("__"): verdict for name, verdict in verdicts.items()}
    return [Cell("toy", model or "chain", function, verdict) for (function, _, model), verdict in named.items()]


def score(wrong: list[Cell], right: list[Cell] | None, fault: Fault = FAULT, explained: str = "") -> Scored:
    return scored(fault, wrong, right, NATIVES, lambda group: explained)


@pytest.mark.parametrize(
    "wrong, right, wanted, shows",
    [
        ({"mass_matrix_inverse": "wrong"}, {"mass_matrix_inverse": "right"}, "hit", [True]),
        ({"bias": "wrong"}, {"bias": "right"}, "miss", [False]),
        ({"link_poses": "wrong"}, {"link_poses": "right"}, "miss", [False]),
        ({"sizes__a zebra": "crashes"}, {}, "miss", [False]),
        ({"bias": "wrong", "mass_matrix_inverse__tree": "wrong"}, {}, "hit", [True, False]),
        ({"mass_matrix_inverse": "wrong"}, {"mass_matrix_inverse": "wrong"}, "miss", []),
        ({"mass_matrix_inverse": "wrong"}, {"mass_matrix_inverse": "imprecise"}, "hit", [True]),
        ({"mass_matrix_inverse": "imprecise"}, {"mass_matrix_inverse": "right"}, "half a hit", [True]),
        ({"mass_matrix_inverse": "plug-in"}, {"mass_matrix_inverse": "right"}, "miss", []),
        ({"mass_matrix_inverse": "refuses"}, {"mass_matrix_inverse": "right"}, "miss", []),
        ({"bias": "wrong"}, None, "miss", [False]),
        ({"mass_matrix_inverse": "raises"}, None, "hit", [True]),
    ],
)
def test_a_score_follows_from_what_is_new_at_the_wrong_release(
    wrong: dict[str, Verdict], right: dict[str, Verdict] | None, wanted: str, shows: list[bool]
) -> None:
    fault = FAULT if right is not None else replace(FAULT, right=None)
    found = score(cells(**wrong), None if right is None else cells(**right), fault)
    assert (found.score, [one.shows for one in found.groups]) == (wanted, shows)


def test_a_hit_among_twenty_groups_is_half_a_hit() -> None:
    many = [Cell("toy", f"tree {k}", f"link_poses:{k}", "wrong") for k in range(LOST)]
    found = score([*many, *cells(mass_matrix_inverse="wrong")], [])
    assert found.score == "half a hit" and "lost among" in found.why and found.groups[0].shows


def test_operations_on_all_trees_of_a_group_are_called() -> None:
    fault = replace(FAULT, subject=Subject(["appendModel"], []))
    trees = {"attached chain": Stated("appendModel"), "chain": Stated()}

    def of(*models: str) -> str:
        wrong = [Cell("toy", model, "bias", "wrong") for model in models]
        return scored(fault, wrong, [], NATIVES, lambda group: "", trees=trees).score

    assert of("attached chain") == "hit"
    assert of("chain") == of("attached chain", "chain") == of("another") == "miss"


def test_a_tree_is_known_by_what_the_engine_calls_its_constraints() -> None:
    fault = replace(FAULT, subject=Subject(["getInvMassMatrix"], ["connect"]))
    trees = {"point": Stated(called="equality/connect"), "weld": Stated(called="equality/weld")}

    def of(model: str) -> str:
        wrong = [Cell("toy", model, "mass_matrix_inverse", "wrong")]
        return scored(fault, wrong, [], NATIVES, lambda group: "", trees=trees).score

    assert of("point") == "hit" and of("weld") == of("chain") == "miss"


def test_a_name_is_whole() -> None:
    """What begins as the subject does is another function; the matrix's own name will do, whatever the way to it."""
    for named, wanted in (("getInvMass", "miss"), ("mass_matrix_inverse", "hit")):
        fault = replace(FAULT, subject=Subject([named], []))
        assert score(cells(mass_matrix_inverse="wrong"), [], fault).score == wanted


def test_most_trees_of_a_group_are_those_that_a_fault_shows_in() -> None:
    fault = replace(FAULT, subject=Subject(["getInvMassMatrix"], ["damped ball", "weld"]))

    def of(*models: str) -> str:
        return score([Cell("toy", model, "mass_matrix_inverse", "wrong") for model in models], [], fault).score

    assert of("a Damped ball") == of("a damped ball", "hinge") == of("welds", "damped balls", "hinge") == "hit"
    assert of("hinge") == of("a damped ball", "hinge", "slide") == of("unwelded") == "miss"


@pytest.mark.parametrize(
    "kind, words, model, wanted",
    [
        ("reader", [], "mjcf: plain", "hit"),
        ("reader", [], "urdf: plain", "miss"),
        ("reader", [], "chain", "miss"),
        ("reader", ["stripes"], "mjcf: stripes", "hit"),
        ("reader", ["stripes"], "mjcf: spots", "miss"),
        ("reader", ["stripes"], "urdf: stripes", "miss"),
        ("reader", ["stripes"], "stripes in a row", "hit"),
        ("writer", ["stripes"], "mjcf: stripes, written", "hit"),
        ("writer", ["stripes"], "mjcf: stripes", "miss"),
        ("dynamics", [], "urdf: plain", "hit"),
    ],
)
def test_a_reader_is_seen_in_files_of_its_format_that_have_its_subject(
    kind: str, words: list[str], model: str, wanted: str
) -> None:
    of_files = replace(FAULT, kind=kind, subject=Subject([], words), script='import toy\ntoy.read("<mujoco/>")')
    assert score([Cell("toy", model, "bias", "wrong")], [], of_files).score == wanted


def test_red_cells_of_the_right_release_alone_are_false_alarms_unless_explained() -> None:
    seen, alarm = cells(mass_matrix_inverse="wrong", bias="right"), cells(mass_matrix_inverse="right", bias="wrong")
    assert len(score(seen, alarm).alarms) == 1 and not score(seen, alarm, explained="known").alarms
    assert not score(cells(bias="refuses"), alarm).alarms, "the wrong release gave no answer to compare with"


def test_a_release_has_a_fault_until_the_first_that_is_right() -> None:
    assert has(FAULT, "1.9.12") and not has(FAULT, "2.0") and not has(FAULT, "10.0")
    assert has(replace(FAULT, right=None), "99")


def test_a_suite_says_what_is_red_line_by_line() -> None:
    text = "1..3\nok 1 - masses\nnot ok 2 - test_getInvMassMatrix\nPASSED test_a.py::test_b\nFAILED a.py::c - no\nx ok"
    found = {cell.function: cell.verdict for cell in suites.read(text, "toy")}
    wanted = {"masses": "right", "test_getInvMassMatrix": "wrong", "test_a.py::test_b": "right", "a.py::c": "wrong"}
    assert found == wanted


def test_a_suite_is_run_with_the_release_s_python() -> None:
    python = Path(sys.executable)
    command = "{python} -c \"print('not ok {engine} {version} getInvMassMatrix')\""
    wrong = suites.asked(command, python, "toy", "1.0")
    assert [cell.function for cell in wrong] == ["toy 1.0 getInvMassMatrix"]
    found = scored(FAULT, wrong, [], {}, lambda group: "", suites.apart)
    assert (found.score, found.groups[0].shows) == ("hit", True)
    for silent in ("{python} -c pass", "no-such-program"):
        with pytest.raises(NotAskedError, match="prints 'ok NAME'"):
            suites.asked(silent, python, "toy", "1.0")


def test_the_report_counts_each_half() -> None:
    stated = {name: getattr(FAULT, name) for name in ("name", "engine", "wrong", "right", "kind", "thread")}
    spent = {"what": FAULT.fault, "minutes": 0.5, "memory": 90, "disk": 300, "cells": 5}
    hit = score(cells(mass_matrix_inverse="wrong"), cells(mass_matrix_inverse="right"))
    rows = [
        stated | spent | hit.row() | {"frozen": True},
        stated | spent | Scored("miss", "nothing new is red").row() | {"name": "other", "frozen": True},
        stated | spent | Scored("not asked", "no wheels").row() | {"name": "third", "frozen": False, "right": None},
    ]
    data = {"faults": rows, "failures": {}, "unfinished": [], "suite": "", "smoke": False, "half": "all"}
    report = TOPIC.compose(data)
    assert report.ok is False and "1 of 2 of the frozen set; 0 of 1 of the working set" in report.summary
    assert TOPIC.compose(data | {"faults": rows[:1]}).ok is True
