"""Pinocchio: every joint model of its own API."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..functions import ALIGNED
from ..interface import Array, Difference, End, Joint, Slot, Tree, Unsupported
from .loops import pinocchio as constrained
from .writing.source import Source, SourcePlugin, Way, attached, in_series, series

# Kind and form of a joint -> joint model, chart, coordinates, speeds. {axis} is X, Y or Z where the axis is one of
# them.
_MODELS: dict[tuple[str, str], tuple[str, str, int, int]] = {
    ("revolute", ""): ("RevoluteUnaligned({axis})", "angle", 1, 1),
    ("revolute", "unbounded"): ("", "cos sin", 2, 1),
    ("prismatic", ""): ("PrismaticUnaligned({axis})", "length", 1, 1),
    ("helical", ""): ("HelicalUnaligned({axis}, {pitch!r})", "screw angle", 1, 1),
    ("universal", ""): ("Universal({axis}, {second})", "two angles", 2, 2),
    ("euler", ""): ("SphericalZYX()", "three angles", 3, 3),
    ("translation", ""): ("Translation()", "three lengths", 3, 3),
    ("ball", ""): ("Spherical()", "quaternion xyzw, body speeds", 4, 3),
    ("free", ""): ("FreeFlyer()", "free xyzw, body speeds", 7, 6),
    ("planar", ""): ("Planar()", "planar cos sin, body speeds", 4, 3),
    ("ellipsoid", ""): ("Ellipsoid({radii})", "ellipsoid angles", 3, 3),
}
_ALIGNED = {
    ("revolute", ""): "R{letter}()",
    ("revolute", "unbounded"): "RUB{letter}()",
    ("prismatic", ""): "P{letter}()",
    ("helical", ""): "H{letter}({pitch!r})",
}


_CLOSING = ("d = m.createData()",)


def _array(values: Any) -> str:
    if np.array_equal(values, np.eye(3)):
        return "np.eye(3)"
    if not np.any(values):
        return f"np.zeros({np.shape(values) if np.ndim(values) > 1 else len(values)})"
    if np.ndim(values) == 1 and len(values) == 3 and sorted(values) == [0.0, 0.0, 1.0]:
        return f"np.eye(3)[{list(values).index(1.0)}]"
    if np.ndim(values) == 2 and np.array_equal(values, np.diag(np.diagonal(values))):
        return f"np.diag({np.diagonal(values).tolist()!r})"
    return f"np.array({np.asarray(values, dtype=float).tolist()!r})"


def _placement(R: Array, p: Array) -> str:
    if np.array_equal(R, np.eye(3)) and not np.any(p):
        return "pin.SE3.Identity()"
    return f"pin.SE3({_array(R)}, {_array(p)})"


def _model(joint: Joint) -> str | Unsupported:
    """The text of a joint's model."""
    key = (joint.kind, joint.form)
    if key not in _MODELS or (joint.kind == "euler" and joint.sequence != "ZYX"):
        return Unsupported(f"no joint model for {joint.kind} {joint.form or joint.sequence}", offered=False)
    letter = next((name for name, unit in zip("XYZ", np.eye(3), strict=True) if tuple(unit) == joint.axis), "")
    text = _ALIGNED[key] if letter and key in _ALIGNED else _MODELS[key][0]
    if not text:
        return Unsupported("in Python, JointModelRevoluteUnboundedUnaligned takes no axis", offered=False)
    axis, second = _array(joint.axis), _array(joint.second)
    radii = ", ".join(map(repr, joint.radii))
    return "pin.JointModel" + text.format(letter=letter, axis=axis, second=second, radii=radii, pitch=joint.pitch)


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    lines = ["import numpy as np", "import pinocchio as pin", "m = pin.Model()"]
    if tree.gravity != (0.0, 0.0, -9.81):
        lines.append(f"m.gravity.linear = {_array(tree.gravity)}")
    slots: list[tuple[Slot, ...]] = []
    # For each link: variable of its Pinocchio joint, and its placement there.
    places: list[tuple[str, Array, Array]] = []
    ids = {link.name: k for k, link in enumerate(tree.links)}
    nq = nv = 0
    armature: list[float] = []
    frames: list[str] = []
    joints: list[str] = []
    locked: list[str] = []
    own_model = attached(tree)
    for k, link in enumerate(tree.links):
        m = "m2" if k in own_model else "m"
        if link.name == tree.attached:
            lines += ["m2 = pin.Model()"]
            held, R0, p0 = places[link.parent] if link.parent >= 0 else ("0", np.eye(3), np.zeros(3))
            lines.append(f"at = m.addFrame(pin.Frame('at', {held}, 0, {_placement(R0, p0)}, pin.FrameType.OP_FRAME))")
            parent, R0, p0 = "0", np.eye(3), np.zeros(3)
        else:
            parent, R0, p0 = places[link.parent] if link.parent >= 0 else ("0", np.eye(3), np.zeros(3))
        steps, (R_end, p_end) = series(link.joints)
        own: list[Slot] = []
        models: list[tuple[str, str]] = []
        for number, (R, p, joint) in enumerate(steps):
            model = _model(joint)
            if isinstance(model, Unsupported):
                return model
            _, chart, coordinates, speeds = _MODELS[joint.kind, joint.form]
            if joint.mimics:
                followed = ids[joint.mimics]
                lines += [
                    f"s{k} = {model}",
                    f"s{k}.setIndexes(j{followed}, m.idx_qs[j{followed}], m.idx_vs[j{followed}])",
                ]
                model = f"pin.JointModelMimic(s{k}, {joint.ratio!r}, {joint.offset!r})"
                own.append(Slot(chart, slots[followed][0].q, slots[followed][0].v))
            elif joint.locked is not None:
                locked.append(f"m.joints[j{k}].idx_q")
                locked.append(repr(joint.locked))
            else:
                own.append(Slot(chart, tuple(range(nq, nq + coordinates)), tuple(range(nv, nv + speeds))))
                nq, nv = nq + coordinates, nv + speeds
                armature += joint.armature or (0.0,) * speeds
            if number == 0:
                R, p = R0 @ R, p0 + R0 @ p
            models.append((model, _placement(R, p)))
        if not models:
            places.append((parent, R0 @ R_end, p0 + R0 @ p_end))
        else:
            model, placement = models[0]
            if len(models) > 1:
                lines.append("c = pin.JointModelComposite()")
                lines += [
                    f"c.addJoint({one}, {where if n else 'pin.SE3.Identity()'})"
                    for n, (one, where) in enumerate(models)
                ]
                model = "c"
            lines.append(f"j{k} = {m}.addJoint({parent}, {model}, {placement}, {link.name!r})")
            if "locked" in tree.transformations:
                lines.append(f"{m}.addJointFrame(j{k})")
            places.append((f"j{k}", R_end, p_end))
        slots.append(tuple(own))
        name, R, p = places[-1]
        inertia = f"pin.Inertia({link.mass!r}, {_array(link.com)}, {_array(link.inertia)})"
        lines.append(f"{m}.appendBodyToJoint({name}, {inertia}, {_placement(R, p)})")
        frame = f"pin.Frame('f{k}', {name}, 0, {_placement(R, p)}, pin.FrameType.OP_FRAME)"
        frames.append(f"{m}.addFrame({frame})")
        joints.append(name if not np.any(p) and np.array_equal(R, np.eye(3)) else "")
    if any(armature):
        lines.append(f"m.armature = {_array(armature)}")
    optional: dict[str, tuple[str, ...]] = {"fs": (f"fs = [{', '.join(frames)}]",)}
    if tree.transformations:
        lines += [*frames, *_transformed(locked, len(own_model) > 0)]
        return Source(
            tuple(lines), tuple(slots), nq, nv, {"fs": (_NAMED_FRAMES.format(len(tree.links)),)}, closing=_CLOSING
        )
    if all(joints) and len(set(joints)) == len(joints):
        optional["js"] = (f"js = [{', '.join(joints)}]",)

    def place(end: End) -> tuple[str, str]:
        joint, R, p = places[ids[end.link]] if end.link else ("0", np.eye(3), np.zeros(3))
        return joint, _placement(R @ np.array(end.R), p + R @ np.array(end.p))

    optional |= constrained.optional(tree.constraints, place)
    return Source(tuple(lines), tuple(slots), nq, nv, optional, closing=_CLOSING)


