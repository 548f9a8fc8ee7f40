"""Trends come from the summaries of earlier commits."""

from __future__ import annotations

import subprocess
from pathlib import Path

from validation.dashboard.history import history
from validation.reporting.record import verdict

WHO = ("-c", "user.name=a", "-c", "user.email=a@b")


def commit(folder: Path, timing: str, word: str) -> None:
    text = f"| report | what it found | verdict | made (UTC) |\n|---|---|---|---|\n| timing | {timing} | {word} | - |\n"
    (folder / "summary.md").write_text(text, encoding="utf-8")
    for words in (["init", "-q"], ["add", "."], [*WHO, "commit", "-qm", "x"]):
        subprocess.run(["git", "-C", str(folder), *words], check=True)


def test_a_line_says_what_changed_in_a_report_and_since_when(tmp_path: Path) -> None:
    commit(tmp_path, "10 000 races", "good")
    assert not history(tmp_path / "summary.md", ("timing",)).rows, "one commit is no trend"
    commit(tmp_path, "24 of 26 targets are met", "missed")
    commit(tmp_path, "26 of 26 targets are met", "good")
    trend = history(tmp_path / "summary.md", ("timing", "check"))
    assert [row[0] for row in trend.rows] == ["[timing](#timing)"] * 2
    assert trend.rows[0][3:] == ("26 of 26 targets are met", "good", "missed: 24 of 26 targets are met")
    assert trend.rows[1][3:] == ("24 of 26 targets are met", verdict("missed", False), "good: 10 000 races")


def test_without_a_repository_there_is_no_trend(tmp_path: Path) -> None:
    assert not history(tmp_path / "summary.md", ("timing",)).rows
