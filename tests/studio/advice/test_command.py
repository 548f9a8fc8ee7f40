"""`symofros advise`."""

from __future__ import annotations

import json
from pathlib import Path
from unittest import mock

import pytest
from rich.console import Console
from typer.testing import CliRunner

import reference_models
import symofros as sf
from symofros.__main__ import app

FLEXIBLE = Path(reference_models.__file__).parent / "flexible"
MODEL, SCENE = str(FLEXIBLE / "spinning_beam.yaml"), str(FLEXIBLE / "scenes" / "spinning_beam.yaml")


def run(*arguments: str):
    # A console keeps the width that it found when it was made.
    with mock.patch("symofros.commands.uses.out", Console(width=160)):
        return CliRunner().invoke(app, ["advise", *arguments])


def test_it_tells_programs_and_people(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One advice serves both: it takes seconds."""
    advise, made, asked = sf.advise, [], []

    def once(system: sf.System, scene: sf.Scene, tolerance: object) -> sf.Advice:
        asked.append(tolerance)
        made[:] = made or [advise(system, scene)]
        return made[0]

    monkeypatch.setattr(sf, "advise", once)
    found = run(MODEL, "--scene", SCENE, "-o", str(tmp_path / "small.yaml"), "--json")
    assert found.exit_code == 0, found.output
    said = json.loads(found.stdout)
    assert said["ok"] and said["gain"] >= 3.0 and said["outputs"][0]["error"] <= said["outputs"][0]["allowed"] == 0.02
    assert {one["verdict"] for one in said["choices"]} == {"taken", "refused", "not tried"}
    assert said["cost"]["operations"] == said["cost"]["per_evaluation"] * said["cost"]["evaluations"]
    assert sf.load(tmp_path / "small.yaml").body("beam").modes == 1
    found = run(MODEL, "--scene", SCENE, "--tolerance", "tip=0.05")
    assert found.exit_code == 0, found.output
    for words in ("no foreshortening", "refused", "allowed 0.02", "times as many", "measured:"):
        assert words in found.stdout
    assert asked == [None, {"tip": 0.05}]
