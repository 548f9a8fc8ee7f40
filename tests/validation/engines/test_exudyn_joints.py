"""Exudyn's bodies and joints in the matrix: right where they are stated right, and wrong where a joint is another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.late import require
from validation.engines.interface import Unsupported
from validation.engines.matrix import SEED, Truths, asked, cells, judged
from validation.engines.models.acting import passive
from validation.engines.models.hostile import trees
from validation.engines.models.kinds import tree_of
from validation.engines.models.loops import trees as loops
from validation.engines.plugins import OWN
from validation.engines.verdicts import Expected, expected, judge
from validation.engines.workers import Job, answered

PLUGIN = OWN["exudyn-joints"]
require("exudyn", "validation")


@pytest.mark.parametrize("kind", ["revolute oblique", "prismatic oblique", "ball", "universal", "free between links"])
def test_joints_between_oblique_links_are_right_with_all_nodes(kind: str) -> None:
    verdicts = {cell.function: cell.verdict for cell in cells(PLUGIN, tree_of(kind))}
    assert verdicts == dict.fromkeys(asked(PLUGIN, tree_of(kind)), "right") and "forward_dynamics" in verdicts


@pytest.mark.parametrize("name", ["huge before tiny masses", "kilometres"])
def test_rounding_by_ill_conditioning_is_not_attributed_to_exudyn(name: str) -> None:
    """The equations of index 1 are solved by us: without steps that mend the solution, masses of 1e8 hid 1e-8."""
    functions = tuple(one for one in PLUGIN.functions if one.startswith("forward_dynamics"))
    assert {cell.verdict for cell in cells(PLUGIN, trees()[name], functions)} == {"right"}


@pytest.mark.parametrize("name", ["point between branches", "weld on the world", "cable of two points"])
def test_loops_are_right(name: str) -> None:
    tree = loops()[name]
    found = {cell.function: cell.verdict for cell in cells(PLUGIN, tree)}
    assert set(found) <= set(asked(PLUGIN, tree))
    assert set(found.values()) <= {"right", "not offered"} and found["constrained_acceleration"] == "right"
    assert (found["constraint_forces"] == "right") is (name == "point between branches")


def test_another_joint_than_the_trees_is_a_red_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hinge whose axis stands still in no link is seen: the third component is blocked in place of the second."""
    tree = tree_of("revolute x")
    job = Job(PLUGIN.name, tree, ("forward_dynamics:generic",), SEED)
    (answer,) = answered(job)
    assert isinstance(answer.value, np.ndarray) and answer.layout is not None and answer.state is not None
    want: Expected = expected("forward_dynamics", tree, answer.layout, answer.state)
    script = answer.script.replace("[1, 1, 1, 1, 1, 0]", "[1, 1, 1, 1, 0, 1]", 1)
    assert script != answer.script
    names: dict[str, object] = {}
    exec(script, names)
    assert judge(PLUGIN.name, tree, "forward_dynamics", np.asarray(names["value"]), want).verdict == "wrong"


def test_joints_that_exudyn_lacks_are_not_offered() -> None:
    for kind in ("helical", "ellipsoid", "offset hinges", "mimic revolute", "revolute with armature"):
        answer = PLUGIN.build(tree_of(kind))
        assert isinstance(answer, Unsupported) and not answer.offered, kind


def test_states_of_loops_are_closed_before_they_are_asked() -> None:
    tree = loops()["four-bar in a plane"]
    job = Job(PLUGIN.name, replace(tree), ("constrained_acceleration",), SEED)
    (one,) = judged(PLUGIN, job, Truths())
    assert one.cell.verdict == "right", one.cell


@pytest.mark.parametrize(
    "name",
    ["springs on hinges", "springs and dampers on branches", "dampers on a slide and a ball", "a damped free body"],
)
def test_springs_and_dampers_are_right(name: str) -> None:
    found = {cell.function: cell.verdict for cell in cells(PLUGIN, passive()[name])}
    assert set(found.values()) == {"right"} and {"passive_forces", "forward_dynamics:generic"} <= set(found)
