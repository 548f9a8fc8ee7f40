"""The report on diagrams: its quick variant, and that it can fail."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from validation.__main__ import app
from validation.reporting.findings import Study
from validation.reporting.plain import restored


@pytest.mark.slow  # In every run: the report of another study, below.
@pytest.mark.parametrize("name", ["square", "two_arms"])
def test_the_studies_answer(name: str, tmp_path: Path) -> None:
    command = ["diagrams", "--study", name, "--quick", "--json", "--report", str(tmp_path)]
    done = CliRunner().invoke(app, command)
    data = json.loads(done.stdout)
    # How fast a busy machine is says nothing of the answer.
    findings = restored(Study, data["studies"][name]).findings
    missed = [one for one in findings if not one.ok and "second" not in one.quantity]
    assert findings and not missed
    page = (tmp_path / "diagrams.html").read_text()
    assert page.count('role="img"') >= 3 and "Figure 1.1" in page
