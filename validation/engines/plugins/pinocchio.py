"""Pinocchio: every joint model of its own API."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..functions import ALIGNED
from ..interface import Array, Convention, End, Joint, Rows, Slot, Statement, Tree, Unsupported
from ..truth.derived import WRENCH
from .loops import pinocchio as constrained
from .writing.source import Source, SourcePlugin, Way, attached, is_depth_first, numbered, series
from .writing.urdf import UNIT_AXIS

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

CLOSING = ("d = m.createData()",)


def _array(values: Any) -> str:
    return f"np.array({np.asarray(values, dtype=float).tolist()!r})"


def _placement(R: Array, p: Array) -> str:
    if np.array_equal(R, np.eye(3)) and not np.any(p):
        return "pin.SE3.Identity()"
    return f"pin.SE3({_array(R)}, {_array(p)})"


def _is_possible(inertia: Rows) -> bool:
    """Whether principal moments are non-negative and satisfy the triangle inequality."""
    moments = np.linalg.eigvalsh(np.array(inertia))
    return bool(moments[0] >= 0.0 and 2.0 * moments[2] <= moments.sum())


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


class _ModelText:
    """Statements that build a tree's model, collected link by link."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.lines = ["import numpy as np", "import pinocchio as pin", "m = pin.Model()"]
        if tree.gravity != (0.0, 0.0, -9.81):
            self.lines.append(f"m.gravity.linear = {_array(tree.gravity)}")
        self.slots: list[tuple[Slot, ...]] = []
        # For each link: variable of its Pinocchio joint, and its placement there.
        self.places: list[tuple[str, Array, Array]] = []
        self.ids = {link.name: k for k, link in enumerate(tree.links)}
        self.nq = self.nv = 0
        self.armature: list[float] = []
        self.frames: list[str] = []
        self.joints: list[str] = []
        self.locked: list[str] = []
        self.own_model = attached(tree)

    def add(self, k: int) -> Unsupported | None:
        """Add a link with its joints, or say what Pinocchio has not of it."""
        link = self.tree.links[k]
        parent, R0, p0 = self._parent(k)
        steps, end = series(link.joints)
        own: list[Slot] = []
        models: list[tuple[str, str]] = []
        for number, (R, p, joint) in enumerate(steps):
            model = self._joint(k, joint, own)
            if isinstance(model, Unsupported):
                return model
            models.append((model, _placement(*((R0 @ R, p0 + R0 @ p) if number == 0 else (R, p)))))
        self.slots.append(tuple(own))
        self.places.append(self._link(k, parent, models, end) if models else (parent, R0 @ end[0], p0 + R0 @ end[1]))
        name, R, p = self.places[-1]
        inertia = f"pin.Inertia({link.mass!r}, {_array(link.com)}, {_array(link.inertia)})"
        if not _is_possible(link.inertia):  # The constructor refuses what files state and the attributes take.
            values = f"{link.mass!r}, {_array(link.com)}, {_array(link.inertia)}"
            self.lines += ["b = pin.Inertia.Zero()", f"b.mass, b.lever, b.inertia = {values}"]
            inertia = "b"
        self.lines.append(f"{self._model_of(k)}.appendBodyToJoint({name}, {inertia}, {_placement(R, p)})")
        frame = f"pin.Frame('f{k}', {name}, 0, {_placement(R, p)}, pin.FrameType.OP_FRAME)"
        self.frames.append(f"{self._model_of(k)}.addFrame({frame})")
        self.joints.append(name if not np.any(p) and np.array_equal(R, np.eye(3)) else "")
        return None

    def _model_of(self, k: int) -> str:
        """Variable of the model that a link is in."""
        return "m2" if k in self.own_model else "m"

    def _parent(self, k: int) -> tuple[str, Array, Array]:
        """Joint that a link hangs on, and its placement there; an attached model begins at its own origin."""
        link, origin = self.tree.links[k], ("0", np.eye(3), np.zeros(3))
        place = self.places[link.parent] if link.parent >= 0 else origin
        if link.name != self.tree.attached:
            return place
        held, R0, p0 = place
        at = f"pin.Frame('at', {held}, 0, {_placement(R0, p0)}, pin.FrameType.OP_FRAME)"
        self.lines += ["m2 = pin.Model()", f"at = m.addFrame({at})"]
        return origin

    def _joint(self, k: int, joint: Joint, own: list[Slot]) -> str | Unsupported:
        """The model of one joint; its slot goes to the link's own."""
        model = _model(joint)
        if isinstance(model, Unsupported):
            return model
        _, chart, coordinates, speeds = _MODELS[joint.kind, joint.form]
        if joint.mimics:
            followed = self.ids[joint.mimics]
            indices = f"j{followed}, m.idx_qs[j{followed}], m.idx_vs[j{followed}]"
            self.lines += [f"s{k} = {model}", f"s{k}.setIndexes({indices})"]
            own.append(Slot(chart, self.slots[followed][0].q, self.slots[followed][0].v))
            return f"pin.JointModelMimic(s{k}, {joint.ratio!r}, {joint.offset!r})"
        if joint.locked is not None:
            self.locked += [f"m.joints[j{k}].idx_q", repr(joint.locked)]
            return model
        q, v = range(self.nq, self.nq + coordinates), range(self.nv, self.nv + speeds)
        own.append(Slot(chart, tuple(q), tuple(v)))
        self.nq, self.nv = q.stop, v.stop
        self.armature += joint.armature or (0.0,) * speeds
        return model

    def _link(
        self, k: int, parent: str, models: list[tuple[str, str]], end: tuple[Array, Array]
    ) -> tuple[str, Array, Array]:
        """Add the joints of a link, several as one composite; where the link is."""
        (model, placement), *others = models
        if others:
            parts = [(model, "pin.SE3.Identity()"), *others]
            self.lines.append("c = pin.JointModelComposite()")
            self.lines += [f"c.addJoint({one}, {where})" for one, where in parts]
            model = "c"
        m, name = self._model_of(k), self.tree.links[k].name
        self.lines.append(f"j{k} = {m}.addJoint({parent}, {model}, {placement}, {name!r})")
        if "locked" in self.tree.transformations:
            self.lines.append(f"{m}.addJointFrame(j{k})")
        return f"j{k}", *end

    def place(self, end: End) -> tuple[str, str]:
        """Joint and placement of a constraint's end."""
        joint, R, p = self.places[self.ids[end.link]] if end.link else ("0", np.eye(3), np.zeros(3))
        return joint, _placement(R @ np.array(end.R), p + R @ np.array(end.p))

    def source(self) -> Source:
        """The text with what functions need."""
        tree, lines, slots = self.tree, self.lines, tuple(self.slots)
        if any(self.armature):
            lines.append(f"m.armature = {_array(self.armature)}")
        if tree.transformations:
            lines += [*self.frames, *_transformed(self.locked, len(self.own_model) > 0)]
            named = {"fs": (_NAMED_FRAMES.format(len(tree.links)),)}
            return Source(tuple(lines), slots, self.nq, self.nv, named, closing=CLOSING)
        optional: dict[str, tuple[str, ...]] = {"fs": (f"fs = [{', '.join(self.frames)}]",)}
        if all(self.joints) and len(set(self.joints)) == len(self.joints):
            optional["js"] = (f"js = [{', '.join(self.joints)}]",)
        if tree.sensors:
            made = (f"pin.Frame('o{k}', {{}}, 0, {{}}, pin.FrameType.OP_FRAME)" for k in range(len(tree.sensors)))
            stated = (text.format(*self.place(end)) for text, end in zip(made, tree.sensors, strict=True))
            optional["sensed"] = (f"sensed = [{', '.join(f'm.addFrame({one})' for one in stated)}]", *CLOSING)
        optional |= constrained.optional(tree.constraints, self.place)
        return Source(tuple(lines), slots, self.nq, self.nv, optional, closing=CLOSING)


