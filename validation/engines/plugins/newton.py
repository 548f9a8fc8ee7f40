"""Newton: articulations of Warp on the CPU, by its API."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np

from ..interface import SINGLE, STEP, Array, Convention, Joint, Link, Slot, Statement, Tree, Unsupported
from .writing.source import Source, SourcePlugin, Way, numbered, series
from .writing.urdf import has_bare_shape

# Warp prints what it compiles unless this is set before it starts: `quiet` of older releases, the level of newer ones.
QUIET = "wp.config.quiet, wp.config.log_level = True, 30"
# Newton's import starts Warp. `b` is the builder, `m` the model.
_IMPORTS = ("import numpy as np, warp as wp", QUIET, "import newton")
_AXIS = "axis = newton.ModelBuilder.JointDofConfig"
_ROTATION = (
    "def rotation(x, y, z, w):",
    "    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])",
    "    return np.eye(3) + 2 * w * K + 2 * K @ K",
)
_CENTRES = ("def centres(s): return [rotation(*x[3:]) @ c for x, c in zip(s.body_q.numpy(), m.body_com.numpy())]",)
_Q = (
    "s = m.state()\ns.joint_q.assign(q.astype(np.float32))\ns.joint_qd.zero_()\n"
    "newton.eval_fk(m, s.joint_q, s.joint_qd, s)\n"
)
_QV = _Q.replace("s.joint_qd.zero_()", "s.joint_qd.assign(v.astype(np.float32))")


def _passive(name: str) -> str:
    out = f"{name} = wp.zeros(m.joint_dof_count, device='cpu')"
    return f"{out}\nnewton.eval_inverse_dynamics_passive(m, s, {name}_force={name})\n"


WAYS = {
    "mass_matrix": Way("eval_mass_matrix", f"{_Q}value = newton.eval_mass_matrix(m, s).numpy()[0]"),
    "gravity": Way("eval_inverse_dynamics_passive", f"{_Q}{_passive('gravity')}value = gravity.numpy()"),
    "coriolis_forces": Way("eval_inverse_dynamics_passive", f"{_QV}{_passive('coriolis')}value = coriolis.numpy()"),
    "inverse_dynamics": Way(
        "eval_inverse_dynamics_force",
        f"{_QV}{_passive('gravity')}{_passive('coriolis')}out = wp.zeros(m.joint_dof_count, device='cpu')\n"
        "M = newton.eval_mass_matrix(m, s)\n"
        "newton.eval_inverse_dynamics_force(m, s, mass_matrix=M, joint_qdd=wp.array(a, dtype=float, device='cpu'),"
        " coriolis_force=coriolis, gravity_force=gravity, joint_f=out)\nvalue = out.numpy()",
    ),
    "link_poses": Way("eval_fk", f"{_Q}value = [[*x[:3], *rotation(*x[3:]).flat] for x in s.body_q.numpy()]"),
    "link_velocities": Way(
        "eval_fk",
        f"{_QV}rotation\n"
        "value = [[*(x[:3] - np.cross(x[3:], r)), *x[3:]] for x, r in zip(s.body_qd.numpy(), centres(s))]",
    ),
    # Of the mass centres.
    "link_jacobians": Way(
        "eval_jacobian",
        f"""rotation
{_Q}J = newton.eval_jacobian(m, s).numpy()[0].reshape(-1, 6, len(v))
value = [np.concatenate([j[:3] - np.cross(j[3:].T, r).T, j[3:]]) for j, r in zip(J, centres(s))]""",
    ),
}
WAYS["step_semi_implicit_normalized"] = Way(
    "SolverFeatherstone",
    f"""solver, after, control = newton.solvers.SolverFeatherstone(m, angular_damping=0.0), m.state(), m.control()
{_QV}control.joint_f.assign(tau.astype(np.float32))
solver.step(s, after, control, None, {STEP})
value = np.r_[after.joint_q.numpy(), after.joint_qd.numpy()]""",
)


WAYS |= {
    "frame_poses": Way(
        "add_site",
        f"""{_Q}rotation, sensed
