"""A study tells what a judge sees, keeps what it knows, and leaves the copy of the tree as it was."""

from __future__ import annotations

import json
import runpy
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

from validation.mutation import overlay as overlays
from validation.mutation.fault import SIGN, SourceFault
from validation.mutation.measure import as_data
from validation.mutation.overlay import Overlay
from validation.mutation.report import compose
from validation.mutation.store import Store
from validation.mutation.study import CHECK, LONGER, LONGER_BUDGET, OUTPUTS, TESTS, TESTS_BUDGET, Study
from validation.mutation.tests_judge import chosen

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
    server = root / "validation" / "mutation" / "server.py"
    server.parent.mkdir(parents=True)
    text = (ROOT / "validation" / "mutation" / "server.py").read_text()
    server.write_text(text.replace(text[text.index("PRELOADED = (") : text.index("MEMORY")], "PRELOADED = ()\n"))
    monkeypatch.setattr(overlays, "COPIED", ("symofros", "validation", "judge.py"))
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


def test_faults_of_the_simulation_alone_leave_the_identity_of_the_copy_as_it_is(overlay: Overlay) -> None:
    package = overlay.tree / "symofros"

    def digest() -> str:
        return str(runpy.run_path(str(overlay.tree / IDENTITY))["source_digest"](package))

    sound = digest()
    (package / "simulation").mkdir()
    (package / "simulation" / "run.py").write_text("step = 1\n")
    assert digest() == sound
    (package / "sum.py").write_text("total = max\n")
    assert digest() != sound


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


def test_scores_count_faults_that_change_a_result(tmp_path: Path) -> None:
    (tmp_path / "m.py").write_text("a\n")
    store = Store(tmp_path / "answers.jsonl", tmp_path)
    passed, failed = {"status": "passed", "whole": True}, {"status": "failed", "test": "t"}
    answers = {  # check, tests, outputs
        "seen by check": ({"status": "disagreed"}, None, None),
        "seen by tests": (passed, failed, {"status": "changed"}),
        "survived": (passed, passed, {"status": "changed"}),
        "nothing changed": (passed, passed, {"status": "same bits"}),
        "open": (passed, None, {"status": "changed"}),
        "out of time": (passed, {"status": "passed", "whole": False}, {"status": "changed"}),
    }
    faults = []
    for line, given in enumerate(answers.values()):
        fault = SourceFault("m.py", line, SIGN, 0, "a", "b")
        faults.append(fault)
        for stage, answer in zip((CHECK, TESTS, OUTPUTS), given, strict=True):
            if answer is not None:
                store.put(fault.id, stage, {"fate": "answered", "answer": answer, "seconds": 1.0}, "m.py")
    study = Study(tuple(faults), store, None, tmp_path, print)  # type: ignore[arg-type]
    data = json.loads(json.dumps(as_data(study)))
    # The first fault alone is of the sample.
    scores = {"matter": 3, "check": 1.0, "check_asked": 1, "tests": 0.0, "tests_asked": 0, "both": 2 / 3}
    assert data["scores"] == scores
    report = compose(data)
    assert not data["ok"] and "What survived" in {section.title for section in report.sections}


def test_each_fault_is_settled_by_the_cheaper_judge_but_for_a_sample(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "m.py").write_text("a\n")
    faults = tuple(SourceFault("m.py", line, SIGN, 0, "a", "b") for line in range(4))
    asked: list[tuple[int, str]] = []
    seen = {(0, CHECK), (1, TESTS), (2, CHECK)}  # And nobody sees the last.

    def judge(stage: str) -> Any:
        def ask(_: Study, fault: SourceFault) -> Any:
            asked.append((fault.line, stage))
            status = "failed" if (fault.line, stage) in seen else "passed"
            return {"fate": "answered", "answer": {"status": status, "whole": True}, "seconds": 1.0}

        return ask

    for name, stage in (("_check", CHECK), ("_test", TESTS), ("_compare", OUTPUTS)):
        monkeypatch.setattr(Study, name, judge(stage))
    monkeypatch.setattr(Study, "_require_sound", lambda _: None)
    untouched = type("Untouched", (), {"planted": lambda _, __: nullcontext()})()
    study = Study(faults, Store(tmp_path / "answers.jsonl", tmp_path), untouched, tmp_path, lambda _: None)
    study.run(60.0)
    ends = [(2, TESTS), (2, CHECK), (3, TESTS), (3, CHECK), (3, OUTPUTS), (0, TESTS)]
    assert asked == [(0, CHECK), (1, TESTS), *ends]


