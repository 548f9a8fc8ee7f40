"""What a new reader asks first stands on the index, with answers out of the stored reports."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.validation.dashboard.test_gather import FUZZ, digest, write
from validation.dashboard.asked import asked_first, engines_wrong
from validation.dashboard.gather import gather
from validation.reporting.record import Bullets

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def answers() -> dict[str, str]:
    rows = asked_first(gather(ROOT / "reports", {}, names=("pareto", "engines", "accuracy", "timing", "check"))).rows
    return {str(asked).strip("[").partition("]")[0]: str(said) for asked, said in rows}


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ("Which method for my scene?", ("pendulum: `rodas4`", "spin-up of a flexible beam: `", "andrews' squeezing")),
        ("Which engine is wrong, and why?", (" causes, first: ", ". Fewer causes: ", "mujoco ", "drake ")),
        ("How far may a beam bend?", (" L and 10 % at 0.", "beyond 0.3 L")),
        ("Is it faster than MuJoCo on a humanoid?", ("Yes: on Talos", "times as long for M + h and")),
        ("What is not covered?", ("collision of meshes", "docs/comparison.md", "trust.html#gaps")),
    ],
)
def test_each_question_has_its_answer(asked: str, says: tuple[str, ...], answers: dict[str, str]) -> None:
    assert all(part in answers[asked] for part in says), answers[asked]


def test_the_scope_is_that_of_the_documentation(answers: dict[str, str]) -> None:
    page = " ".join((ROOT / "docs" / "comparison.md").read_text(encoding="utf-8").split())
    for phrase in ("collision of meshes or of many bodies", "plates, shells and solids that deform", "finite elements"):
        assert phrase in page and phrase in " ".join(answers["What is not covered?"].split())


def test_what_is_wrong_is_stated_of_the_engines_with_most_causes() -> None:
    items = (
        "**[a](#a)**, 1 cause: its signs are wrong. Shows in: all trees. Releases: 1.0.",
        "**[b](#b)**, 9 causes, first: it forgets\nthe last link. Shows in: long trees.",
        "**[c](#c)**, 3 causes, first: m.x is zero. Shows in: none.",
    )
    said = "b, 9 causes, first: it forgets\nthe last link; c, 3 causes, first: m.x is zero. Fewer causes: a 1."
    assert engines_wrong((Bullets(items),)) == said


def test_questions_without_a_report_are_left_out(tmp_path: Path) -> None:
    assert asked_first(gather(write(tmp_path, FUZZ), {}, digest)).rows == ()
