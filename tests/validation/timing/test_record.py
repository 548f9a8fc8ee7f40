"""Ratios, the best of a peer's ways, growth, targets, and records that parts of runs add to."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.validation.timing.records import entry, made
from validation.timing.record import Record, Wait, as_data, read
from validation.timing.targets import TARGETS, Target, Verdict, verdicts


def test_a_peers_best_is_its_fastest_way_by_the_median() -> None:
    record = Record(
        [
            entry(variant="gcc 12, local", peer_time=900.0),
            entry(variant="clang 19, world", peer_time=700.0),
            entry(variant="clang 19, local", peer_time=750.0),
            entry(peer="mujoco", peer_time=10.0),
        ]
    )
    best, gcc = (record.best("panda", "dynamics", "pinocchio", family) for family in ("", "gcc"))
    assert best is not None and best.variant == "clang 19, world"
    assert gcc is not None and gcc.ratio == 9.0
    assert record.best("panda", "bias", "pinocchio") is None


@pytest.mark.parametrize(("ratio", "words"), [(7.0, "met, 0% above"), (8.4, "met, 20% above"), (6.3, "missed by 10%")])
def test_a_verdict_states_the_margin(ratio: float, words: str) -> None:
    found = Verdict(Target("panda", "dynamics", "pinocchio", 7.0), entry(), ratio)
    assert found.statement == words and found.met == words.startswith("met")


def test_unmeasured_targets_are_not_met() -> None:
    found = verdicts(Record())
    assert len(found) == len(TARGETS)
    assert all(not verdict.met and verdict.statement == "not measured" for verdict in found)


def test_targets_use_the_family_and_the_batch_they_name() -> None:
    record = Record(
        [
            entry(variant=variant, peer_time=time, columns=16.0)
            for variant, time in (("gcc 12, local", 1200.0), ("clang 19, local", 800.0))
        ]
    )
    found = [v for v in verdicts(record) if v.entry is not None]
    ratios = {(v.target.how, v.target.family): v.ratio for v in found}
    assert ratios == {("state by state", ""): 8.0, ("state by state", "gcc"): 12.0, ("batch by columns", ""): 50.0}
    assert {v.by_rows for v in found} == {None, 40.0}


def test_a_record_survives_its_file(tmp_path: Path) -> None:
    record = Record(
        [entry(), entry(batch=None), entry(columns=16.0)],
        [made()],
        [("panda", "bias", "sympy", "too large")],
        [("panda", "bias", "casadi", "no compiler")],
        {"cores": 2},
        [Wait("import symofros", "", 0.15, 0.1), Wait("first M", "panda", 0.3, None)],
    )
    (tmp_path / "timing.json").write_text(json.dumps(as_data(record)))
    assert read(tmp_path / "timing.json") == record


@pytest.mark.parametrize("text", ["", "[]", '{"schema": 1}', "{"])
def test_a_file_of_another_kind_is_an_empty_record(tmp_path: Path, text: str) -> None:
    (tmp_path / "timing.json").write_text(text)
    assert read(tmp_path / "timing.json") == Record()
    assert read(tmp_path / "nowhere.json") == Record()


def test_a_part_replaces_its_own_figures_only() -> None:
    record = Record(
        [entry(), entry(peer="mujoco"), entry(function="bias"), entry("ur5")],
        [made(), made(by="casadi")],
        [("panda", "dynamics", "pinocchio", "no clang")],
    )
    record.forget(["panda"], ["dynamics"], ["pinocchio"])
    assert [(x.model, x.function, x.peer) for x in record.entries] == [
        ("panda", "dynamics", "mujoco"),
        ("panda", "bias", "pinocchio"),
        ("ur5", "dynamics", "pinocchio"),
    ]
    assert [x.by for x in record.costs] == ["casadi"] and not record.skipped
