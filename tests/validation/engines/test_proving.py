"""Scripts of red cells: those of the report, and the smaller trees and states that new ones are made of."""

from __future__ import annotations

from pathlib import Path

import pytest

from validation.engines.models.files.formats import formats, texts
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN

SCRIPTS = sorted((Path(__file__).parents[3] / "reports" / "engines").glob("*.py"))


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_stored_script_compiles_and_ends_by_an_assertion_an_exception_or_a_crash(path: Path) -> None:
    text = path.read_text()
    compile(text, path.name, "exec")
    ends = any(f" {word} (" in text.partition("\n")[0] for word in ("crashes", "raises"))
    assert text.startswith("# ") and ends != ("\nassert " in text)


def test_files_written_from_trees_are_distinguished() -> None:
    known = formats()["urdf of six oblique hinges"]
    assert texts(known.tree)["urdf"] == known.text
    assert all(texts(one.tree).get(one.form) != one.text for name, one in formats().items() if ": " in name)


def test_armature_acts_on_every_stated_axis() -> None:
    """Newton's joints of several axes had none, and were called wrong for it."""
    for kind, axes in (("universal with armature", 2), ("planar with armature", 3)):
        text = OWN["newton"].building(tree_of(kind))  # type: ignore[attr-defined]
        assert text.count("armature=0.75") == axes
