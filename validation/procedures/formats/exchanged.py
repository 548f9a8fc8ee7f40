"""What is written for others as they read it themselves, MuJoCo and Pinocchio; what exports say that they drop."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module, util
from typing import Any, Literal, cast

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ..scene import Cell, Scene, off
from .differences import robot
from .files import as_mjcf, as_urdf

WRITTEN, SAME = 1e-10, 0.5


def _states(model: sf.Model) -> tuple[Array, Array]:
    rng = np.random.default_rng(21)
    return rng.uniform(-0.4, 0.4, model.nq), rng.standard_normal(model.nv)


def by_mujoco(_: Scene) -> Iterator[Cell]:
    """MJCF of ours in MuJoCo: M, bias, springs, dampers, the coupling, places."""
    if util.find_spec("mujoco") is None:
        yield Cell("MJCF of ours in MuJoCo", 0.0, WRITTEN, absent="pip install mujoco")
        return
    mujoco = import_module("mujoco")
    stated = replace(as_mjcf(), bodies=as_mjcf().bodies[::-1])
    for what, system in (("an arm", as_mjcf()), ("an arm, bodies in another order", stated)):
        smooth = [_smooth(body) for body in system.bodies]
        system = replace(system, bodies=tuple(smooth))
        ours = sf.compile(system, sf.Options(backend="interpreter"))
        with tempfile.TemporaryDirectory() as folder:
            text = sf.export(system, "mjcf", folder).files[0].read_text(encoding="utf-8")
        m = mujoco.MjModel.from_xml_string(text)
        d = mujoco.MjData(m)
        q, v = _states(ours)
        order = [m.joint(name).dofadr[0] for name in ours.names.q]
        d.qpos[order], d.qvel[order] = q, v
        mujoco.mj_forward(m, d)
        M = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, M, d.qM) if hasattr(d, "qM") else mujoco.mj_fullM(m, d, M)
        body = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_BODY, "tool")
        p, R = ours.frame_pose("tool", q)
        pairs = (
            (M[np.ix_(order, order)], ours.mass_matrix(q)),
            (d.qfrc_bias[order], ours.bias(q, v)),
            (d.qfrc_passive[order], ours.generalized_force(q, v, [])),
            (d.xpos[body], p),
            (d.xmat[body].reshape(3, 3), R),
            (np.abs(d.efc_pos[:1]), np.abs(ours.constraint(q))),
        )
        yield Cell(f"MJCF of ours in MuJoCo, {what}", max(off(one, other) for one, other in pairs), WRITTEN)


def _smooth(body: Any) -> Any:
    """A body whose joint has no dry friction, which MuJoCo solves for otherwise."""
    elements = tuple(one for one in body.joint.elements if not isinstance(one, sf.Friction))
    return replace(body, joint=replace(body.joint, elements=elements, limits=None))


def by_pinocchio(_: Scene) -> Iterator[Cell]:
    """URDF of ours in Pinocchio: M, bias, places."""
    if util.find_spec("pinocchio") is None:
        yield Cell("URDF of ours in Pinocchio", 0.0, WRITTEN, absent="pip install pin")
        return
    pinocchio = import_module("pinocchio")
    for what, turn in (("an arm", 1), ("an arm, bodies in another order", -1)):
        system = replace(as_urdf(), constraints=(), bodies=as_urdf().bodies[::turn])
        ours = sf.compile(system, sf.Options(backend="interpreter"))
        with tempfile.TemporaryDirectory() as folder:
            text = sf.export(system, "urdf", folder).files[0].read_text(encoding="utf-8")
        m = pinocchio.buildModelFromXML(text)
        d = m.createData()
        q, v = _states(ours)
        joints = [m.joints[m.getJointId(name)] for name in ours.names.q]
        there_q, there_v = pinocchio.neutral(m), np.zeros(m.nv)
        for joint, x, rate in zip(joints, q, v, strict=True):
            there_q[joint.idx_q : joint.idx_q + joint.nq] = [x] if joint.nq == 1 else [np.cos(x), np.sin(x)]
            there_v[joint.idx_v] = rate
        order = [joint.idx_v for joint in joints]
        M = pinocchio.crba(m, d, there_q)
        M = np.triu(M) + np.triu(M, 1).T
        bias = pinocchio.rnea(m, d, there_q, there_v, 0 * there_v)
        pinocchio.framesForwardKinematics(m, d, there_q)
        there = d.oMf[m.getFrameId("tool")]
        p, R = ours.frame_pose("tool", q)
        pairs = (
            (M[np.ix_(order, order)], ours.mass_matrix(q)),
            (bias[order], ours.bias(q, v)),
            (there.translation, p),
            (there.rotation, R),
        )
        yield Cell(f"URDF of ours in Pinocchio, {what}", max(off(one, other) for one, other in pairs), WRITTEN)


def _noisy() -> sf.System:
    """The robot with what formats can't hold: a spring that hardens, an actuated ball, a beam's load, a potential."""
    system = robot()
    hard = (sf.Spring(3.0, cubic=2.0),)
    changed = []
    for body in system.bodies:
        joint = body.joint
        assert joint is not None
        if body.name == "lower":
            joint = replace(joint, elements=hard)
        if body.name == "arm":
            joint = replace(joint, actuated=True)
        changed.append(replace(body, joint=joint))
    potential = sf.Potential("well", sf.formula("s^2"))
    return replace(system, bodies=tuple(changed), potentials=(potential,))


def _heavy() -> sf.System:
    """The gripper with an armature, a spring, a motor and a load."""
    system = as_urdf()
    changed: list[Any] = []
    for body in system.bodies:
        joint = body.joint
        assert joint is not None
        if body.name == "upper":
            joint = replace(joint, armature=0.1, elements=(*joint.elements, sf.Spring(3.0)), actuated=True)
        loads = (sf.Load(force=(0, 0, 1.0)),) if body.name == "lower" else ()
        changed.append(replace(cast(Any, body), joint=joint, loads=loads))
    return replace(system, bodies=tuple(changed))


# What notes say, in the order of the notes; the joints that each names.
_LIMITED = r"^limits of travel and effort, data here, act in MuJoCo, .*: q1$"
_SPEED = "^limits of speed dropped: q1$"
_MIMIC = "^couplings as <mimic>, .*: mimic$"
_RUBBED = "^springs, stops and friction of joints dropped: shoulder$"
_NOTES: dict[str, tuple[tuple[str, sf.System, tuple[str, ...]], ...]] = {
    "mjcf": (
        ("a robot", robot(), (r"^friction, stops, .* dropped: q1$", _SPEED, _LIMITED)),
        (
            "what it can't hold",
            _noisy(),
            (
                "^potentials dropped: well$",
                r"^friction, stops, .* dropped: q1, s$",
                "^actuators of ball and free joints dropped: b$",
                _SPEED,
                _LIMITED,
            ),
        ),
    ),
    "urdf": (
        ("a gripper", as_urdf(), (_MIMIC, _RUBBED)),
        (
            "what it can't hold",
            _heavy(),
            (
                "^loads dropped: lower$",
                _MIMIC,
                _RUBBED,
                "^which joints are driven .*; these are not: elbow, grip$",
                "^armature dropped: shoulder$",
            ),
        ),
    ),
}


def noted(_: Scene) -> Iterator[Cell]:
    """Notes of exports: each of what was dropped, and none of what was not."""
    bare = replace(as_urdf(), constraints=(), bodies=tuple(map(_smooth, as_urdf().bodies)))
    for target, cases in _NOTES.items():
        for what, system, wanted in (("an arm", bare, ()), *cases):
            with tempfile.TemporaryDirectory() as folder:
                notes = sf.export(system, cast(Literal["mjcf", "urdf"], target), folder).notes
            said = [bool(re.search(pattern, note)) for pattern, note in zip(wanted, notes, strict=False)]
            wrong = len(notes) != len(wanted) or not all(said)
            yield Cell(f"notes of {target.upper()} of {what}", float(wrong), SAME, "; ".join(notes) if wrong else "")
