"""symofros export."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from symofros.__main__ import app

FOUR_BAR = "reference_models/closed/four_bar.yaml"


def test_export_writes_a_package(tmp_path: Path) -> None:
    done = CliRunner().invoke(
        app,
        [
            "export",
            FOUR_BAR,
            "--target",
            "c",
            "-o",
            str(tmp_path / "out"),
            "--set",
            "q1=1.2",
            "--frames",
            "rocker",
            "--json",
        ],
    )
    assert done.exit_code == 0, done.output
    reported = json.loads(done.output)
    assert reported["name"] == "four_bar"
    assert all(Path(file).is_file() for file in reported["files"])
    assert "1.2" in (tmp_path / "out" / "four_bar_plant.c").read_text()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--target", "excel"], "target is not one of 'c'"),
        (["--target", "c", "--set", "q9=1"], "no coordinate or speed 'q9'"),
        (["--target", "c", "--frames", "nowhere"], "no frame 'nowhere'"),
    ],
)
def test_invalid_export_arguments_are_refused(tmp_path: Path, words: list[str], says: str) -> None:
    done = CliRunner().invoke(app, ["export", FOUR_BAR, *words, "-o", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert says in done.output
    assert not (tmp_path / "out").exists()


def test_notes_are_shown(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["export", FOUR_BAR, "--target", "urdf", "-o", str(tmp_path)])
    assert "loops are open: loop" in done.output
