"""Scripts of red cells: those of the report, and the smaller trees and states that new ones are made of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from validation.engines.matrix import SEED
from validation.engines.models import loops
from validation.engines.models.formats import formats, texts
from validation.engines.models.kinds import tree_of
from validation.engines.models.readers import readings
from validation.engines.plugins import OWN
from validation.engines.proving import closing
from validation.engines.proving.pieces import taken
from validation.engines.workers import Job, answered

SCRIPTS = sorted((Path(__file__).parents[3] / "reports" / "engines").glob("*.py"))


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_stored_script_compiles_and_ends_by_an_assertion_or_a_crash(path: Path) -> None:
    text = path.read_text()
    compile(text, path.name, "exec")
    assert text.startswith("# ") and (" crashes (" in text.partition("\n")[0]) != ("\nassert " in text)


def test_files_that_are_written_from_trees_are_told_from_others() -> None:
    known = formats()["urdf of six oblique hinges"]
    assert texts(known.tree)["urdf"] == known.text
    assert all(texts(one.tree).get(one.form) != one.text for one in readings().values())


def test_loops_meet_with_all_coordinates_zero() -> None:
    tree = loops.trees()["weld between branches"]
    (answer,) = answered(Job("pinocchio", tree, ("constraint_jacobian",), SEED))
    assert answer.layout is not None and answer.state is not None
    count = 0
    for variant, pieces in closing.at_zero(tree, taken(answer.layout, answer.state)):
        (again,) = answered(Job("pinocchio", variant, ("constraint_jacobian",), pieces=pieces))
        if again.state is not None:
            assert not np.any(again.state.q), variant
            count += 1
    assert count > 5


def test_armature_is_on_every_axis_that_states_it() -> None:
    """Newton's joints of several axes had none, and were called wrong for it."""
    for kind, axes in (("universal with armature", 2), ("planar with armature", 3)):
        text = OWN["newton"].building(tree_of(kind))  # type: ignore[attr-defined]
        assert text.count("armature=0.75") == axes
