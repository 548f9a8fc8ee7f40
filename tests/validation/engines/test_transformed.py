"""Models that engines make of others, and one tree in three formats."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from validation.engines.interface import Joint, Link, Slot, Tree
from validation.engines.matrix import SEED, Truths, cells, judged
from validation.engines.models.files.formats import formats
from validation.engines.models.transformed import trees
from validation.engines.plugins import OWN
from validation.engines.proving.pieces import Layout
from validation.engines.truth.arithmetic import exact
from validation.engines.truth.dynamics import Truth, digits
from validation.engines.verdicts import judge
from validation.engines.workers import Job

FUNCTIONS = ("mass_matrix", "bias", "gravity", "link_jacobians")


@pytest.mark.parametrize("name", trees())
def test_engines_are_right_about_transformed_models(name: str) -> None:
    tree = trees()[name]
    offering = [
        engine for engine in ("pinocchio", "mujoco") if tree.demands <= set(getattr(OWN[engine], "demands", ()))
    ]
    assert offering
    for engine in offering:
        verdicts = {cell.verdict for cell in cells(OWN[engine], tree, FUNCTIONS)}
        assert verdicts <= {"right", "not offered"} and "right" in verdicts


@pytest.mark.parametrize("name", [name for name, tree in trees().items() if tree.attached and tree.forces])
def test_forces_on_attached_models_are_right(name: str) -> None:
    found = {cell.function: cell.verdict for cell in cells(OWN["mujoco"], trees()[name])}
    assert {"forward_dynamics", "step_forces_implicit"} <= set(found)
    assert {verdict for name, verdict in found.items() if not name.endswith((":attach", ":recompile"))} <= {
        *("right", "not offered")
    }


def test_a_tendon_that_attaching_leaves_out_is_a_red_cell() -> None:
    tree = trees()["attached tendon around a sphere"]
    names = ("passive_forces", "forward_dynamics")
    bare = replace(tree, tendons=tree.tendons[:1])
    both = (judged(OWN["mujoco"], Job("mujoco", at, names, SEED), Truths()) for at in (tree, bare))
    for one, less in zip(*both, strict=True):
        assert one.cell.verdict == less.cell.verdict == "right" and one.want is not None
        answer = np.asarray(less.answer.value)
        assert judge("planted", tree, one.cell.function, answer, one.want).verdict == "wrong"


def test_an_engine_that_locks_no_joints_is_asked_nothing_of_locked_ones() -> None:
    assert list(cells(OWN["mujoco"], trees()["locked hinge amid"])) == []


@pytest.mark.parametrize("what", ["mass", "inertia", "frame", "gravity"])
def test_a_change_that_an_engine_does_not_take_up_is_a_red_cell(what: str) -> None:
    changed = trees()[f"{what} changed"]
    (want,), (stale,) = (
        judged(OWN["mujoco"], Job("mujoco", tree, ("bias",), SEED), Truths()) for tree in (changed, changed.before)
    )
    assert want.cell.verdict == "right" and want.want is not None
    assert judge("planted", changed, "bias", np.asarray(stale.answer.value), want.want).verdict == "wrong"


def test_a_locked_joint_is_a_placement() -> None:
    hinge = Joint("revolute", axis=(0.0, 1.0, 0.0), p=(0.5, 0.0, 0.0))
    arm = Link("b", 0, (replace(hinge, locked=0.5),), 2.0, (0.25, 0.0, 0.0))
    c, s = float(np.cos(0.5)), float(np.sin(0.5))
    fixed = replace(arm, joints=(Joint("fixed", R=((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)), p=hinge.p),))
    layout = Layout(1, 1, ((Slot("angle", (0,), (0,)),), ()))
    M = [
        Truth(Tree("arm", (Link("a", -1, (hinge,)), last)), layout).value(lambda t, _: t.M(exact([0.25])), None)  # type: ignore[arg-type]
        for last in (arm, fixed)
    ]
    np.testing.assert_allclose(digits(M[0]), digits(M[1]), rtol=1e-15)


@pytest.mark.parametrize("name", [name for name in formats() if ": " not in name])
def test_readers_agree_about_a_tree_in_each_format(name: str) -> None:
    reading = formats()[name]
    for engine in ("pinocchio", "mujoco", "drake"):
        plugin = OWN[engine]
        if reading.form in plugin.formats and plugin.version():
            job = Job(engine, reading.tree, ("mass_matrix", "bias"), SEED, form=reading.form, text=reading.text)
            assert {one.cell.verdict for one in judged(plugin, job, Truths())} <= {"right"}
