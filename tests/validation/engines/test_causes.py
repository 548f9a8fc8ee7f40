"""Causes of red cells: each cell has one or is counted as not explained; what hides behind another is found."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from validation.engines import parts
from validation.engines.causes import shown
from validation.engines.causes.cause import FOLDER, read, stated
from validation.engines.causes.corrections import by_columns
from validation.engines.causes.grouping import causes_of, stale, without_their_causes
from validation.engines.matrix import SEED, Truths, judged
from validation.engines.models.covering import scenes
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN
from validation.engines.report import compose
from validation.engines.verdicts import RED, Cell, Verdict
from validation.engines.workers import Job
from validation.reporting import html, markdown
from validation.reporting.provenance import Provenance

ROOT = Path(__file__).parents[3]
HESSIANS = ("jacobian_dq_local", "jacobian_dq_local:getFrameKinematicHessian", "jacobian_dq_aligned")


@pytest.fixture(scope="module")
def data() -> dict[str, Any]:
    """The stored report."""
    found: dict[str, Any] = json.loads((ROOT / "reports" / "engines.json").read_text(encoding="utf-8"))
    return found


def test_every_red_cell_has_one_cause_or_is_in_a_group_without(data: dict[str, Any]) -> None:
    cells = parts.cells(data)
    groups = causes_of(cells)
    assert sorted(map(repr, (cell for group in groups for cell in group.cells))) == sorted(
        repr(cell) for cell in cells if cell.verdict in RED
    )
    assert [group.weight for group in groups] == sorted((group.weight for group in groups), reverse=True)
    for group in groups:
        assert {group.cause} == {next((one for one in stated() if one.explains(cell)), None) for cell in group.cells}


def test_without_stated_causes_functions_that_are_red_on_the_same_trees_are_one(data: dict[str, Any]) -> None:
    cells = parts.cells(data)
    groups = causes_of(cells, ())
    assert {group.cause for group in groups} == {None}
    assert sum(len(group.cells) for group in groups) == sum(cell.verdict in RED for cell in cells)
    assert all(len(group.cells) == len(group.functions) * len(group.models) for group in groups)


def test_unexplained_cells_and_idle_causes_are_listed(data: dict[str, Any]) -> None:
    row = {"gravity": {"ball": ["wrong", 0.5, 1e-12], "free": ["wrong", 0.5, 1e-12]}}
    aside = {"bias": {"ball": ["precondition", 0.5, 1e-12, "no balls (manual, p. 3): wrong by 5.0e-01"]}}
    engine = {"name": "toy", "version": "1", "conventions": [], "functions": {"gravity": "weight", "bias": "h"}}
    engine["refusals"] = "refuses 9 of 9 cells in its own words, above the bound of 25%"
    toy = data | {"engines": [engine], "cells": {"toy": row | aside}, "corrected": {}, "identities": {}, "proofs": []}
    report = compose(toy)
    assert "2 wrong, imprecise or failed, by 1 cause;" in report.summary
    assert "causes, 1 of them not yet found" in {fact.label for fact in report.facts}
    for text in (html.page(report), markdown.page(report, Provenance.of({}), "")):
        assert "Cause not yet found:" in text and "no balls (manual, p. 3)." in text
        assert "toy refuses 9 of 9 cells" in text
    frax = [cause for cause in stated() if cause.engine == "frax"]
    mended = [cause for cause in stated() if cause.last]
    assert mended and not set(mended) & set(stale([], [cause.engine for cause in mended]))
    assert frax and stale([], ["frax"]) == frax and not stale([], ["toy"])


def test_tensors_are_read_by_columns() -> None:
    right = np.arange(48.0).reshape(2, 6, 2, 2)
    wrong = np.array([np.reshape(np.ravel(one, order="F"), one.shape) for one in right])
    np.testing.assert_array_equal(by_columns(wrong), right)


def test_a_cause_behind_another_is_found_with_that_one_taken_out() -> None:
    cells = [
        one
        for kind in ("ball", "universal", "revolute x")
        for one in judged(OWN["pinocchio"], Job("pinocchio", tree_of(kind), HESSIANS, SEED), Truths(0))
    ]
    first, *behind = causes_of([one.cell for one in cells], corrected=without_their_causes(cells))
    assert first.cause and (first.cause.name, len(first.cells), first.hidden) == ("tensors by columns", 9, ())
    assert {group.cause and group.cause.name: len(group.hidden) for group in behind} == {
        "axes that move with q": 3,
        "Hessian in the joint's own axes": 2,
    }
    assert not any(group.cells for group in behind)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ("wat: it is wrong", "unknown entries"),
        ("offends:", "entries missing: .'offends'."),
        ("functions:", "entries missing: .'functions'."),
        ("functions: [bias, '.*']", "names the functions that it shows in"),
        ("fault: nowhere", "the name of a file"),
        ("thread: somewhere", "a thread is an address"),
        ("searched: ''", "says when no thread was found"),
        ("correction: by magic", "a correction is one of"),
        ('last: "2"', "has a first one"),
    ],
)
def test_files_that_break_a_rule_are_refused(tmp_path: Path, changed: str, said: str) -> None:
    good = {"name": "a", "what": "It is wrong.", "shows": "balls", "offends": "M.", "searched": '"2026-11-28"'}
    good["functions"] = "[gravity]"
    name, _, value = changed.partition(":")
    path = tmp_path / "toy.yaml"
    rows = [f"{key}: {text}" for key, text in (good | {name: value}).items() if text]
    path.write_text("- " + "\n  ".join(rows) + "\n", encoding="utf-8")
    with pytest.raises(ValueError, match=said):
        read(path)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.yaml")), ids=lambda path: path.stem)
def test_stated_causes_are_sentences_of_an_engine_that_is_there(path: Path) -> None:
    for cause in read(path):
        assert cause.engine in OWN
        for text in (cause.what, cause.offends, cause.documented or "."):
            assert text.rstrip('"').endswith("."), text
        functions = OWN[cause.engine].functions
        assert any(re.fullmatch(pattern, name) for pattern in cause.functions for name in functions), cause.name


@pytest.mark.parametrize(
    ("features", "function", "name"),
    [
        (("0: hinge", "0: actearly"), "scene_actuator_force", "actuators with actearly"),
        (("no spring", "0: hinge", "0: damper"), "scene_qacc", "springs or dampers that are disabled"),
        (("implicitfast", "0: hinge", "0: muscle"), "scene_qvel", "muscles in implicitfast"),
        (("implicitfast", "0: hinge", "0: ctrlrange"), "scene_qvel", "controls beyond their range in implicitfast"),
        (("implicitfast", "0: hinge", "0: forcerange"), "scene_qvel", "clamped actuators in implicitfast"),
        (("0: hinge", "0: connect"), "scene_qfrc_constraint", "velocity products of points and welds"),
    ],
)
def test_scenes_have_the_causes_of_their_features(features: tuple[str, ...], function: str, name: str) -> None:
    cell = Cell("mjx", f"scene 1: {', '.join(features)}", function, "wrong")
    assert next(one.name for one in stated() if one.explains(cell)) == name


_SEVERAL = "mass matrix of mimic joints beyond joints of several speeds"
_HINGE_LAST = "slide before hinge"
_BESIDE, _NO_UNIT = "class beside childclass", "axes that are no unit vectors"
_BY_DEFAULT = "positions of joints by default"
_LONG_AXIS, _RATE = "axisangle of an axis of length 2", "centroidal_momentum_rate_dq"
_LESS_WEIGHT, _DEPENDENT = "centroidal derivatives less the weight", "constrained dynamics of dependent equations"
_SMALL_TURNS = "rotations by less than a thousandth"
_OF_FREE, _OF_SERVOS = "springs, dampers and armature of free joints", "gear of servos at joints"


@pytest.mark.parametrize(
    ("engine", "model", "function", "name"),
    [
        ("pinocchio", "chain 78: 0: ball, 0: mimic oblique beyond", "mass_matrix:crba WORLD", _SEVERAL),
        ("pinocchio", "chain 72: 0: revolute oblique, 0: mimic oblique beyond", "mass_matrix:crba WORLD", None),
        ("newton", "scene 1: 0: free, 0: site, 0: spring, damper", "scene_qacc", _OF_FREE),
        ("newton", "scene 1: 0: spring, damper, 0: site, 0: free, 1: hinge", "scene_qacc", _OF_FREE),
        ("newton", "scene 1: 0: free, 0: spring", "scene_qacc:at rest", _OF_FREE),
        ("newton", "scene 1: 0: free, 1: hinge, 1: damper", "scene_qacc", None),
        ("newton", "scene 1: 0: damper drive, 0: springref, 0: free", "scene_qacc", None),
        ("newton", "scene 1: 0: velocity, 0: hinge, 1: site, 1: motor", "scene_qacc", _OF_SERVOS),
        ("newton", "scene 1: 2: hinge, 2: position, 2: jointinparent", "scene_qvel:at rest", _OF_SERVOS),
        ("newton", "scene 1: 0: hinge, 1: site connect", "scene_qfrc_constraint:at rest", "connect of two sites"),
        ("newton", "scene 1: 0: actuatorfrcrange", "scene_qpos:at rest", "actuatorfrcrange that is not symmetric"),
        ("newton", "scene 1: 0: hinge, 0: site, 0: velocity", "scene_qacc", None),
        ("newton", "scene 1: position sensors, 0: hinge", "scene_qacc", None),
        ("pinocchio", "mjcf: eulerseq yxy + sections turned round", "link_poses", "compiler after worldbody"),
        ("pinocchio", "mjcf: inertia in full + sections turned round", "mass_matrix", None),
        ("mink", "rotations, 2^-12 from half turns", "rotation_vector_rates", None),
        ("mink", "rotations, 2^-27 from none", "rotation_vector_rates", "slopes of small rotation vectors"),
    ],
)
def test_causes_take_no_cell_without_their_features(engine: str, model: str, function: str, name: str | None) -> None:
    cell = Cell(engine, model, function, "wrong")
    assert next((one.name for one in stated() if one.explains(cell)), None) == name


@pytest.mark.parametrize(
    ("engine", "model", "function", "verdict", "name"),
    [
        ("dart", "mjcf: dry friction", "joint_frictions", "wrong", "friction and springs of MJCF"),
        ("dart", "mjcf: dry friction", "joint_frictions", "crashes", None),
        ("drake", "mjcf: gravity compensation + slide", "link_poses", "wrong", None),
        ("drake", f"mjcf: {_HINGE_LAST} + elements of a body turned round", "bias", "wrong", "two joints of a body"),
        ("drake", f"mjcf: {_HINGE_LAST} + axis oblique", "bias", "wrong", None),
        ("newton", "mjcf: oblique gravity", "gravity", "wrong", "gravity of MJCF"),
        ("newton", "mjcf: oblique gravity", "mass_matrix", "wrong", None),
        ("dart", "mjcf: reference angle", "link_poses", "wrong", "poses of MJCF"),
        ("dart", "mjcf: site turned", "link_poses", "wrong", None),
        ("pybullet", "urdf: inertia in full", "bias", "wrong", None),
        ("pybullet", "sdf: pose relative to its joint", "gravity", "crashes", "empty pose in SDF"),
        ("pybullet", "sdf: pose relative to its joint", "gravity", "wrong", None),
        ("trimesh", "rotations, 2^-27 from none", "rotation_halfway", "imprecise", "interpolation of near quaternions"),
        ("trimesh", "rotations, 2^-27 from half turns", "rotation_halfway", "imprecise", None),
        ("pinocchio", "mjcf: moments balanced + main class before childclass", "sizes", "raises", "classes of MJCF"),
        ("pinocchio", "rotations, 2^-8 from none", "rotation_difference_dq2", "raises", None),
        ("pinocchio", "mjcf: class of nothing below childclass: damping", "joint_dampings", "wrong", _BESIDE),
        ("pinocchio", f"mjcf: class of a geom before childclass + {_LONG_AXIS}", "link_poses", "wrong", _NO_UNIT),
        ("pinocchio", f"mjcf: {_LONG_AXIS} + site turned", "frame_poses", "wrong", _NO_UNIT),
        ("pinocchio", "mjcf: anchors by default + site turned", "frame_poses", "wrong", _BY_DEFAULT),
        ("pinocchio", "millimetres", f"{_RATE}:getCentroidalDynamicsDerivatives", "imprecise", _LESS_WEIGHT),
        ("pinocchio", "millimetres", f"{_RATE}:getCentroidalDynamicsDerivatives", "wrong", None),
        ("pinocchio", "millimetres", _RATE, "imprecise", None),
        ("pinocchio", "four-bar in a plane", "constrained_acceleration:forwardDynamics", "wrong", _DEPENDENT),
        ("pinocchio", "four-bar in a plane", "constrained_acceleration", "wrong", None),
        ("dart", "chain 4: free base, 0: turned", "step_stiffness_implicit", "imprecise", _SMALL_TURNS),
        ("dart", "chain 4: free base, 0: turned", "step_stiffness_implicit", "wrong", None),
        ("dart", "chain 5: 0: turned, 0: at the origin", "step_stiffness_implicit", "imprecise", None),
        ("mink", "rotations, 2^-40 from none", "pose_difference", "imprecise", "logarithm of turns below 1e-10"),
        ("mink", "rotations, 2^-17 from none", "pose_composed:lplus", "wrong", "placements by small turns"),
        ("mink", "rotations, 2^-12 from half turns", "pose_composed:rplus", "wrong", None),
    ],
)
def test_causes_take_no_cell_of_another_function_or_verdict(
    engine: str, model: str, function: str, verdict: Verdict, name: str | None
) -> None:
    cell = Cell(engine, model, function, verdict)
    assert next((one.name for one in stated() if one.explains(cell)), None) == name


def test_patterns_of_scenes_are_those_of_some_scene() -> None:
    """In the order in which their names have features."""
    patterns = {one for cause in stated() for one in cause.trees if one.startswith("scene")}
    assert {one for one in patterns if not any(re.fullmatch(one, name) for name in scenes.trees())} == set()


def test_files_of_two_formats_have_no_reader_in_common() -> None:
    row: dict[str, Any] = {
        name: ["wrong", 0.5, 1e-12] for name in ("sdf: plain", "mjcf: plain", "mjcf: turned", "free")
    }
    engine = {"name": "toy", "version": "1", "conventions": [], "functions": {"gravity": "weight"}}
    toy: dict[str, Any] = {"engines": [engine], "cells": {"toy": {"gravity": row}}}
    models = [group.models for group in causes_of(parts.cells(toy), ())]
    assert sorted(models) == [("mjcf: plain", "mjcf: turned"), ("sdf: plain", "free")]


def test_a_line_names_drawn_trees_by_their_numbers() -> None:
    drawn = ["chain 3: oblique gravity, 0: shifted", "urdf: friction alone", "scene 11: 0: motor", "ball"]
    assert shown.named(drawn) == "chain 3, urdf: friction alone, scene 11 and 1 more"
