"""What is written is read again by its target's own reader: the same mechanics, limits and names, or a note."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest

import symofros as sf
from symofros.mechanics.topology.coordinates import coordinate_names, speed_names
from tests.exports.interchange.stated_trees import SERIES, WITH_BALLS, stated_tree
from tests.models import sampled

# Noise of the matrices that are stated is said, too, and is not the matter here.
pytestmark = pytest.mark.filterwarnings("ignore::symofros.InconsistentModelWarning")
# MuJoCo diagonalises inertias; noise of 1e-6 in what is stated is noise in both.
MUJOCO = 1e-9
SAME = 1e-11
# What binds nothing in URDF.
FAR = 1e9
SEEDS = [f"tree{seed}" for seed in range(60)]
SAMPLED = sampled(SEEDS, SEEDS[:5])


def joints(system: sf.System) -> list[sf.Joint]:
    return [body.joint for body in system.bodies if body.joint is not None and body.joint.kind != "fixed"]


def noted(done: sf.Exported, words: str, name: str) -> bool:
    """Whether a note with these words names this joint."""
    reported = [note.partition(": ")[2] for note in done.notes if words in note]
    return any(f", {name}, " in f", {names}, " for names in reported)


def linear_damping(joint: sf.Joint, k: int) -> float:
    return sum(float(e.coefficient) for e in joint.elements if isinstance(e, sf.Damper) and e.coordinate == k)  # type: ignore[arg-type]


def close(found: np.ndarray, wanted: np.ndarray, tolerance: float) -> None:
    np.testing.assert_allclose(found, wanted, rtol=0, atol=tolerance * max(1.0, float(np.abs(wanted).max())))


@pytest.mark.parametrize("seed", SAMPLED)
def test_mjcf_is_read_back_by_mujoco(tmp_path: Path, seed: str) -> None:
    system = stated_tree(int(seed[4:]), kinds=WITH_BALLS)
    done = sf.export(system, "mjcf", tmp_path)
    try:
        engine = mujoco.MjModel.from_xml_path(str(done.files[0]))
    except ValueError as error:
        assert any("MuJoCo refuses" in note for note in done.notes), error
        return
    model = sf.compile(system, sf.Options(backend="interpreter"))
    q, v = model.random_state(np.random.default_rng(1))
    data = mujoco.MjData(engine)
    order = np.zeros(model.nv, dtype=int)
    for joint in joints(system):
        at = [model.names.v.index(name) for name in speed_names(joint)]
        order[at] = _read_by_mujoco(done, engine, data, joint, model, q, v)
    mujoco.mj_forward(engine, data)
    M = np.zeros((engine.nv, engine.nv))
    mujoco.mj_fullM(engine, data, M)
    close(M[np.ix_(order, order)], model.mass_matrix(q), MUJOCO)
    close(data.qfrc_bias[order], model.bias(q, v), MUJOCO)
    if not any(words in note for note in done.notes for words in ("friction, stops", "differ between", "cancels")):
        passive = model.generalized_force(q, v, np.zeros(model.nu))
        close((data.qfrc_spring + data.qfrc_damper)[order], passive, MUJOCO)
    known = {engine.site(i).name for i in range(engine.nsite)} | {engine.body(i).name for i in range(engine.nbody)}
    carriers = "frames of bodies that only carry dropped"
    root = system.bodies[0].name
    bare = {body.name for body in system.bodies if body.inertia is None}
    missing = {*model.names.frames} - known - bare - {root}
    assert [name for name in missing if not noted(done, carriers, name)] == []


def _read_by_mujoco(
    done: sf.Exported,
    engine: mujoco.MjModel,
    data: mujoco.MjData,
    joint: sf.Joint,
    model: sf.Model,
    q: np.ndarray,
    v: np.ndarray,
) -> list[int]:
    """Set the state of a joint, compare what is stated of it; its indices among MuJoCo's speeds."""
    at_q = [model.names.q.index(name) for name in coordinate_names(joint)]
    at_v = [model.names.v.index(name) for name in speed_names(joint)]
    if joint.kind == "ball":
        parts, sizes = [engine.joint(joint.name)], [3]
        x = q[at_q]
        data.qpos[parts[0].qposadr[0] + np.arange(4)] = [x[3], x[0], x[1], x[2]]
    else:
        parts = [engine.joint(name) for name in coordinate_names(joint)]
        sizes = [1] * len(parts)
        for part, value in zip(parts, q[at_q], strict=True):
            data.qpos[part.qposadr[0]] = value
    order = [int(part.dofadr[0]) + k for part, size in zip(parts, sizes, strict=True) for k in range(size)]
    data.qvel[order] = v[at_v]
    np.testing.assert_array_equal(engine.dof_armature[order], joint.armature)
    for k, dof in enumerate(order):
        wanted = (
            linear_damping(joint, k)
            if all(e.quadratic == 0.0 for e in joint.elements if isinstance(e, sf.Damper))
            else None
        )
        if wanted is not None and not noted(done, "differ between", joint.name):
            assert engine.dof_damping[dof] == pytest.approx(wanted, rel=1e-15)
    for k, part in enumerate(parts):
        springs = [e for e in joint.elements if isinstance(e, sf.Spring) and e.coordinate == k and e.cubic == 0.0]
        stiffness = np.array([float(e.stiffness) for e in springs])  # type: ignore[arg-type]
        assert engine.jnt_stiffness[part.id] == pytest.approx(stiffness.sum(), rel=1e-15)
        if springs:
            rest = stiffness @ [float(e.rest) for e in springs] / stiffness.sum()  # type: ignore[arg-type]
            assert engine.qpos_spring[part.qposadr[0]] == pytest.approx(rest, rel=1e-14)
    stated = joint.limits or sf.Limits()
    if len(parts) > 1 or joint.kind == "ball":
        for words in _lost(stated, "travel", "speed", "effort"):
            assert noted(done, words, joint.name)
        return order
    j = parts[0].id
    bounded = stated.lower is not None or stated.upper is not None
    if bounded and stated.lower != stated.upper:
        assert engine.jnt_limited[j]
        lower, upper = engine.jnt_range[j]
        assert (lower if np.isfinite(lower) else None, upper if np.isfinite(upper) else None) == (
            stated.lower,
            stated.upper,
        )
    else:
        assert not engine.jnt_limited[j]
        assert not bounded or noted(done, "leave one place", joint.name)
    assert bool(engine.jnt_actfrclimited[j]) == bool(stated.effort)
    assert not stated.effort or tuple(engine.jnt_actfrcrange[j]) == (-stated.effort, stated.effort)
    assert all(noted(done, words, joint.name) for words in _lost(stated, "speed"))
    return order