value = []
for k in sensed:
    at = [x.split('/')[-1] for x in m.shape_label].index(f'o{{k}}')
    body, own = m.shape_body.numpy()[at], m.shape_transform.numpy()[at]
    x = s.body_q.numpy()[body] if body >= 0 else np.array([0.0, 0, 0, 0, 0, 0, 1])
    R = rotation(*x[3:])
    value.append([*(x[:3] + R @ own[:3]), *(R @ rotation(*own[3:])).flat])""",
    ),
    "joint_dampings": Way(
        "joint_damping, mujoco.dof_passive_damping",
        "value = m.joint_damping.numpy() if hasattr(m, 'joint_damping') else m.mujoco.dof_passive_damping.numpy()",
    ),
    "joint_speed_limits": Way("joint_velocity_limit", "value = m.joint_velocity_limit.numpy()"),
    "joint_force_limits": Way("joint_effort_limit", "value = m.joint_effort_limit.numpy()"),
    "joint_limits": Way(
        "joint_limit_lower, joint_limit_upper",
        "value = np.c_[m.joint_limit_lower.numpy(), m.joint_limit_upper.numpy()]",
    ),
    "joint_frictions": Way("joint_friction", "value = m.joint_friction.numpy()"),
    "joint_stiffnesses": Way("mujoco.dof_passive_stiffness", "value = m.mujoco.dof_passive_stiffness.numpy()"),
}


def _array(values: object) -> str:
    return repr(np.asarray(values, dtype=float).tolist())


def quaternion(R: Array) -> Array:
    """Quaternion (x, y, z, w) of a rotation."""
    w = np.sqrt(max(0.0, 1.0 + np.trace(R))) / 2.0
    if w > 0.1:
        vector = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / (4.0 * w)
        return np.array([*vector, w])
    values, vectors = np.linalg.eigh(R + R.T)
    axis = vectors[:, int(np.argmax(values))]
    angle = np.arctan2(axis @ np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]), np.trace(R) - 1.0)
    return np.array([*(axis * np.sin(angle / 2.0)), np.cos(angle / 2.0)])


def _placement(R: Array, p: Array) -> str:
    numbers = ", ".join(repr(float(x)) for x in quaternion(R))
    return f"wp.transform({_array(p)}, wp.quat({numbers}))"


def _axes(joint: Joint) -> tuple[list[str], list[str], str] | None:
    """Linear and angular axes of a joint with six or fewer, and its chart."""
    own = joint.armature or (0.0,) * 3

    def axis(number: int, along: object) -> str:
        # An axis without `target_ke` and `target_kd` takes the builder's.
        return f"axis(axis={_array(along)}, armature={own[number]!r}, target_ke=0, target_kd=0)"

    unit = np.eye(3)
    match joint.kind:
        case "revolute":
            return [], [axis(0, joint.axis)], "angle"
        case "prismatic":
            return [axis(0, joint.axis)], [], "length"
        case "universal":
            return [], [axis(0, joint.axis), axis(1, joint.second)], "two angles"
        case "euler":
            turns = (unit["XYZ".index(letter)] for letter in joint.sequence)
            return [], [axis(k, row) for k, row in enumerate(turns)], "three angles"
        case "translation":
            return [axis(k, row) for k, row in enumerate(unit)], [], "three lengths"
        case "planar":
            return [axis(0, unit[0]), axis(1, unit[1])], [axis(2, unit[2])], "planar angle"
    return None


def _call(link: Link, steps: tuple[tuple[Array, Array, Joint], ...]) -> tuple[str, list[tuple[str, int, int]]] | str:
    """The joint of a link as a call, and chart, coordinates, speeds of each part; a reason where there is none."""
    if not steps:
        return "b.add_joint_fixed({ends})", []
    _, _, joint = steps[0]
    if any(one.form or one.mimics for _, _, one in steps):
        return "no such form of a joint"
    alone = len(steps) == 1 and joint.kind in ("revolute", "prismatic")
    if any(one.damping or one.stiffness for _, _, one in steps) and not alone:
        return "dampers and springs stand on hinges and slides alone"
    if len(steps) == 1 and joint.kind == "ball":
        armature = joint.armature[0] if joint.armature else 0.0
        return f"b.add_joint_ball({{ends}}, armature={armature!r})", [("quaternion xyzw, parent speeds", 4, 3)]
    linear: list[str] = []
    angular: list[str] = []
    parts: list[tuple[str, int, int]] = []
    for number, (R, p, one) in enumerate(steps):
        found = _axes(one)
        if found is None:
            return f"no joint for {one.kind}"
        if number and (np.any(p) or not np.array_equal(R, np.eye(3)) or (found[0] and angular)):
            return "axes of one joint share a frame, linear before angular"
        linear, angular = linear + found[0], angular + found[1]
        parts.append((found[2], len(found[0]) + len(found[1]), len(found[0]) + len(found[1])))
    if alone:
        armature = joint.armature[0] if joint.armature else 0.0
        about = f"axis={_array(joint.axis)}, armature={armature!r}"
        forces = {"damping": joint.damping, "stiffness": joint.stiffness, "rest_q": joint.rest}
        about += "".join(f", {name}={value!r}" for name, value in forces.items() if value)
        return f"b.add_joint_{joint.kind}({{ends}}, {about})", parts
    return f"b.add_joint_d6({{ends}}, linear_axes=[{', '.join(linear)}], angular_axes=[{', '.join(angular)}])", parts


def _builder(tree: Tree) -> str:
    """A builder, with gravity where it is not the standard one: before 1.1 it was a number."""
    return (
        f"b = newton.ModelBuilder({'' if tree.gravity == Tree('', ()).gravity else f'gravity={list(tree.gravity)!r}'})"
    )


def _has_tiny_moments(tree: Tree, text: str) -> bool:
    """Whether a link has mass and a moment of inertia below 1e-6 kg m^2."""
    return any(link.mass and np.linalg.eigvalsh(np.array(link.inertia))[0] < 1e-6 for link in tree.links)


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds an articulation."""
    lines = [*_IMPORTS, _builder(tree)]
    slots: list[tuple[Slot, ...]] = []
    nq = nv = 0
    for k, link in enumerate(tree.links):
        body = f"mass={link.mass!r}, com={list(link.com)!r}, inertia=wp.mat33({_array(link.inertia)})"
        lines.append(f"b{k} = b.add_link({body}, lock_inertia=True)")
    joints = []
    for k, link in enumerate(tree.links):
        steps, (R_end, p_end) = series(link.joints)
        made: Any = _call(link, steps)
        if isinstance(made, str):
            return Unsupported(made, offered=False)
        call, parts = made
        R, p = (steps[0][0], steps[0][1]) if steps else (R_end, p_end)
        parent = "-1" if link.parent < 0 else f"b{link.parent}"
        ends = f"{parent}, b{k}"
        if np.any(p) or not np.array_equal(R, np.eye(3)):
            ends += f", parent_xform={_placement(R, p)}"
        if steps and (np.any(p_end) or not np.array_equal(R_end, np.eye(3))):
            ends += f", child_xform={_placement(R_end.T, -R_end.T @ p_end)}"
        if "=[axis(" in call and _AXIS not in lines:
            lines.append(_AXIS)
        lines.append(f"j{k} = {call.format(ends=ends)}")
        joints.append(f"j{k}")
        own = []
        for chart, coordinates, speeds in parts:
            own.append(Slot(chart, tuple(range(nq, nq + coordinates)), tuple(range(nv, nv + speeds))))
            nq, nv = nq + coordinates, nv + speeds
        slots.append(tuple(own))
    lines += [f"b.add_articulation([{', '.join(joints)}])", 'm = b.finalize(device="cpu")']
    return Source(tuple(lines), tuple(slots), nq, nv, {"rotation": _ROTATION, "centres": _CENTRES})


