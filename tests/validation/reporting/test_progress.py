"""What a command says of its progress where no bar can be drawn."""

from __future__ import annotations

import pytest

from validation.reporting.command import Run
from validation.reporting.record import Report, Topic

STEPS, SECONDS_A_STEP = 1000, 0.1


def test_a_file_gets_a_line_of_progress_each_ten_seconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """However short the steps are; what is in all, and the last step, are always printed."""
    run = Run(Topic("work", "Correctness", "Is it done?", lambda _: Report("Work", "Done.", True, blocks=())))
    now = [0.0]
    monkeypatch.setattr(Run, "seconds", property(lambda _: now[0]))
    run.expect(STEPS)
    for step in range(STEPS):
        now[0] = round(step * SECONDS_A_STEP, 1)
        run.advance(f"scene {step}")
    first, *lines = capsys.readouterr().err.splitlines()
    assert first.endswith("work: 1000 in all") and lines[-1].endswith("[1000/1000] scene 999")
    reported = [float(line.split()[0]) for line in lines[:-1]]
    assert reported == [10.0 * k for k in range(1, 10)]
