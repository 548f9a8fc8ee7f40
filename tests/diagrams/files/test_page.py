"""docs/diagrams.md: the example at its head is a diagram that runs, and the page knows every section."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import symofros as sf
from symofros.diagrams.files.reader import MODEL, PART, SECTIONS
from symofros.diagrams.files.run_settings import SETTINGS
from tests.diagrams.files.cases import folder_with
from tests.docs.pages import blocks

PAGE = (Path(__file__).parents[3] / "docs" / "diagrams.md").read_text(encoding="utf-8")


def test_the_documented_example_runs(tmp_path: Path) -> None:
    example, *_ = blocks("docs/diagrams.md", "yaml")
    run = sf.Simulation(sf.load_diagram(folder_with(tmp_path, example.text))).run()
    assert run.outcome.ok and len(run.t) == 201
    # Nobody sent anything: the arm is held near the fallback, against its weight.
    assert np.all(run["desired.signal"] == [0.3, -0.2]) and np.all(run["desired.alive"] == 0.0)
    assert np.abs(run["plant.v"][-1]).max() < 0.05
    assert [axis.get_title(loc="left") for axis in run.plot().axes] == ["Joints", "tip: tip"]


def test_every_entry_is_on_the_page() -> None:
    for name in {*SECTIONS, *MODEL, *PART, *SETTINGS} - {"name"}:
        assert f"`{name}`" in PAGE or f"`{name}:" in PAGE, name
