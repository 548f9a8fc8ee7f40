"""`symofros advise`, and what its advice is good for."""

from __future__ import annotations

import json
from pathlib import Path
from unittest import mock

import pytest
from rich.console import Console
from typer.testing import CliRunner, Result

import reference_models
import symofros as sf
from symofros.__main__ import app

FLEXIBLE = Path(reference_models.__file__).parent / "flexible"
MODEL, SCENE = FLEXIBLE / "spinning_beam.yaml", FLEXIBLE / "scenes" / "spinning_beam.yaml"


def run(*arguments: object) -> Result:
    # A console keeps the width that it found when it was made.
    with mock.patch("symofros.commands.uses.out", Console(width=160)):
        return CliRunner().invoke(app, ["advise", *map(str, arguments)])


def test_advise_prints_text_and_json(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One advice serves both: it takes seconds. Eight seconds of the scene's spin-up are enough for them."""
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.read_text().replace("t_end: 20", "t_end: 8"))
    advise, made, asked = sf.advise, [], []

    def once(system: sf.System, scene: sf.Scene, tolerance: object) -> sf.Advice:
        asked.append(tolerance)
        made[:] = made or [advise(system, scene)]
        return made[0]

    monkeypatch.setattr(sf, "advise", once)
    found = run(MODEL, "--scene", scene, "-o", tmp_path / "small.yaml", "--json")
    assert found.exit_code == 0, found.output
    said = json.loads(found.stdout)
    assert said["ok"] and said["gain"] >= 3.0 and said["outputs"][0]["error"] <= said["outputs"][0]["allowed"] == 0.02
    assert {one["verdict"] for one in said["choices"]} == {"taken", "refused", "not tried"}
    assert said["cost"]["operations"] == said["cost"]["per_evaluation"] * said["cost"]["evaluations"]
    assert sf.load(tmp_path / "small.yaml").body("beam").modes == 1
    found = run(MODEL, "--scene", scene, "--tolerance", "tip=0.05")
    assert found.exit_code == 0, found.output
    for words in ("no foreshortening", "refused", "allowed 0.02", "times as many", "measured:"):
        assert words in found.stdout
    assert asked == [None, {"tip": 0.05}]
    reads_back_and_its_functions_are_enough(made[0], tmp_path)


def reads_back_and_its_functions_are_enough(advice: sf.Advice, folder: Path) -> None:
    """Compiled with them and nothing else, the reduced model does what the scene asks."""
    path, how, scene = folder / "reduced.yaml", advice.stepping, advice.scene
    advice.write(path)
    assert sf.load(path) == advice.system
    assert path.read_text().startswith(f"# Reduced from '{advice.full.name}'")
    with pytest.raises(sf.DescriptionError, match="unknown format"):
        advice.write(folder / "robot.urdf")
    model = sf.compile(advice.system, advice.options)
    run = sf.simulate(model, t_end=0.1, u=dict(scene.inputs), method=how.method, **how.settings)  # type: ignore[arg-type]
    assert run.outcome.ok and run.frames[scene.outputs[0].of][0].shape == (len(run), 3)
    assert "inverse_dynamics" not in advice.options.functions
