"""A study tells what a judge sees, keeps what it knows, and leaves the copy of the tree as it was."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from validation.mutation import overlay as overlays
from validation.mutation.fault import SIGN, SourceFault
from validation.mutation.overlay import Overlay
from validation.mutation.report import as_data, compose
from validation.mutation.study import CHECK, LONGER, OUTPUTS, TESTS, Store, Study, argued_faults
from validation.mutation.tests_judge import _GENERAL, _MIRRORS

ROOT = Path(__file__).parents[3]
IDENTITY = Path("symofros", "runtime", "build", "identity.py")
JUDGE = """
import os, time
from symofros.sum import total
def ask(**given):
    if given.get("hang"): time.sleep(60)
    if given.get("crash"): os.abort()
    return {"total": total(2, 1), **given}
"""


@pytest.fixture
def overlay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A tree of one module and one judge."""
    root = tmp_path / "root"
    (root / "symofros").mkdir(parents=True)
    (root / "symofros" / "sum.py").write_text("def total(a, b):\n    return a - -b\n")
    (root / "judge.py").write_text(JUDGE)
    (root / IDENTITY).parent.mkdir(parents=True)
    (root / IDENTITY).write_bytes((ROOT / IDENTITY).read_bytes())
    monkeypatch.setattr(overlays, "PRELOADED", ())
    monkeypatch.setattr(overlays, "COPIED", ("symofros", "judge.py"))
    made = Overlay(root, tmp_path / "work")
    yield made
    made.close()


FAULT = SourceFault("symofros/sum.py", 2, SIGN, 32, "-b", "b")


def test_a_fault_is_there_while_it_is_planted_and_only_then(overlay: Overlay) -> None:
    def total() -> Any:
        return overlay.ask("judge", "ask", 20.0)["answer"]["total"]

    assert total() == 3
    with overlay.planted(FAULT):
        assert total() == 1
    assert total() == 3
    assert not (overlay.tree.parent / "root" / "symofros" / "__pycache__").exists()


@pytest.mark.slow
def test_a_crash_and_a_hang_are_answers(overlay: Overlay) -> None:
    assert overlay.ask("judge", "ask", 20.0, crash=True)["fate"] == "crashed"
    assert overlay.ask("judge", "ask", 0.5, hang=True)["fate"] == "timed out"
    assert overlay.ask("judge", "no_such", 20.0)["answer"]["status"] == "raised"


def test_the_fault_of_a_killed_study_is_taken_out_by_the_next(overlay: Overlay, tmp_path: Path) -> None:
    sound = (overlay.tree / FAULT.module).read_text()
    planted = overlay.planted(FAULT)
    planted.__enter__()  # And never left, as where the process is killed.
    assert (overlay.tree / FAULT.module).read_text() != sound
    other = Overlay(tmp_path / "root", tmp_path / "work")
    other.close()
    assert (overlay.tree / FAULT.module).read_text() == sound


@pytest.mark.filterwarnings("ignore::symofros.errors.StoredStateWarning")
def test_answers_outlive_the_process_but_not_the_text_that_they_are_about(tmp_path: Path) -> None:
    (tmp_path / "m.py").write_text("a = 1\n")
    store = Store(tmp_path / "answers.jsonl", tmp_path)
    store.put("m.py:1", CHECK, {"fate": "answered"}, "m.py")
    with store.path.open("a") as stream:
        stream.write('{"id": "m.py:1", "sta')  # Killed while it wrote.
    assert Store(store.path, tmp_path).get("m.py:1", CHECK) == {"fate": "answered"}
    (tmp_path / "m.py").write_text("a = 2\n")
    assert Store(store.path, tmp_path).get("m.py:1", CHECK) is None


def answered(answer: Any) -> dict[str, Any]:
    return {"fate": "answered", "answer": answer, "seconds": 1.0}


def a_study(folder: Path, count: int) -> Study:
    """A study of so many faults, none of which is judged yet."""
    (folder / "m.py").write_text("a\n")
    faults = tuple(SourceFault("m.py", line, SIGN, 0, "a", "b") for line in range(count))
    return Study(faults, Store(folder / "answers.jsonl", folder), None, folder, lambda _: None)


def test_scores_count_faults_that_change_a_result(tmp_path: Path) -> None:
    passed, failed = {"status": "passed", "whole": True}, {"status": "failed", "test": "t"}
    answers = {  # check, tests, outputs
        "seen by check": ({"status": "disagreed"}, None, None),
        "seen by tests": (passed, failed, {"status": "changed"}),
        "survived": (passed, passed, {"status": "changed"}),
        "nothing changed": (passed, passed, {"status": "same bits"}),
        "open": (passed, None, {"status": "changed"}),
        "out of time": (passed, {"status": "passed", "whole": False}, {"status": "changed"}),
    }
    study = a_study(tmp_path, len(answers))
    for fault, given in zip(study.faults, answers.values(), strict=True):
        for stage, answer in zip((CHECK, TESTS, OUTPUTS), given, strict=True):
            if answer is not None:
                study.store.put(fault.id, stage, answered(answer), "m.py")
    data = json.loads(json.dumps(as_data(study)))
    # The first fault alone is of the sample.
    scores = {"matter": 3, "check": 1.0, "check_asked": 1, "tests": 0.0, "tests_asked": 0, "both": 2 / 3}
    assert data["scores"] == scores
    report = compose(data)
    assert not data["ok"] and "What survived" in {section.title for section in report.sections}


@pytest.mark.parametrize(
    ("ends", "expected"),
    [
        # A crash of check is a failed row of it, and no end is no verdict.
        ({CHECK: ("crashed", -11)}, "caught"),
        ({CHECK: ("crashed", -6)}, "caught"),
        ({CHECK: ("crashed", -7)}, "halted"),
        ({CHECK: ("timed out", -24)}, "halted"),
        # Tests that end twice by the same signal crash by the fault; a test without end is no verdict.
        ({TESTS: ("crashed", -7)}, "open"),
        ({TESTS: ("crashed", -7), LONGER: ("crashed", -7)}, "caught"),
        ({TESTS: ("crashed", -7), LONGER: ("crashed", -9)}, "open"),
        ({TESTS: ("crashed", 77)}, "halted"),
    ],
)
def test_runs_ended_by_a_signal_or_timeout_are_classified(
    tmp_path: Path, ends: dict[str, tuple[str, int]], expected: str
) -> None:
    study = a_study(tmp_path, 1)
    (fault,) = study.faults
    for stage in () if CHECK in ends else (CHECK, OUTPUTS):
        study.store.put(fault.id, stage, answered({"status": "passed"}), "m.py")
    for stage, (fate, code) in ends.items():
        study.store.put(fault.id, stage, {"fate": fate, "code": code, "answer": None, "seconds": 1.0}, "m.py")
    assert study.fate(fault) == expected


def test_faults_that_are_argued_are_of_modules_that_exist(tmp_path: Path) -> None:
    assert argued_faults()
    gone = "symofros/results/gone.py:36@1550:comparison:and->or"
    (tmp_path / "argued.json").write_text(json.dumps({gone: "words"}))
    with pytest.raises(sf.SymofrosError, match="no such module") as refused:
        argued_faults(tmp_path / "argued.json")
    assert refused.value.problems[0].found == gone


def test_tests_that_modules_are_judged_by_exist() -> None:
    places = {place for table in (_MIRRORS, _GENERAL) for named in table.values() for place in named}
    assert [place for place in places if not (ROOT / place).exists()] == []
    assert [module for module in (*_MIRRORS, *_GENERAL) if not (ROOT / module).exists()] == []
