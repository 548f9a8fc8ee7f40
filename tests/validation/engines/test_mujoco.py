"""MuJoCo's second ways: other fields, Jacobians, sensors of links, rotations, models that are made again."""

from __future__ import annotations

import re
import tempfile
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import Medium, Tree, Unsupported
from validation.engines.matrix import SEED, Judged, Truths, asked, cells, judged
from validation.engines.models import acting, hostile, loops, single, transformed
from validation.engines.models.files import formats
from validation.engines.models.kinds import tree_of, turned
from validation.engines.plugins import OWN
from validation.engines.plugins.mujoco import plugin, stages
from validation.engines.plugins.mujoco.elements import quaternion_of
from validation.engines.verdicts import judge
from validation.engines.workers import Job

MUJOCO = OWN["mujoco"]
ROTATIONS = [name for name in single.trees() if name.startswith("rotations")]
# (tree, a function that is asked for, one that leaves out what it is about).
FAULTS = [
    (tree_of("three hinges"), "link_poses_seen", "link_poses"),
    (tree_of("three hinges"), "link_velocities_seen", "link_velocities"),
    (acting.trees()["springs on hinges"], "inverse_dynamics_acted", "inverse_dynamics:mj_rne"),
    (acting.trees()["dampers on hinges"], "inverse_dynamics_acted", "inverse_dynamics:mj_rne"),
    (acting.trees()["actuators on tendons"], "tendon_lengths:tendonpos", "tendon_speeds:tendonvel"),
    (acting.trees()["actuators at their limits"], "actuator_forces:actuatorfrc", "actuator_lengths:actuatorpos"),
    (acting.trees()["motors"], "actuator_lengths:actuatorpos", "actuator_speeds:actuatorvel"),
    (acting.trees()["actuators clamped at their joints"], "actuated_forces:jointactuatorfrc", "passive_forces"),
]


def _judged(tree: Tree, *functions: str) -> dict[str, Judged]:
    return {one.cell.function: one for one in judged(MUJOCO, Job("mujoco", tree, functions, SEED), Truths())}


@pytest.mark.parametrize("kind", ["ball", "free", "three hinges", "prismatic oblique"])
def test_second_ways_are_right(kind: str) -> None:
    tree = tree_of(kind)
    names = [name for name in asked(MUJOCO, tree) if ":" in name or name.endswith("_seen")]
    assert len(names) > 20
    assert {cell.verdict for cell in cells(MUJOCO, tree, names)} == {"right"}


@pytest.mark.parametrize("name", ROTATIONS)
def test_rotations_are_right(name: str) -> None:
    tree = single.trees()[name]
    assert asked(MUJOCO, tree)
    assert {cell.verdict for cell in cells(MUJOCO, tree)} == {"right"}


@pytest.mark.parametrize("name", ["point by bodies", "anchor of a connect constraint changed", "weld on the world"])
def test_constraints_of_models_that_are_made_again_are_right(name: str) -> None:
    verdicts = {cell.function: cell.verdict for cell in cells(MUJOCO, loops.trees()[name])}
    assert {"constraint_residuals:attach", "constrained_inverse", "constraint_jacobian:mj_mulJacVec"} <= set(verdicts)
    assert set(verdicts.values()) == {"right"}


@pytest.mark.parametrize(("tree", "asked_for", "given"), FAULTS)
def test_an_answer_without_a_part_is_a_red_cell(tree: Tree, asked_for: str, given: str) -> None:
    found = _judged(tree, asked_for, given)
    want, answer = found[asked_for].want, found[given].answer
    assert want is not None and found[asked_for].cell.verdict == "right"
    assert judge("planted", tree, asked_for, np.asarray(answer.value), want).verdict == "wrong"


@pytest.mark.parametrize("function", ["constraint_residuals", "constraint_points"])
def test_an_anchor_that_stays_is_a_red_cell(function: str) -> None:
    tree = loops.trees()["anchor of a connect constraint changed"]
    (one,), (stale,) = (_judged(at, function).values() for at in (tree, tree.before))
    assert one.want is not None and one.cell.verdict == "right"
    answer = np.asarray(stale.answer.value)
    assert judge("planted", tree, function, answer, one.want).verdict == "wrong"


