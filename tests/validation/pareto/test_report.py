"""The report of speed against accuracy, from the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from validation.__main__ import app


@pytest.mark.slow
def test_report_end_to_end(tmp_path: Path) -> None:
    first = CliRunner().invoke(app, ["pareto", "--quick", "--problem", "andrews", "--json", "--report", str(tmp_path)])
    data = json.loads(first.stdout)
    assert first.exit_code in (0, 1) and not data["failures"] and list(data["problems"]) == ["andrews"]
    folder = tmp_path / "pareto_quick"
    page, summary = ((folder / f"pareto.{kind}").read_text() for kind in ("html", "md"))
    assert page.count('role="img"') == 2 and "symofros by" in page and "symofros by" in summary
    assert page.index("Which method") < page.index("targets are met")
    assert "single precision" in page and not re.search(r'(src|href)="(?!#|pareto\.html#)', page)
    # Another problem goes on from what is there; a problem that is there is left out if asked.
    then = CliRunner().invoke(
        app,
        [
            "pareto",
            "--quick",
            "--problem",
            "andrews",
            "--problem",
            "four_bar",
            "--resume",
            "--json",
            "--report",
            str(tmp_path),
        ],
    )
    again = json.loads(then.stdout)
    assert list(again["problems"]) == ["four_bar", "andrews"]
    assert again["problems"]["andrews"]["points"] == data["problems"]["andrews"]["points"]


@pytest.mark.slow
def test_a_quick_run_of_the_pendulum_fails_nowhere(tmp_path: Path) -> None:
    """It reaches none of the errors at which engines are compared, which is no miss."""
    arguments = ["pareto", "--quick", "--problem", "pendulum", "--report", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0 and "not measured" in done.stdout, done.output
    assert "nan" not in done.stdout and "missed" not in done.stdout and " of 4 targets met" not in done.stdout