def _changing(tree: Tree) -> list[str]:
    """Statements that give the model a tree's numbers of what is changed; each link stands at its one joint."""
    if tree.changed == "gravity":
        return [f"m.gravity.linear = {_array(tree.gravity)}"]
    lines = []
    for k, link in enumerate(tree.links):
        joint = link.joints[0]
        if tree.changed == "frame":
            lines.append(f"m.jointPlacements[j{k}] = {_placement(np.array(joint.R), np.array(joint.p))}")
        else:
            lines.append(f"m.inertias[j{k}] = pin.Inertia({link.mass!r}, {_array(link.com)}, {_array(link.inertia)})")
    return lines


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    if tree.changed:
        first = write(tree.before)
        used = "pin.computeAllTerms(m, d, pin.neutral(m), np.zeros(m.nv))"
        before = _changing(replace(tree.before, changed=tree.changed))
        closing = (*before, *CLOSING, used, *_changing(tree))
        return first if isinstance(first, Unsupported) else replace(first, closing=closing)
    text = _ModelText(tree)
    for k in range(len(tree.links)):
        obstacle = text.add(k)
        if obstacle is not None:
            return obstacle
    return text.source()


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
    "joint_wrenches": Way("rnea: f", "js\npin.rnea(m, d, q, v, a)\nvalue = np.array([d.f[j].vector for j in js])"),
    "forward_dynamics": Way("aba", "value = pin.aba(m, d, q, v, tau)"),
    "forward_dynamics:aba LOCAL": Way("aba in LOCAL", "value = pin.aba(m, d, q, v, tau, pin.Convention.LOCAL)"),
    "kinetic_energy": Way("computeKineticEnergy", "value = pin.computeKineticEnergy(m, d, q, v)"),
    "potential_energy": Way("computePotentialEnergy", "value = pin.computePotentialEnergy(m, d, q)"),
    "link_poses": Way(
        "framesForwardKinematics",
        "pin.framesForwardKinematics(m, d, q)\n"
        "value = np.array([np.r_[d.oMf[f].translation, d.oMf[f].rotation.ravel()] for f in fs])",
    ),
    "frame_jacobians": Way(
        "computeFrameJacobian",
        "value = [pin.computeFrameJacobian(m, d, q, f, pin.LOCAL_WORLD_ALIGNED) for f in sensed]",
    ),
    "frame_poses": Way(
        "framesForwardKinematics",
        "pin.framesForwardKinematics(m, d, q)\n"
        # What the reader has left out is nowhere.
        "at = [d.oMf[f] if f < m.nframes else None for f in sensed]\n"
        "value = [[*X.translation, *X.rotation.flat] if X else [np.nan] * 12 for X in at]",
    ),
    "applied_wrenches": Way(
        "rnea with external forces",
        f"""given = [pin.Force.Zero() for _ in range(m.njoints)]
for f in sensed:
    frame = m.frames[f]
    joint = frame.parentJoint if hasattr(frame, 'parentJoint') else frame.parent
    given[joint] += frame.placement.act(pin.Force(np.array({list(WRENCH[:3])}), np.array({list(WRENCH[3:])})))
value = pin.rnea(m, d, q, 0 * v, 0 * v) - pin.rnea(m, d, q, 0 * v, 0 * v, pin.StdVec_Force(given))""",
    ),
    "joint_dampings": Way("damping", "value = m.damping"),
    "joint_frictions": Way(
        "friction, upperDryFrictionLimit", "value = m.friction if hasattr(m, 'friction') else m.upperDryFrictionLimit"
    ),
    "rotation_logarithm": Way("log3", "value = pin.log3(pin.Quaternion(q).matrix())"),
    "rotation_logarithm:quaternion": Way("log3", "value = pin.log3(pin.Quaternion(q))"),
    "rotation_exponential": Way("exp3", "value = pin.exp3(v).ravel()"),
    "rotation_composed": Way("Quaternion", "value = (pin.Quaternion(q) * pin.Quaternion(q2)).matrix().ravel()"),
    "rotation_angle": Way("angularDistance", "value = [pin.Quaternion(q).angularDistance(pin.Quaternion(q2))]"),
    "rotation_vector_speeds": Way("Jexp3", "value = pin.Jexp3(tau)"),
    "rotation_vector_rates": Way("Jlog3", "value = pin.Jlog3(pin.exp3(tau))"),
    "rpy_rates": Way(
        "rpy.computeRpyJacobianInverse",
        "from pinocchio import rpy\nvalue = rpy.computeRpyJacobianInverse(v, pin.LOCAL_WORLD_ALIGNED)",
    ),
    "rotation_halfway": Way("slerp", "value = pin.Quaternion(q).slerp(0.25, pin.Quaternion(q2)).matrix().ravel()"),
    "twist_transform": Way("SE3.action", "value = pin.SE3(pin.Quaternion(q).matrix(), a).action"),
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