_READERS = {
    "urdf": "b.add_urdf(TEXT)",
    "mjcf": "b.add_mjcf(TEXT)",
    "usd": "from pxr import Usd\nstage = Usd.Stage.CreateInMemory()\nstage.GetRootLayer().ImportFromString(TEXT)\n"
    # A body on a joint in the world is none of its articulations, of which functions are asked.
    "b.add_usd(stage, apply_up_axis_from_stage=True)\n"
    "b.articulation_count or b.add_articulation(list(range(b.joint_count)))",
}
_CHARTS = {
    ("revolute", ""): "angle",
    ("revolute", "unbounded"): "angle",
    ("prismatic", ""): "length",
    ("ball", ""): "quaternion xyzw, parent speeds",
}


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has Newton read a file."""
    if any(joint.mimics for link in tree.links for joint in link.joints):
        return Unsupported("what mimics is a constraint of its solvers", offered=False)
    if form == "usd" and find_spec("pxr") is None:
        return Unsupported("OpenUSD is not installed: pip install usd-core", offered=False)
    made = numbered(tree, _CHARTS)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    names = [link.name for link in tree.links]
    lines = (
        *_IMPORTS,
        f"TEXT = {text!r}",
        _builder(tree) if form == "urdf" else "b = newton.ModelBuilder()",
        "newton.solvers.SolverMuJoCo.register_custom_attributes(b)",
        _READERS[form],
        'm = b.finalize(device="cpu")',
    )
    labels = f"bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in {names!r}]"
    optional = {"rotation": _ROTATION, "bodies": (labels,)}
    if tree.sensors:
        optional["sensed"] = (f"sensed = range({len(tree.sensors)})",)
    return Source(lines, slots, nq, nv, optional, spelling={"s.body_q.numpy()]": "s.body_q.numpy()[bodies]]"})


PLUGIN = SourcePlugin(
    name="newton",
    package="newton",
    extra="symofros[engine-newton]",
    conventions=(
        Convention("precision", "single"),
        Convention("quaternion", "scalar last"),
        Convention("ball joint", "angular velocity along the axes before the joint"),
        Convention("twists and Jacobians of links", "linear velocity of the mass centre, then angular, in the world"),
        Convention("step", "quaternions along their rate at the beginning, then brought to unit length"),
        Convention("armature", "an argument of the joint; 0.01 unless stated"),
        Convention(
            "free joint", "linear velocity of the mass centre: a speed that depends on the body; not asked here"
        ),
    ),
    kinds={
        "revolute x": "add_joint_revolute",
        "revolute y": "add_joint_revolute",
        "revolute z": "add_joint_revolute",
        "revolute oblique": "add_joint_revolute",
        "revolute with armature": "add_joint_revolute",
        "prismatic": "add_joint_prismatic",
        "prismatic oblique": "add_joint_prismatic",
        "ball": "add_joint_ball",
        "universal": "add_joint_d6",
        "planar": "add_joint_d6",
        "translation": "add_joint_d6",
        "euler xyz": "add_joint_d6",
        "euler zyx": "add_joint_d6",
        "cylindrical": "add_joint_d6",
        "three hinges": "add_joint_d6",
        "two slides and a hinge": "add_joint_d6",
        "translation and euler zyx": "add_joint_d6",
    },
    ways=WAYS,
    write=write,
    demands={"dampers": "damping", "springs": "stiffness, rest_q"},
    formats=tuple(_READERS),
    write_reading=write_reading,
    statements=(
        Statement(
            "precondition",
            "stages in other units than metres and kilograms are not supported, with a warning",
            "https://github.com/newton-physics/newton/pull/3219",
            holds=lambda tree, text: text.startswith("#usda"),
            warned="(metersPerUnit|kilogramsPerUnit)",
        ),
        Statement(
            "precondition",
            "coordinates of joints are counted from ref",
            "newton 1.8, newton/_src/utils/import_mjcf.py:2683: Newton joint coordinates use qpos - ref",
            holds=lambda tree, text: " ref=" in text,
        ),
        Statement(
            "precondition",
            "where <inertial> is missing, mass and moments are those of shapes, of the density of ShapeConfig",
            "newton 1.8, newton/_src/sim/builder.py: ShapeConfig.density",
            holds=has_bare_shape,
        ),
        Statement(
            "repairs",
            "inertias that are too small are made larger",
            "newton 1.8, newton/_src/sim/builder.py: ModelBuilder.finalize, its warning",
            holds=_has_tiny_moments,
            warned="Inertia validation corrected",
        ),
    ),
    roundoff=SINGLE,
)