def _lost(limits: sf.Limits, *measures: str) -> list[str]:
    """Words of the notes on limits of these kinds, where they are stated."""
    stated = {
        "travel": limits.lower is not None or limits.upper is not None,
        "speed": limits.velocity,
        "effort": limits.effort,
    }
    return [f"limits of {measure} dropped" for measure in measures if stated[measure]]


@pytest.mark.parametrize("seed", SAMPLED)
def test_urdf_is_read_back_by_pinocchio_and_our_reader(tmp_path: Path, seed: str) -> None:
    system = stated_tree(int(seed[4:]), kinds=SERIES)
    done = sf.export(system, "urdf", tmp_path)
    engine = pinocchio.buildModelFromUrdf(str(done.files[0]))
    model, back = (sf.compile(one, sf.Options(backend="interpreter")) for one in (system, sf.load(done.files[0])))
    q, v = model.random_state(np.random.default_rng(1))
    names = list(engine.names)[1:]
    assert {*names} == {*back.names.v} == {*model.names.v}
    order = [model.names.v.index(name) for name in names]
    theirs = np.concatenate(
        [
            [np.cos(x), np.sin(x)] if joint.nq == 2 else [x]
            for x, joint in zip(q[order], list(engine.joints)[1:], strict=True)
        ]
    )
    armature = {name: float(joint.armature) for joint in joints(system) for name in speed_names(joint)}  # type: ignore[arg-type]
    wanted = (model.mass_matrix(q) - np.diag([armature[name] for name in model.names.v]))[np.ix_(order, order)]
    data = engine.createData()
    M = np.triu(pinocchio.crba(engine, data, theirs))
    close(M + np.triu(M, 1).T, wanted, SAME)
    engine.gravity.linear = np.array(system.gravity)
    close(pinocchio.nonLinearEffects(engine, data, theirs, v[order]), model.bias(q, v)[order], SAME)
    ours = [back.names.v.index(name) for name in names]
    again = np.zeros(back.nq)
    again[ours] = q[order]
    close(back.mass_matrix(again)[np.ix_(ours, ours)], wanted, SAME)
    read = {joint.name: joint for joint in joints(sf.load(done.files[0]))}
    for joint in joints(system):
        _read_by_urdf(done, engine, read, joint)
    assert {*model.names.frames} - {system.bodies[0].name} <= {*back.names.frames} | {"world"}


def _read_by_urdf(done: sf.Exported, engine: pinocchio.Model, read: dict[str, sf.Joint], joint: sf.Joint) -> None:
    """Compare limits and damping of a joint with what its readers found."""
    dampers = [e for e in joint.elements if isinstance(e, sf.Damper)]
    for k, name in enumerate(speed_names(joint)):
        at = engine.joints[engine.getJointId(name)].idx_v
        assert engine.damping[at] == pytest.approx(linear_damping(joint, k), rel=1e-15)
    if any(e.quadratic for e in dampers):
        assert noted(done, "dampers that are not linear", joint.name)
    stated = joint.limits or sf.Limits()
    if joint.traits.nv > 1:
        assert all(noted(done, words, joint.name) for words in _lost(stated, "travel", "speed", "effort"))
        return
    found = read[joint.name].limits or sf.Limits()
    assert _bounds(found) == _bounds(stated)
    part = engine.joints[engine.getJointId(joint.name)]
    if stated.effort:
        assert engine.effortLimit[part.idx_v] == stated.effort
    if part.nq == 1 and stated.lower is not None:
        assert engine.lowerPositionLimit[part.idx_q] == stated.lower