_SENSED = f"{_FK}value = np.array([pin.getFrame{{}}(m, d, f, pin.LOCAL).{{}} for f in sensed])"
WAYS |= {
    "gyroscopes": Way("getFrameVelocity", _SENSED.format("Velocity", "angular")),
    "velocimeters": Way("getFrameVelocity", _SENSED.format("Velocity", "linear")),
    "accelerometers": Way(
        "getFrameClassicalAcceleration less gravity",
        _SENSED.format("ClassicalAcceleration", "linear - d.oMf[f].rotation.T @ m.gravity.linear"),
    ),
}


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has Pinocchio read a file."""
    read = {
        # Before mimicking joints there was no argument for them.
        "urdf": (
            "try: m = pin.buildModelFromXML(TEXT, mimic=True)",
            "except TypeError: m = pin.buildModelFromXML(TEXT)",
        ),
        "mjcf": (
            "import tempfile",
            "file = tempfile.NamedTemporaryFile('w', suffix='.xml')",
            "print(TEXT, file=file, flush=True)",
            "m = pin.buildModelFromMJCF(file.name)",
        ),
        "urdf written": (
            "written, m = pin.buildModelFromXML(TEXT, mimic=True), pin.Model()",
            "m.loadFromString(written.saveToString())",
        ),
    }[form]
    made = numbered(tree, {key: model[1] for key, model in _MODELS.items()})
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    names = [link.name for link in tree.links]
    lines = ("import numpy as np", "import pinocchio as pin", f"TEXT = {text!r}", *read)
    optional = {"fs": (f"fs = [m.getFrameId(name, pin.FrameType.BODY) for name in {names!r}]",)}
    if tree.sensors:
        optional["sensed"] = (f"sensed = [m.getFrameId(f'o{{k}}') for k in range({len(tree.sensors)})]",)
    return Source(lines, slots, nq, nv, optional, closing=CLOSING)


PLUGIN = SourcePlugin(
    name="pinocchio",
    package="pin",
    extra="pin",
    conventions=(
        Convention("quaternion", "x, y, z, w"),
        Convention("free joint", "linear and angular velocity in the axes of the body"),
        Convention(
            "constraints", "force on the first joint's body, along its frame; anchors' Jacobians have the other sign"
        ),
        Convention("armature", "m.armature; rotorInertia and rotorGearRatio have no effect on rnea, crba, aba"),
    ),
    kinds={},
    ways=WAYS | constrained.WAYS,
    write=write,
    constraints=constrained.KINDS,
    demands={
        "locked": "buildReducedModel",
        "attached": "appendModel",
        "sensors": "frames",
        "turns": "Quaternion, exp3, log3",
        "changed mass": "inertias",
        "changed inertia": "inertias",
        "changed frame": "jointPlacements",
        "changed gravity": "gravity",
    },
    formats=("urdf", "mjcf", "urdf written"),
    write_reading=write_reading,
    statements=(
        Statement(
            "precondition",
            "joints need to be added to the tree in a depth-first order",
            "pinocchio 4.1, src/multibody/model.hxx:394; https://github.com/stack-of-tasks/pinocchio/issues/1897",
            holds=lambda tree, text: not text and not is_depth_first(tree),
        ),
        Statement(
            "precondition",
            "computeCoriolisMatrix does not support mimic joints: asserted, which wheels are built without",
            "pinocchio 4.1, src/algorithm/rnea.hxx:732: assert(model.check(MimicChecker()))",
            "coriolis_forces|coriolis_symmetry",
            lambda tree, text: any(joint.mimics for link in tree.links for joint in link.joints),
        ),
        Statement(
            "precondition",
            "z of a frame from end to end is from the first towards the second point, as MJCF's page says; MuJoCo's "
            "own compiler takes the opposite",
            "https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-geom, fromto; "
            "https://github.com/newton-physics/newton/pull/3667",
            "frame_poses",
            lambda tree, text: "<site" in text and "fromto" in text,
        ),
        UNIT_AXIS,
    ),
)
