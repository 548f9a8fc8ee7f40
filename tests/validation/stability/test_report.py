"""The atlas from the command line: whole, refused, interrupted."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.models import sampled
from validation.__main__ import app
from validation.reporting.command import Run
from validation.reporting.findings import Finding
from validation.stability.catalogue import STUDIES
from validation.stability.measure import measure
from validation.stability.report import TOPIC
from validation.stability.study import Cell, Subject, Verdict

# Those whose models other tests compile, and that take less than half a second.
FEW = ("stick_slip", "massless_cross")


@pytest.fixture(scope="module", params=sampled(("few", "all"), ["few"]))
def quick(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Folder and data of the atlas: of a few studies in every run, of all with --slow."""
    folder = tmp_path_factory.mktemp("reports")
    chosen = [word for name in FEW for word in ("--study", name)] if request.param == "few" else []
    done = CliRunner().invoke(app, ["stability", *chosen, "--quick", "--json", "--report", str(folder)])
    data = json.loads(done.stdout)
    missed = [(c["quantity"], c["value"]) for s in data["studies"].values() if not s["ok"] for c in s["findings"]]
    assert done.exit_code == 0, (missed, data["failures"])
    return folder / "stability" if chosen else folder, data


def test_every_claim_holds_on_a_coarse_grid(quick: tuple[Path, dict[str, Any]]) -> None:
    _, data = quick
    assert data["ok"] and data["quick"] and not data["failures"] and not data["unfinished"]
    assert list(data["studies"]) in (list(FEW), list(STUDIES))
    for name, study in data["studies"].items():
        assert study["findings"] and re.search(r"\d", study["verdict"]), f"{name}: a verdict has figures"
        for found in study["maps"].values():
            ended, values = np.array(found["ended"]), np.array(found["values"], dtype=object)
            assert values.shape == (len(found["y"]), len(found["x"]))
            # Nothing is silently wrong: what has no number has an outcome.
            assert all(
                (v is None) == (e not in ("finished", "event"))
                for v, e in zip(values.ravel(), ended.ravel(), strict=True)
            ), name


def test_a_missed_bound_fails_the_command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    missed = replace(STUDIES["massless_cross"], judge=lambda maps: Verdict("1.", "2.", (Finding("zero", 1.0, 0.0),)))
    monkeypatch.setitem(STUDIES, "massless_cross", missed)
    done = CliRunner().invoke(app, ["stability", "--study", "massless_cross", "--quick", "--report", str(tmp_path)])
    assert done.exit_code == 1 and "1 miss their bounds" in done.stdout
    # One study has a folder of its own, and leaves the whole atlas as it is.
    assert "**missed** 1" in (tmp_path / "stability" / "stability.md").read_text()


def test_a_study_that_is_gone_names_its_successor() -> None:
    done = CliRunner().invoke(app, ["stability", "--study", "spin"])
    assert done.exit_code == 2 and "accuracy --study spinning" in " ".join(done.stderr.replace("│", " ").split())


@pytest.mark.slow
def test_a_study_that_can_not_be_done_keeps_no_other_from_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(x: float, y: float) -> Cell:
        raise ArithmeticError("no")

    study = STUDIES["massless_cross"]
    monkeypatch.setitem(STUDIES, "massless_cross", replace(study, subjects=(Subject("s", broken),)))
    atlas = measure(Run(TOPIC), ["massless_cross", "redundant"], quick=True)
    assert (
        not atlas["ok"]
        and atlas["failures"] == {"massless_cross": "ArithmeticError: no"}
        and atlas["studies"]["redundant"]["ok"]
    )