@pytest.mark.parametrize(
    ("module", "first"),
    [
        ("symofros/mechanics/beams/fields.py", "tests/mechanics/beams/test_fields.py"),
        ("symofros/native/stepping/events.c", "tests/simulation/stepping/"),
        # No file of the same name: one with the words of it, which eight smaller files stood before.
        ("symofros/mechanics/dynamics/applied/beam_loads.py", "tests/mechanics/beams/test_loads.py"),
        ("symofros/mechanics/beams/rod_inertia.py", "tests/mechanics/beams/test_rod"),
        ("symofros/native/stepping/axial_loads.c", "tests/simulation/test_"),
    ],
)
def test_the_tests_of_a_module_begin_with_its_mirror(module: str, first: str) -> None:
    assert chosen(ROOT, module)[0].startswith(first)


def test_tests_that_ran_out_of_time_are_given_more_once_all_others_are_settled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "m.py").write_text("a\n")
    faults = tuple(SourceFault("m.py", line, SIGN, 0, "a", "b") for line in range(3))
    asked: list[tuple[int, float]] = []

    def test(_: Study, fault: SourceFault, budget: float = TESTS_BUDGET, limit: float = 0.0) -> Any:
        asked.append((fault.line, budget))
        late = budget > TESTS_BUDGET
        answer = {"status": "failed", "test": "t"} if late and fault.line == 1 else {"status": "passed", "whole": late}
        return {"fate": "answered", "answer": answer, "seconds": 1.0}

    def answers(of: Any) -> Any:
        return lambda _, fault: {"fate": "answered", "answer": {"status": of(fault)}, "seconds": 1.0}

    monkeypatch.setattr(Study, "_check", answers(lambda _: "passed"))
    monkeypatch.setattr(Study, "_test", test)
    monkeypatch.setattr(Study, "_compare", answers(lambda fault: "same bits" if fault.line == 0 else "changed"))
    monkeypatch.setattr(Study, "_require_sound", lambda _: None)
    monkeypatch.setattr(Study, "_fails_without", lambda _, __: False)
    untouched = type("Untouched", (), {"planted": lambda _, __: nullcontext()})()
    study = Study(faults, Store(tmp_path / "answers.jsonl", tmp_path), untouched, tmp_path, lambda _: None)
    study.run(60.0)
    assert asked[3:] == [(1, LONGER_BUDGET), (2, LONGER_BUDGET), (0, LONGER_BUDGET)]
    assert [study.fate(fault) for fault in faults] == ["no result changed", "caught", "survived"]
    study.run(60.0)
    assert len(asked) == 6  # What is still to be seen after that is a survivor.


@pytest.mark.parametrize(
    ("fate", "code", "expected"),
    [("crashed", -11, "caught"), ("crashed", -6, "caught"), ("crashed", -7, "halted"), ("timed out", -24, "halted")],
)
def test_a_crash_of_check_is_a_failed_row_of_it_and_no_end_is_no_verdict(
    tmp_path: Path, fate: str, code: int, expected: str
) -> None:
    (tmp_path / "m.py").write_text("a\n")
    store, fault = Store(tmp_path / "answers.jsonl", tmp_path), SourceFault("m.py", 1, SIGN, 0, "a", "b")
    store.put(fault.id, CHECK, {"fate": fate, "code": code, "answer": None, "seconds": 1.0}, "m.py")
    study = Study((fault,), store, None, tmp_path, print)  # type: ignore[arg-type]
    assert study.fate(fault) == expected


@pytest.mark.parametrize(
    ("codes", "expected"), [((-7, None), "open"), ((-7, -7), "caught"), ((-7, -9), "open"), ((77, None), "halted")]
)
def test_tests_that_end_twice_by_the_same_signal_crash_by_the_fault_and_a_test_without_end_is_no_verdict(
    tmp_path: Path, codes: tuple[int, int | None], expected: str
) -> None:
    (tmp_path / "m.py").write_text("a\n")
    store, fault = Store(tmp_path / "answers.jsonl", tmp_path), SourceFault("m.py", 1, SIGN, 0, "a", "b")
    for stage in (CHECK, OUTPUTS):
        store.put(fault.id, stage, {"fate": "answered", "answer": {"status": "passed"}, "seconds": 1.0}, "m.py")
    for stage, code in zip((TESTS, LONGER), codes, strict=True):
        if code is not None:
            store.put(fault.id, stage, {"fate": "crashed", "code": code, "answer": None, "seconds": 1.0}, "m.py")
    study = Study((fault,), store, None, tmp_path, print)  # type: ignore[arg-type]
    assert study.fate(fault) == expected