_NAMED_FRAMES = "fs = [m.getFrameId(f'f{{k}}') for k in range({})]"


def _transformed(locked: list[str], appended: bool) -> list[str]:
    """Statements that make the model that is asked for: one appended to another, joints locked."""
    lines = ["m = pin.appendModel(m, m2, at, pin.SE3.Identity())"] if appended else []
    if locked:
        lines.append("q0 = pin.neutral(m)")
        lines += [f"q0[{place}] = {value}" for place, value in zip(locked[::2], locked[1::2], strict=True)]
        ids = ", ".join(place.removeprefix("m.joints[").removesuffix("].idx_q") for place in locked[::2])
        lines.append(f"m = pin.buildReducedModel(m, [{ids}], q0)")
    return lines


_FRAMES = {"local": "pin.LOCAL", "aligned": "pin.LOCAL_WORLD_ALIGNED", "world": "pin.WORLD"}
_FK = "pin.forwardKinematics(m, d, q, v, a)\npin.updateFramePlacements(m, d)\n"
_FK_D = "pin.computeForwardKinematicsDerivatives(m, d, q, v, a)\npin.updateFramePlacements(m, d)\n"
_CENTROIDAL = "value = pin.computeCentroidalDynamicsDerivatives(m, d, q, v, a)"

WAYS = {
    "sizes": Way("nq, nv", "value = [m.nq, m.nv]"),
    "mass_matrix": Way("crba", "value = pin.crba(m, d, q)"),
    "mass_matrix:crba WORLD": Way("crba in WORLD", "value = pin.crba(m, d, q, pin.Convention.WORLD)"),
    "mass_matrix:computeRNEADerivatives": Way(
        "computeRNEADerivatives", "value = pin.computeRNEADerivatives(m, d, q, v, a)[2]"
    ),
    "mass_matrix:computeAllTerms": Way("computeAllTerms", "pin.computeAllTerms(m, d, q, v)\nvalue = d.M"),
    "mass_matrix_inverse": Way("computeMinverse", "value = pin.computeMinverse(m, d, q)"),
    "mass_matrix_inverse:computeABADerivatives": Way(
        "computeABADerivatives", "value = pin.computeABADerivatives(m, d, q, v, tau)[2]"
    ),
    "bias": Way("nonLinearEffects", "value = pin.nonLinearEffects(m, d, q, v)"),
    "gravity": Way("computeGeneralizedGravity", "value = pin.computeGeneralizedGravity(m, d, q)"),
    "coriolis_forces": Way("computeCoriolisMatrix", "value = pin.computeCoriolisMatrix(m, d, q, v) @ v"),
    "coriolis_symmetry": Way("computeCoriolisMatrix", "C = pin.computeCoriolisMatrix(m, d, q, v)\nvalue = C + C.T"),
    "inverse_dynamics": Way("rnea", "value = pin.rnea(m, d, q, v, a)"),
    "forward_dynamics": Way("aba", "value = pin.aba(m, d, q, v, tau)"),
    "forward_dynamics:aba LOCAL": Way("aba in LOCAL", "value = pin.aba(m, d, q, v, tau, pin.Convention.LOCAL)"),
    "kinetic_energy": Way("computeKineticEnergy", "value = pin.computeKineticEnergy(m, d, q, v)"),
    "potential_energy": Way("computePotentialEnergy", "value = pin.computePotentialEnergy(m, d, q)"),
    "link_poses": Way(
        "framesForwardKinematics",
        "pin.framesForwardKinematics(m, d, q)\n"
        "value = np.array([np.r_[d.oMf[f].translation, d.oMf[f].rotation.ravel()] for f in fs])",
    ),
    "mass_centre": Way("centerOfMass", "value = pin.centerOfMass(m, d, q)"),
    "mass_centre_jacobian": Way("jacobianCenterOfMass", "value = pin.jacobianCenterOfMass(m, d, q)"),
    "mass_centre_velocity_dq": Way(
        "getCenterOfMassVelocityDerivatives",
        "pin.computeAllTerms(m, d, q, v)\nvalue = pin.getCenterOfMassVelocityDerivatives(m, d)",
    ),
    "link_accelerations": Way(
        "getFrameClassicalAcceleration",
        f"{_FK}value = np.array("
        "[pin.getFrameClassicalAcceleration(m, d, f, pin.LOCAL_WORLD_ALIGNED).vector for f in fs])",
    ),
    "centroidal_matrix": Way("ccrba", "value = pin.ccrba(m, d, q, v)"),
    "centroidal_matrix_rate": Way("dccrba", "value = pin.dccrba(m, d, q, v)"),
    "centroidal_momentum": Way("computeCentroidalMomentum", "value = pin.computeCentroidalMomentum(m, d, q, v).vector"),
    "centroidal_momentum_rate": Way(
        "computeCentroidalMomentumTimeVariation",
        "value = pin.computeCentroidalMomentumTimeVariation(m, d, q, v, a).vector",
    ),
    "centroidal_momentum_dq": Way("computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[0]"),
    "centroidal_momentum_rate_dq": Way("computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[1]"),
    "centroidal_momentum_rate_dv": Way("computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[2]"),
    "centroidal_matrix:computeCentroidalDynamicsDerivatives": Way(
        "computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[3]"
    ),
    "inverse_dynamics_dq": Way("computeRNEADerivatives", "value = pin.computeRNEADerivatives(m, d, q, v, a)[0]"),
    "inverse_dynamics_dv": Way("computeRNEADerivatives", "value = pin.computeRNEADerivatives(m, d, q, v, a)[1]"),
    "gravity_dq": Way(
        "computeGeneralizedGravityDerivatives", "value = pin.computeGeneralizedGravityDerivatives(m, d, q)"
    ),
    "forward_dynamics_dq": Way("computeABADerivatives", "value = pin.computeABADerivatives(m, d, q, v, tau)[0]"),
    "forward_dynamics_dv": Way("computeABADerivatives", "value = pin.computeABADerivatives(m, d, q, v, tau)[1]"),
    "torque_regressor": Way(
        "computeJointTorqueRegressor", "js\nvalue = pin.computeJointTorqueRegressor(m, d, q, v, a)"
    ),
    "kinetic_energy_regressor": Way(
        "computeKineticEnergyRegressor", "js\nvalue = pin.computeKineticEnergyRegressor(m, d, q, v)"
    ),
    "potential_energy_regressor": Way(
        "computePotentialEnergyRegressor", "js\nvalue = pin.computePotentialEnergyRegressor(m, d, q)"
    ),
    "integrate": Way("integrate", "value = pin.integrate(m, q, v2)"),
    "interpolate": Way("interpolate", "value = pin.interpolate(m, q, pin.integrate(m, q, v2), 0.25)"),
    "difference": Way("difference", "value = pin.difference(m, q, pin.integrate(m, q, v2))"),
    "integrate_dq": Way("dIntegrate", "value = pin.dIntegrate(m, q, v2, pin.ARG0)"),
    "integrate_dv": Way("dIntegrate", "value = pin.dIntegrate(m, q, v2, pin.ARG1)"),
    "difference_dq": Way("dDifference", "value = pin.dDifference(m, q, pin.integrate(m, q, v2), pin.ARG0)"),
    "difference_dq2": Way("dDifference", "value = pin.dDifference(m, q, pin.integrate(m, q, v2), pin.ARG1)"),
}
for _frame, _rf in _FRAMES.items():
    _names = ALIGNED if _frame == "aligned" else (f"jacobian_{_frame}", f"jacobian_rate_{_frame}", f"velocity_{_frame}")
    WAYS |= {
        _names[0]: Way(
            "getFrameJacobian",
            "pin.computeJointJacobians(m, d, q)\npin.updateFramePlacements(m, d)\n"
            f"value = np.array([pin.getFrameJacobian(m, d, f, {_rf}) for f in fs])",
        ),
        _names[1]: Way(
            "getFrameJacobianTimeVariation",
            "pin.computeJointJacobiansTimeVariation(m, d, q, v)\npin.updateFramePlacements(m, d)\n"
            f"value = np.array([pin.getFrameJacobianTimeVariation(m, d, f, {_rf}) for f in fs])",
        ),
        f"jacobian_dq_{_frame}": Way(
            "getJointKinematicHessian",
            "pin.computeJointJacobians(m, d, q)\npin.computeJointKinematicHessians(m, d)\n"
            f"value = np.array([pin.getJointKinematicHessian(m, d, j, {_rf}) for j in js])",
        ),
        _names[2]: Way(
            "getFrameVelocity", f"{_FK}value = np.array([pin.getFrameVelocity(m, d, f, {_rf}).vector for f in fs])"
        ),
        f"acceleration_{_frame}": Way(
            "getFrameAcceleration",
            f"{_FK}value = np.array([pin.getFrameAcceleration(m, d, f, {_rf}).vector for f in fs])",
        ),
        f"velocity_dq_{_frame}": Way(
            "getFrameVelocityDerivatives",
            f"{_FK_D}value = np.array([pin.getFrameVelocityDerivatives(m, d, f, {_rf})[0] for f in fs])",
        ),
        f"acceleration_dq_{_frame}": Way(
            "getFrameAccelerationDerivatives",
            f"{_FK_D}value = np.array([pin.getFrameAccelerationDerivatives(m, d, f, {_rf})[1] for f in fs])",
        ),
        f"acceleration_dv_{_frame}": Way(
            "getFrameAccelerationDerivatives",
            f"{_FK_D}value = np.array([pin.getFrameAccelerationDerivatives(m, d, f, {_rf})[2] for f in fs])",
        ),
    }


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has Pinocchio read a file."""
    read = {
        "urdf": ("m = pin.buildModelFromXML(TEXT, mimic=True)",),
        "mjcf": (
            "import tempfile",
            "file = tempfile.NamedTemporaryFile('w', suffix='.xml')",
            "print(TEXT, file=file, flush=True)",
            "m = pin.buildModelFromMJCF(file.name)",
        ),
    }[form]
    slots, nq, nv = in_series(tree, {key: model[1] for key, model in _MODELS.items()})
    names = [link.name for link in tree.links]
    lines = ("import numpy as np", "import pinocchio as pin", f"TEXT = {text!r}", *read)
    return Source(lines, slots, nq, nv, {"fs": (f"fs = [m.getFrameId(name) for name in {names!r}]",)}, closing=_CLOSING)


PLUGIN = SourcePlugin(
    name="pinocchio",
    package="pin",
    extra="pin",
    conventions=(
        Difference("quaternion", "x, y, z, w"),
        Difference("free joint", "linear and angular velocity in the axes of the body"),
        Difference(
            "constraints", "force on the first joint's body, along its frame; anchors' Jacobians have the other sign"
        ),
        Difference("armature", "m.armature; rotorInertia and rotorGearRatio have no effect on rnea, crba, aba"),
    ),
    kinds={},
    ways=WAYS | constrained.WAYS,
    write=write,
    constraints=constrained.KINDS,
    transformations={"locked": "buildReducedModel", "attached": "appendModel"},
    formats=("urdf", "mjcf"),
    write_reading=write_reading,
)