def _bounds(limits: sf.Limits) -> tuple[float | None, ...]:
    """The four numbers, None where they bind nothing."""
    numbers = (limits.lower, limits.upper, limits.velocity or None, limits.effort or None)
    return tuple(None if x is None or abs(x) >= FAR else x for x in numbers)


@pytest.mark.parametrize("target", ["c", "mex", "sfunction", "fmu2", "fmu3", "wasm", "cuda"])
def test_other_targets_note_that_limits_are_dropped(
    target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Numbers in text alone: nothing is compiled here."""
    monkeypatch.setattr("symofros.exports.fmi.fmu.shared_library", lambda *_: b"")
    monkeypatch.setattr("symofros.exports.wasm.wasm.wasm_module", lambda _: b"")
    joint = sf.Joint("k", "prismatic", limits=sf.Limits(-0.1, None, 1.0, 40.0))
    drawer = sf.System("drawer", (sf.RigidBody("tray", joint, sf.Inertia(1.0)),))
    notes = sf.export(drawer, target, tmp_path).notes  # type: ignore[arg-type]
    assert {*notes} >= {f"limits of {measure} dropped: k" for measure in ("travel", "speed", "effort")}


def _arm(*bodies: tuple[str, sf.Joint, tuple[str, ...]], constraints: tuple[sf.Closure, ...] = ()) -> sf.System:
    """Bodies on their joints, the k-th of its frames k + 1 decimetres along x."""
    made = tuple(
        sf.RigidBody(
            name,
            joint,
            sf.Inertia(1.0, (0.1, 0.0, 0.2), (0.1, 0.2, 0.2)),
            tuple(sf.Frame(frame, (0.1 * (k + 1), 0.0, 0.0)) for k, frame in enumerate(frames)),
        )
        for name, joint, frames in bodies
    )
    return sf.System("named", made, constraints=constraints)


CLASHES = {
    "joint of a frame": _arm(
        ("a", sf.Joint("tip_fixed", "revolute"), ("tip",)),
        ("b", sf.Joint("x", "revolute", "a", "tip"), ("c", "c_fixed")),
    ),
    "link of a series": _arm(("a", sf.Joint("u", "universal"), ()), ("a[0]", sf.Joint("q", "revolute", "a"), ())),
    "dots": _arm(("a", sf.Joint("q1", "revolute"), ("tip", "b.tip")), ("b", sf.Joint("q2", "revolute", "a"), ("tip",))),
    "ground": _arm(("a", sf.Joint("q1", "revolute"), ("world",))),
}


@pytest.mark.parametrize("case", CLASHES)
def test_names_that_files_add_are_no_names_of_the_system(tmp_path: Path, case: str) -> None:
    system = CLASHES[case]
    model = sf.compile(system, sf.Options(backend="interpreter"))
    q = np.linspace(0.1, 0.7, model.nq)
    file = sf.export(system, "urdf", tmp_path / "urdf").files[0]
    engine = pinocchio.buildModelFromUrdf(str(file))
    order = [model.names.q.index(name) for name in list(engine.names)[1:]]
    data = engine.createData()
    places = [x for value in q[order] for x in (np.cos(value), np.sin(value))]  # Turns without limits.
    pinocchio.framesForwardKinematics(engine, data, np.array(places))
    found = {frame.name: data.oMf[k].translation for k, frame in enumerate(engine.frames)}
    for name in model.names.frames:
        close(found[name], model.frame_pose(name, q)[0], SAME)
    mujoco.MjModel.from_xml_path(str(sf.export(system, "mjcf", tmp_path / "mjcf").files[0]))


def test_closures_of_bodies_with_frames_called_origin_stand_on_the_bodies(tmp_path: Path) -> None:
    closure = sf.Closure("c", ("a", None), ("b", None), ("x", "y", "z"), ())
    system = _arm(
        ("a", sf.Joint("q1", "revolute"), ("origin",)),
        ("b", sf.Joint("q2", "revolute", "a", "origin"), ("origin",)),
        constraints=(closure,),
    )
    engine = mujoco.MjModel.from_xml_path(str(sf.export(system, "mjcf", tmp_path).files[0]))
    np.testing.assert_array_equal(engine.site_pos[[engine.eq_obj1id[0], engine.eq_obj2id[0]]], np.zeros((2, 3)))
