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
    asked = ["pareto", "--quick", "--problem", "andrews", "--problem", "four_bar", "--resume", "--json", "--report"]
    then = CliRunner().invoke(app, [*asked, str(tmp_path)])
    again = json.loads(then.stdout)
    assert list(again["problems"]) == ["four_bar", "andrews"]
    assert again["problems"]["andrews"]["points"] == data["problems"]["andrews"]["points"]
