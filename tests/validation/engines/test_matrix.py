"""Engines against the truth, on small trees; and whether the matrix can go red."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.late import require
from validation.engines.identities import held
from validation.engines.interface import Array, EnginePlugin, Slot, Tree, Unsupported
from validation.engines.matrix import SEED, Judged, Truths, cells, judged
from validation.engines.models.files.formats import formats
from validation.engines.models.files.readers import Reading
from validation.engines.models.hostile import trees
from validation.engines.models.kinds import KINDS, tree_of
from validation.engines.plugins import OWN
from validation.engines.proving import scripts
from validation.engines.proving.pieces import Layout
from validation.engines.proving.proofs import Fault, dealt, faults
from validation.engines.truth.dynamics import random_state
from validation.engines.verdicts import Cell, expected, judge
from validation.engines.workers import Answer, Crashed, Job, Worker, answered

SIMPLE = ("mass_matrix", "bias", "link_jacobians", "kinetic_energy")


@pytest.mark.parametrize("engine", ["pinocchio", "mujoco"])
@pytest.mark.parametrize("kind", ["ball", "universal", "prismatic oblique", "free", "cylindrical", "three hinges"])
def test_an_engine_is_right_about_a_joint_between_oblique_links(engine: str, kind: str) -> None:
    verdicts = {cell.function: cell.verdict for cell in cells(OWN[engine], tree_of(kind), SIMPLE)}
    assert verdicts == dict.fromkeys(SIMPLE, "right")


@pytest.mark.parametrize("kind", [name for name in KINDS if name not in ("euler xyz", "revolute unbounded oblique")])
def test_pinocchio_is_right_for_every_kind_of_joint(kind: str) -> None:
    (cell,) = cells(OWN["pinocchio"], tree_of(kind), ("mass_matrix",))
    # What a joint that mimics another adds to M, crba leaves in the data for its next call.
    said = "at speeds times 100, after another state on the same model: right by itself"
    assert (cell.verdict, cell.words) == (("wrong", said) if kind.startswith("mimic") else ("right", ""))


@pytest.mark.parametrize(
    "name",
    [
        "fixed links amid",
        "hinges at one point",
        "oblique gravity",
        "kilometres",
        "base 10 km away",
        "free base 10 km away",
    ],
)
def test_engines_are_right_about_hostile_trees(name: str) -> None:
    for engine in ("pinocchio", "mujoco"):
        assert {cell.verdict for cell in cells(OWN[engine], trees()[name], SIMPLE)} == {"right"}


# The reader that is held for each format's best.
_BEST = {"urdf": "pinocchio", "mjcf": "mujoco", "sdf": "drake", "mjcf written": "mujoco"}
_FILES = {name: one for name, one in formats().items() if one.form in _BEST and OWN[_BEST[one.form]].version()}


# What our reader refuses in words; what the best one does, where a follower has no limits or <dynamics> states nothing.
_REFUSED = {
    "symofros": "sdf: .*(placement frame|inertia computed of)",
    "pinocchio": "urdf: .*(losses left out|continuous.* mimic)",
}


# What the best reader of a format reads wrong, with a cause.
_WRONG = {
    "mujoco": "mjcf: actuator: at a site of two, by the reference site",
    "pinocchio": "urdf: damping of a planar joint",
}


@pytest.mark.parametrize("name", _FILES)
def test_our_reader_and_the_best_of_a_format_read_what_its_files_state(name: str) -> None:
    reading = _FILES[name]
    for plugin in (OWN["symofros"], OWN[_BEST[reading.form]]):
        if reading.form in plugin.formats:
            refused = {"refuses"} if re.match(_REFUSED.get(plugin.name, "$"), name) else set()
            stated = {"wrong"} if _WRONG.get(plugin.name) == name else set()
            assert _verdicts(plugin, reading) <= {"right", "not offered"} | refused | stated, plugin.name


_STAGES = {name: one for name, one in formats().items() if one.form == "usd"}


@pytest.mark.parametrize("name", _STAGES)
def test_our_reader_reads_what_stages_state(name: str) -> None:
    require("pxr", "usd")
    # Drives of stages and what their joints follow are none of ours.
    wanted = {"usd: drive": {"not offered"}, "usd: coupled": set(), "usd: equality": set()}
    of_kind = next((verdicts for kind, verdicts in wanted.items() if name.startswith(kind)), {"right"})
    assert _verdicts(OWN["symofros"], _STAGES[name]) == of_kind


@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("up along Y, gravity left out", "gravity left out"),
        ("cube of its own density", "cube by default"),
        ("cube of its own mass", "cube of its own density"),
    ],
)
def test_axes_and_densities_of_stages_that_are_forgotten_are_red_cells(name: str, other: str) -> None:
    layout = Layout(1, 1, ((Slot("angle", (0,), (0,)),),))
    one, given = (_STAGES[f"usd: {which}"].tree for which in (name, other))
    state = random_state(one, layout, SEED)
    want, forgotten = (expected("bias", tree, layout, state) for tree in (one, given))
    assert judge("planted", one, "bias", want.value, want).verdict == "right"
    assert judge("planted", one, "bias", forgotten.value, want).verdict == "wrong"


def _verdicts(plugin: EnginePlugin, reading: Reading) -> set[str]:
    job = Job(
        plugin.name, reading.tree, reading.functions(plugin.functions), SEED, form=reading.form, text=reading.text
    )
    return {one.cell.verdict for one in judged(plugin, job, Truths())}


def test_a_range_in_the_unit_of_angles_and_ranges_of_joints_in_another_order_are_red_cells() -> None:
    reading = _FILES["mjcf: ranges of two joints, angle left out"]
    job = Job("mujoco", reading.tree, ("joint_limits",), SEED, form=reading.form, text=reading.text)
    (one,) = judged(OWN["mujoco"], job, Truths())
    assert one.want is not None and one.cell.verdict == "right"
    answer = np.asarray(one.answer.value)
    for planted in (np.vstack([answer[:2], np.radians(answer[2:])]), answer[[0, 2, 1]]):
        assert judge("planted", reading.tree, "joint_limits", planted, one.want).verdict == "wrong"


@pytest.mark.parametrize("named", ["limited false", "limited false, autolimits false", "zeros", "zeros, limited auto"])
def test_a_range_that_limits_nothing_is_none_and_a_reader_that_keeps_it_is_red(named: str) -> None:
    reading = _FILES[f"mjcf: range without limits: {named}"]
    job = Job("mujoco", reading.tree, ("joint_limits_of_some",), SEED, form=reading.form, text=reading.text)
    (one,) = judged(OWN["mujoco"], job, Truths())
    assert one.want is not None and one.cell.verdict == "right"
    kept = np.vstack([np.asarray(one.answer.value)[:1], [-0.5, 1.25]])
    assert judge("planted", reading.tree, "joint_limits_of_some", kept, one.want).verdict == "wrong"


def test_digits_that_are_lost_about_a_far_origin_are_seen() -> None:
    verdicts = {
        engine: next(cells(OWN[engine], trees()["base 10 km away"], ("mass_matrix_inverse",))).verdict
        for engine in ("pinocchio", "mujoco")
    }
    assert verdicts == {"pinocchio": "imprecise", "mujoco": "right"}


def _judged(kind: str, *functions: str) -> list[Judged]:
    plugin = OWN["pinocchio"]
    return list(judged(plugin, Job(plugin.name, tree_of(kind), functions, SEED), Truths()))


def _permuted(value: Array) -> Array:
    return value[::-1]


def _one_sign(value: Array) -> Array:
    changed = value.copy()
    changed[0, 1] = -changed[0, 1]
    return changed


def _one_scaled(value: Array) -> Array:
    changed = value.copy()
    changed[-1, -1] *= 1.0 + 1e-5
    return changed


@pytest.mark.parametrize("fault", [_permuted, _one_sign, _one_scaled])
def test_a_planted_fault_in_an_answer_is_a_red_cell(fault: object) -> None:
    (one,) = _judged("universal", "mass_matrix")
    assert one.want is not None and callable(fault)
    cell = judge("planted", one.tree, "mass_matrix", fault(np.asarray(one.answer.value)), one.want)
    assert cell.verdict == "wrong" and cell.error > cell.tolerance


def test_lost_digits_are_not_called_gross_faults() -> None:
    (one,) = _judged("universal", "mass_matrix")
    assert one.want is not None
    near = np.asarray(one.answer.value) * (1.0 + 1e-8)
    assert judge("planted", one.tree, "mass_matrix", near, one.want).verdict == "imprecise"
    assert judge("planted", one.tree, "mass_matrix", Unsupported("no"), one.want).verdict == "refuses"


def test_identities_hold_where_they_must_and_show_a_fault_that_is_one() -> None:
    functions = ("mass_matrix", "bias", "inverse_dynamics", "coriolis_forces", "gravity")
    broken = {
        kind: {row.identity for row in held(_judged(kind, *functions)) if not row.ok} for kind in ("ball", "universal")
    }
    assert broken == {"ball": set(), "universal": {"C v + g = h"}}


def test_scripts_of_trees_with_long_names_have_files_of_their_own(tmp_path: Path) -> None:
    red, _ = _judged("universal", "coriolis_forces", "bias")
    long = [replace(red, cell=replace(red.cell, model=f"scene 3: {'mocap weld, ' * 30}{last}")) for last in "ab"]
    names = [scripts.file_of(one) for one in (red, *long)]
    assert len(set(names)) == 3 and names[0] == "pinocchio-universal-coriolis_forces.py"
    for name in names:
        (tmp_path / name).write_text("")


def test_the_script_of_a_red_cell_fails_by_its_assertion_and_a_right_one_does_not(tmp_path: Path) -> None:
    red, right = _judged("universal", "coriolis_forces", "bias")
    for one, failing in ((red, True), (right, False)):
        path = tmp_path / "script.py"
        path.write_text(scripts.text(OWN["pinocchio"], one, "none"), encoding="utf-8")
        output, failed = scripts.fails(path)
        assert failed is failing, output


def test_an_engine_that_gives_no_answer_in_time_is_an_answer() -> None:
    with Worker(limit=0.0) as worker:
        answers = list(worker.ask(Job("pinocchio", tree_of("revolute x"), ("mass_matrix", "bias"), SEED)))
    assert [answer.value for answer in answers] == [Crashed("no answer in 0 s")] * 2


def test_a_dead_process_is_restarted() -> None:
    with Worker() as worker:
        job = Job("pinocchio", tree_of("revolute x"), ("mass_matrix", "bias"), SEED)
        assert all(isinstance(answer.value, np.ndarray) for answer in worker.ask(job))
        assert worker._process is not None
        worker._process.kill()
        worker._process.wait()
        assert all(isinstance(answer.value, np.ndarray) for answer in worker.ask(job))


def test_splitting_a_state_does_not_change_it() -> None:
    from validation.engines.proving.pieces import taken

    job = Job("pinocchio", tree_of("mimic revolute"), ("mass_matrix",), SEED)
    (answer,) = answered(job)
    assert answer.layout is not None and answer.state is not None
    (again,) = answered(replace(job, pieces=taken(answer.layout, answer.state)))
    np.testing.assert_array_equal(np.asarray(again.value), np.asarray(answer.value))


def test_trees_that_one_cause_shows_on_share_a_script() -> None:
    reds = [
        one
        for kind in ("universal", "three hinges", "euler zyx")
        for one in _judged(kind, "coriolis_forces", "coriolis_symmetry")
    ]
    assert [fault.models for fault in faults(reds).open] == [("universal", "three hinges", "euler zyx")] * 2


def test_two_processes_prove_half_of_the_faults_each_and_those_of_an_engine_together() -> None:
    counts = {"a": 1, "b": 5, "c": 2, "d": 3}
    made = [
        Fault(Judged(Cell(engine, str(k), "gravity", "wrong"), Answer("gravity", np.zeros(1)), None, Tree("", ())), ())
        for engine, count in counts.items()
        for k in range(count)
    ]
    lots = [[fault.first.cell.engine for fault in lot] for lot in dealt(made)]
    assert lots == [["b"] * 5 + ["a"], ["d"] * 3 + ["c"] * 2]
