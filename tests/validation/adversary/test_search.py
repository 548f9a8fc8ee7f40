"""Budget, shrinking, resuming, Ctrl-C, and the tests that are written, by an attack on numbers."""

from __future__ import annotations

import json
import runpy
from collections.abc import Callable
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import pytest
from hypothesis import strategies as st
from typer.testing import CliRunner, Result

import symofros as sf
from validation.__main__ import app
from validation.adversary.attack import Attack, Scene, Verdict, compared
from validation.adversary.report import ATTACKS
from validation.adversary.search import Budget, Tally, hunt


def judge(scene: Scene) -> Verdict:
    """A claim that no number exceeds 36."""
    return compared("size", float(scene["x"]), 36.0, "small")


def described(scene: Scene) -> sf.System:
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    return sf.System("toy", (body,), (sf.Parameter("x", float(scene["x"])),))


SOUND = replace(
    Attack(
        "toy", "numbers are small", "counting", st.fixed_dictionaries({"x": st.integers(0, 1000)}), described, judge
    ),
    judge=lambda scene: compared("size", 1.0, 2.0, "small"),
)
FAULTY = replace(SOUND, judge=judge)


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    monkeypatch.setitem(ATTACKS, "toy", FAULTY)

    def invoke(*more: object) -> Result:
        given = ("--attack", "toy", "--work", tmp_path / "work", "--report", tmp_path / "reports", "--json", *more)
        return CliRunner().invoke(app, ["adversary", *map(str, given)])

    return invoke


def test_budgets_are_kept(tmp_path: Path) -> None:
    tally = Tally()
    assert hunt(SOUND, tmp_path, 0, Budget(inf, 7), tally, set()) is None and tally.tried == 7
    assert hunt(SOUND, tmp_path, 0, Budget(0.0, 7), tally, set()) is None and tally.tried == 7


def test_unexpected_exceptions_are_contradictions() -> None:
    def crash(scene: Scene) -> Verdict:
        raise IndexError("out of bounds")

    verdict = replace(SOUND, judge=crash).verdict({"x": 1})
    assert not verdict.sound and verdict.quantity == "IndexError" and "out of bounds" in verdict.said


def test_nan_errors_are_contradictions() -> None:
    assert not compared("size", float("nan"), 1.0, "small").sound
    assert compared("size", 0.0, 0.0, "small").sound and not compared("size", 1.0, 0.0, "small").sound


def test_the_command_writes_log_report_and_a_test_that_fails_while_the_fault_is_there(
    command: Callable[..., Result], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = command("--examples", 300)
    assert done.exit_code == 1, done.output
    data = json.loads(done.stdout)
    assert [find["scene"] for find in data["finds"]] == [{"x": 37}] and data["attacks"]["toy"]["tried"] == 300
    assert "1 answer" in (tmp_path / "reports" / "adversary.md").read_text()
    assert sf.load(tmp_path / "work" / "toy_size.yaml").parameters[0].value == 37.0
    test: Any = runpy.run_path(str(tmp_path / "work" / "test_toy_size.py"))["test_toy_size"]
    with pytest.raises(AssertionError, match="size: 37, allowed 36"):
        test()
    monkeypatch.setitem(ATTACKS, "toy", SOUND)
    test()


def test_a_search_resumes_and_drops_mended_finds(
    command: Callable[..., Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    command("--examples", 50)
    again = json.loads(command("--examples", 20).stdout)
    assert again["attacks"]["toy"]["tried"] == 70 and len(again["finds"]) == 1
    monkeypatch.setitem(ATTACKS, "toy", SOUND)
    mended = command("--examples", 20)
    assert mended.exit_code == 0 and json.loads(mended.stdout)["finds"] == []