@pytest.mark.parametrize("name", [name for name, tree in loops.trees().items() if tree.sensors])
def test_a_holding_wrench_without_the_share_of_constraints_is_a_red_cell(name: str) -> None:
    tree = loops.trees()[name]
    (one,) = _judged(tree, "wrench_sensors:bound").values()
    assert one.want is not None and one.cell.verdict == "right" and one.answer.state is not None
    model = MUJOCO.build(tree)
    assert not isinstance(model, Unsupported)
    bare = np.asarray(model.call("wrench_sensors", one.answer.state))
    assert judge("planted", tree, "wrench_sensors", bare, one.want).verdict == "wrong"


@pytest.mark.parametrize("first", ["an unlimited hinge", "a free joint", "a ball"])
def test_a_range_that_is_not_read_is_a_red_cell(first: str) -> None:
    stated = formats.formats()[f"mjcf: range of a hinge beyond {first}"]
    texts = (stated.text, re.sub('range="[^"]*"', "", stated.text))
    jobs = (Job("mujoco", stated.tree, stated.asked, SEED, form="mjcf", text=text) for text in texts)
    (one,), (bare,) = (judged(MUJOCO, job, Truths()) for job in jobs)
    assert one.cell.verdict == "right" and bare.cell.verdict == "wrong"


def test_a_release_without_specifications_writes_the_same_file() -> None:
    text = formats.formats()["mjcf: frame around a body"].text
    names: dict[str, Any] = {"mj": mujoco, "tempfile": tempfile}
    exec(plugin.WRITING, names)
    by_specification = names["written"](text)
    names["mj"] = SimpleNamespace(MjModel=mujoco.MjModel, mj_saveLastXML=mujoco.mj_saveLastXML)
    assert names["written"](text) == by_specification


def test_a_quaternion_is_that_of_the_rotation() -> None:
    draw = np.random.default_rng(1)
    half_turns = [np.diag(signs) for signs in ((1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0))]
    for R in (np.eye(3), *half_turns, *(np.array(turned(draw)) for _ in range(20))):
        w, x, y, z = quaternion_of(R)
        K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        assert w >= 0.0
        np.testing.assert_allclose(np.eye(3) + 2.0 * w * K + 2.0 * K @ K, R, atol=1e-15)


@pytest.mark.parametrize(
    "medium", [Medium(0.0, 0.125, (2.0, -1.0, 0.5)), Medium(1.25, 0.0, (2.0, -1.0, 0.5)), Medium(1.25, 0.125)]
)
def test_a_part_of_the_drag_that_is_left_out_is_a_red_cell(medium: Medium) -> None:
    tree = acting.trees()["links in wind"]
    without = replace(tree, medium=medium)
    (one,), (less,) = (_judged(at, "passive_forces").values() for at in (tree, without))
    assert one.want is not None and one.cell.verdict == less.cell.verdict == "right"
    answer = np.asarray(less.answer.value)
    assert judge("planted", tree, "passive_forces", answer, one.want).verdict == "wrong"


def test_attached_models_are_not_attached_again() -> None:
    tree = transformed.trees()["attached chain"]
    verdicts = {cell.function: cell.verdict for cell in cells(MUJOCO, tree)}
    assert verdicts["mass_matrix"] == "right"
    assert {verdict for name, verdict in verdicts.items() if name.endswith(":attach")} == {"not offered"}


def test_every_second_way_is_one_to_a_function() -> None:
    assert {name.partition(":")[0] for name in MUJOCO.functions} <= set(FUNCTIONS)


def test_stages_one_by_one_do_what_all_do() -> None:
    found: set[str] = set()
    for tree in (hostile.trees()["six oblique hinges"], acting.driven()["actuators of all kinds"]):
        names = [name for name in asked(MUJOCO, tree) if name in stages.WAYS]
        assert {one.cell.verdict for one in _judged(tree, *names).values()} == {"right"}
        found.update(names)
    assert len(found) > 18
