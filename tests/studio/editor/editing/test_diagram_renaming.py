"""Renaming in diagrams: whatever refers to the block, part or model follows; nothing else changes."""

from __future__ import annotations

import pytest

from symofros.studio.editor.editing.data_edits import Edit, EditError
from symofros.studio.editor.editing.yaml_edits import with_references

TEXT = """symofros_diagram: 1
models:
  arm: {file: arm.yaml}   # what moves
simulation: {plots: [{title: pd, signals: [pd.effort, "pd.effort[0]", pdx.y]}]}
blocks:
  pd: {kind: joint_pd, kp: 1, kd: 8.0e-4, inputs: {q: pdx}}   # comment
  pdx: {kind: forward_dynamics, model: arm, inputs: {u: pd}}
parts:
  left: {file: l.yaml, models: {m: arm}, inputs: {a: pd.effort}}
wires: {left/inner.u: pd.effort, pdx.v: left/inner.y}
outlets: {out: pd.effort}
"""


REFERENCES = {
    "blocks/pd/law": [
        ('[pd.effort, "pd.effort[0]"', '[law.effort, "law.effort[0]"'),
        ("  pd: {kind", "  law: {kind"),
        ("{u: pd}", "{u: law}"),
        ("{a: pd.effort}", "{a: law.effort}"),
        ("inner.u: pd.effort", "inner.u: law.effort"),
        ("{out: pd.effort}", "{out: law.effort}"),
    ],
    "parts/left/right": [
        ("  left: {file", "  right: {file"),
        ("{left/inner.u", "{right/inner.u"),
        ("left/inner.y", "right/inner.y"),
    ],
    "models/arm/robot": [
        ("  arm: {file", "  robot: {file"),
        ("model: arm", "model: robot"),
        ("{m: arm}", "{m: robot}"),
    ],
}


@pytest.mark.parametrize("renamed", REFERENCES)
def test_all_that_refers_to_it_follows(renamed: str) -> None:
    section, name, new = renamed.split("/")
    wanted = TEXT
    for old, after in REFERENCES[renamed]:
        assert wanted.count(old) == 1, old
        wanted = wanted.replace(old, after)
    assert with_references(TEXT, [Edit("rename", (section, name), key=new)]) == wanted


@pytest.mark.parametrize("new", ["pdx", "left", "1x", "a.b", ""])
def test_a_name_that_is_taken_or_none_is_refused(new: str) -> None:
    with pytest.raises(EditError):
        with_references(TEXT, [Edit("rename", ("blocks", "pd"), key=new)])
