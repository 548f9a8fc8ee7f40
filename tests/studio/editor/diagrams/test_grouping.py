"""Blocks grouped into a subsystem: the diagram says the same, whatever is chosen."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.harness import folder_of
from symofros.studio.editor.diagrams.grouping import grouped
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import Workspace
from symofros.studio.editor.editing.data_edits import EditError

TEXT = """symofros_diagram: 1
name: mixed
simulation: {t_end: 1, dt: 0.05, plots: [{title: Both, signals: [twice, lag.y]}]}
blocks:
  wave: {kind: sine, unit: rad}
  twice: {kind: gain, gain: 2, inputs: {u: wave.y}}
  thrice: {kind: gain, gain: 3, inputs: {u: wave.y}}
  both: {kind: sum, inputs: {u1: twice.y, u2: thrice}}
  lag: {kind: transfer_function, num: [1], den: [1, 1], inputs: {u: both.y}}
  sight: {kind: scope, signals: [a, b], inputs: {a: lag.y, b: twice}}
"""
NAMES = ("wave", "twice", "thrice", "both", "lag")


def session_of(folder: Path, text: str = TEXT) -> Session:
    file = folder / "mixed.yaml"
    file.write_text(text)
    return Session(Workspace(folder), file)


def group(session: Session, *names: str, part: str = "subsystem") -> None:
    session.group({"revision": session.document.revision, "name": part, "blocks": [f"blocks/{name}" for name in names]})


@pytest.mark.parametrize("chosen", [c for k in (1, 2, 3, 5) for c in combinations(NAMES, k)][::4], ids="-".join)
def test_a_grouped_diagram_runs_as_before(tmp_path: Path, chosen: tuple[str, ...]) -> None:
    session = session_of(tmp_path)
    diagram = sf.load_diagram(session.document.file)
    before = sf.Simulation(diagram).interpret(1.0, dt=0.05)
    group(session, *chosen)
    assert session.document.analysis.problems == [], session.document.text
    file = tmp_path / "after.yaml"
    file.write_text(session.document.text)
    after = sf.Simulation(sf.load_diagram(file)).interpret(1.0, dt=0.05)
    for name in NAMES:
        place = f"subsystem/{name}" if name in chosen else name
        assert np.array_equal(after[f"{place}.y"], before[f"{name}.y"]), name
    inside = sf.load_diagram(tmp_path / "subsystem.yaml")
    assert set(inside.blocks) == set(chosen)
    # One signal that enters is one inlet, however many blocks read it; plots follow their signals.
    if chosen == ("twice", "thrice"):
        assert list(inside.inlets) == ["u"] and set(inside.inlets["u"]) == {"twice.u", "thrice.u"}


def test_undo_brings_the_blocks_back_and_a_second_group_takes_another_file(tmp_path: Path) -> None:
    session = session_of(tmp_path)
    group(session, "twice", "thrice")
    session.undo({"revision": session.document.revision})
    assert session.document.text == TEXT
    group(session, "lag")
    assert (tmp_path / "subsystem2.yaml").exists() and "file: subsystem2.yaml" in session.document.text


def test_models_go_with_the_blocks_that_name_them(tmp_path: Path) -> None:
    models = folder_of("reference_models")
    (tmp_path / "rigid").mkdir()
    (tmp_path / "rigid/double_pendulum.yaml").write_text((models / "rigid/double_pendulum.yaml").read_text())
    session = session_of(tmp_path, (models / "held_arm.yaml").read_text())
    group(session, "pd", "weight", "effort")
    assert session.document.analysis.problems == [], session.document.text
    whole = sf.load_diagram(models / "held_arm.yaml")
    file = tmp_path / "after.yaml"
    file.write_text(session.document.text)
    runs = [sf.Simulation(each).interpret(0.2, dt=0.01) for each in (whole, sf.load_diagram(file))]
    assert np.array_equal(runs[0]["plant.q"], runs[1]["plant.q"])


@pytest.mark.parametrize(
    ("chosen", "more", "says"),
    [
        ([], "", "no block"),
        (["blocks/none"], "", "blocks and parts"),
        (["models/arm"], "", "blocks and parts"),
        (["blocks/twice"], "wires: {both.u2: thrice.y}\n", "wires of its own"),
    ],
)
def test_blocks_that_cannot_be_grouped_are_refused_in_words(
    tmp_path: Path, chosen: list[str], more: str, says: str
) -> None:
    session = session_of(tmp_path, TEXT + more)
    with pytest.raises(EditError, match=says):
        session.group({"revision": session.document.revision, "name": "part", "blocks": chosen})
    assert not (tmp_path / "part.yaml").exists() and session.document.text == TEXT + more


def test_a_name_that_is_taken_is_refused() -> None:
    with pytest.raises(EditError, match="is taken"):
        grouped({"blocks": {"a": {}, "b": {}}}, "b", "b.yaml", ["blocks/a"])


CONDITIONAL = """symofros_diagram: 1
name: mixed
blocks:
  wave: {kind: sine}
  fast: {kind: sine, frequency: 3}
  seen: {kind: scope, signals: [a], inputs: {a: part.y}}
parts:
  part:
    diagram:
      blocks: {sum: {kind: integrator, period: 0.05}}
      inlets: {u: [sum.u]}
      outlets: {y: sum.y}
    inputs: {u: fast.y}
    condition: {enabled: wave.y, states: reset}
"""


@pytest.mark.parametrize("chosen", [["blocks/wave"], ["parts/part"], ["blocks/wave", "parts/part"]], ids=str)
def test_conditions_of_parts_keep_their_signals(tmp_path: Path, chosen: list[str]) -> None:
    """The signal of a condition is drawn, follows a new name, and goes into a subsystem and out of it."""
    session = session_of(tmp_path, CONDITIONAL)
    before = sf.Simulation(sf.load_diagram(session.document.file)).interpret(1.0, dt=0.05)
    drawn = session.document.analysis.diagram
    assert drawn is not None
    assert {("blocks/wave", "enabled"), ("blocks/fast", "u")} == {
        (wire["source"], wire["target_port"]) for wire in drawn["wires"] if wire["target"] == "parts/part"
    }
    revision = session.document.revision
    session.edit(
        {"revision": revision, "label": "", "edits": [{"op": "rename", "path": ["blocks", "wave"], "to": "w"}]}
    )
    assert "enabled: w.y" in session.document.text
    session.group(
        {"revision": session.document.revision, "name": "inner", "blocks": [one.replace("wave", "w") for one in chosen]}
    )
    assert session.document.analysis.problems == [], session.document.text
    file = tmp_path / "after.yaml"
    file.write_text(session.document.text)
    after = sf.Simulation(sf.load_diagram(file)).interpret(1.0, dt=0.05)
    place = "inner/part/sum.y" if "parts/part" in chosen else "part/sum.y"
    assert np.array_equal(after[place], before["part/sum.y"]) and np.ptp(after[place]) > 0.0
