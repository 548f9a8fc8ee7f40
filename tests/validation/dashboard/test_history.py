"""Trends come from the summaries of earlier commits."""

from __future__ import annotations

import subprocess
from pathlib import Path

from validation.dashboard.history import history, stored
from validation.dashboard.trends import trends
from validation.reporting.figures import Chart
from validation.reporting.record import verdict

WHO = ("-c", "user.name=a", "-c", "user.email=a@b")


def commit(folder: Path, timing: str, word: str, made: str = "-") -> None:
    head = "| report | what it found | verdict | made (UTC) |\n|---|---|---|---|"
    text = f"{head}\n| timing | {timing} | {word} | {made} |\n"
    (folder / "summary.md").write_text(text, encoding="utf-8")
    for words in (["init", "-q"], ["add", "."], [*WHO, "commit", "-qm", "x"]):
        subprocess.run(["git", "-C", str(folder), *words], check=True)


def test_a_line_says_what_changed_in_a_report_and_since_when(tmp_path: Path) -> None:
    commit(tmp_path, "10 000 races", "good")
    assert not history(stored(tmp_path / "summary.md"), ("timing",)).rows, "one commit is no trend"
    commit(tmp_path, "24 of 26 targets are met", "missed")
    commit(tmp_path, "26 of 26 targets are met", "good")
    trend = history(stored(tmp_path / "summary.md"), ("timing", "check"))
    assert [row[0] for row in trend.rows] == ["[timing](#timing)"] * 2
    assert trend.rows[0][3:] == ("26 of 26 targets are met", "good", "missed: 24 of 26 targets are met")
    assert trend.rows[1][3:] == ("24 of 26 targets are met", verdict("missed", False), "good: 10 000 races")


def test_without_a_repository_there_is_no_trend(tmp_path: Path) -> None:
    assert not history(stored(tmp_path / "summary.md"), ("timing",)).rows
    assert not trends(stored(tmp_path / "summary.md")).charts


def test_a_trend_has_a_point_a_measurement(tmp_path: Path) -> None:
    said = "{} of 41 targets are met; median of their time over ours: pinocchio {}×, mujoco 10×."
    for met, ratio, made in ((24, 8.4, "2026-11-22 00:53 UTC"), (23, 8.4, "2026-11-22 00:53"), (41, 9.6, "2026-11-24")):
        commit(tmp_path, said.format(met, ratio), "missed", made)
    figure = trends(stored(tmp_path / "summary.md"))
    speed, targets = figure.charts
    assert isinstance(speed, Chart) and isinstance(targets, Chart)
    assert [curve.label for curve in speed.curves] == ["pinocchio", "mujoco"]
    # The second summary is of the first one's measurement.
    assert list(speed.curves[0].y) == [8.4, 9.6] and list(speed.curves[1].y) == [10, 10]
    assert list(targets.curves[0].y) == [24, 41] and targets.curves[0].x[-1] == 0
    assert "targets: timing met 24 → 41." in figure.caption and "others: pinocchio 8.4 → 9.6;" in figure.caption
    assert "mujoco" not in figure.caption
