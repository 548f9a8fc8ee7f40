"""Goals of inverse kinematics: what engines' solvers reach where they say that they have, in each engine's own words.

The goal is where the engine itself has the last link at q2; what counts is where it has the link at its solution.
"""

from __future__ import annotations

from ...truth.points import POINT
from ..writing.source import Way

_AT = list(POINT)
_NONE = "raise RuntimeError('no solution is found')"

# Robotics Toolbox: solvers in Python and, those with short names, in C++. Their residual is half of the squared error:
# 1e-16 allows 1.4e-8.
_SOUGHT = f"""name, (A, _) = [*links.items()][-1]
found = robot.CALL(robot.fkine(q2, end=name), end=name, q0=q2 + np.tanh(v) / 4, tol=1e-16, joint_limits=False, MORE)
if not found.success: {_NONE}
X = robot.fkine(found.q, end=name).A
pose = np.array([*X[:3, 3], *(X[:3, :3] @ np.transpose(A)).flat])
value = pose"""
_MASKS = {"pose": ("", "np.ones(6)"), "place": ("[:3]", "np.array([1.0, 1, 1, 0, 0, 0])")}
ROBOTICS_TOOLBOX = {
    f"goal_{goal}:{solver}": Way(
        native, _SOUGHT.replace("CALL", native).replace("MORE", f"mask={mask}, {more}") + part, 2e-8
    )
    for goal, (part, mask) in _MASKS.items()
    for solver, native, more in (
        ("ikine_LM", "ikine_LM", "seed=1"),
        ("ikine_LM, sugihara", "ikine_LM", "method='sugihara', k=1e-4, seed=1"),
        ("ikine_GN", "ikine_GN", "pinv=True, seed=1"),
        ("ikine_NR", "ikine_NR", "pinv=True, seed=1"),
        ("ik_LM", "ik_LM", ""),
        ("ik_LM, sugihara", "ik_LM", "method='sugihara', k=1e-4"),
        ("ik_GN", "ik_GN", ""),
        ("ik_NR", "ik_NR", ""),
    )
}
# Of slides it asks for limits, which a robot of its own has.
_LIMITED = "for one in robot.links:\n    if one.isjoint: one.qlim = [-99.0, 99.0]\n"
ROBOTICS_TOOLBOX |= {
    name.replace("goal_pose", "goal_pose_far"): way._replace(
        code=_LIMITED + way.code.replace("q2", "8 * q2"), built=(("import numpy as np", "import numpy as np"),)
    )
    for name, way in ROBOTICS_TOOLBOX.items()
    if name.startswith("goal_pose:ik")
}

# SAPIEN: poses in singles.
SAPIEN = {
    "goal_pose": Way(
        "PinocchioModel.compute_inverse_kinematics",
        f"""model.compute_forward_kinematics(q2[place])
k, start = links[-1].index, (q2 + np.tanh(v) / 4)[place]
found, success, _ = model.compute_inverse_kinematics(k, model.get_link_pose(k), start, eps=1e-6, max_iterations=2000)
if not success: {_NONE}
model.compute_forward_kinematics(found)
X = model.get_link_pose(k).to_transformation_matrix()
value = [*X[:3, 3], *X[:3, :3].flat]""",
        4e-5,
    )
}

# DART: a gradient is descended until errors are less than 1e-6.
_DESCENT = f"""s.setPositions(q2)
b = links[-1]
b.clearIK()
X, ik, bound, at = b.getTransform(), b.getIK(True), np.full(3, np.inf), np.array({_AT})
def seen(X): return dart.dynamics.SimpleFrame(dart.dynamics.Frame.World(), 'goal', X)
ik.setTarget(seen(X))
SET
s.setPositions(q2 + np.tanh(v) / 4)
if not ik.solveAndApply(True): {_NONE}
X = b.getTransform()
"""
_FREE = "ik.getErrorMethod().set{}Bounds(-bound, bound)"
_OFFSET = "\nik.setOffset(at)\nik.setTarget(seen(dart.math.Isometry3(np.eye(3), X.multiply(at))))"
DART = {
    f"goal_{name}": Way("InverseKinematics.solveAndApply", _DESCENT.replace("SET", changes) + value, 1e-5)
    for name, changes, value in (
        ("pose", "", "value = [*X.translation(), *X.rotation().flat]"),
        ("place", _FREE.format("Angular"), "value = X.translation()"),
        ("turn", _FREE.format("Linear"), "value = X.rotation().ravel()"),
        ("point", _FREE.format("Angular") + _OFFSET, "value = X.multiply(at)"),
    )
}

# Drake: its solvers hold constraints to 1e-6. Rotations are held within an angle: at zero there is no slope.
_PROGRAM = f"""b, start, at = links[-1].body_frame(), q2 + np.tanh(v) / 4, np.array({_AT})
p.SetPositions(c, q2)
X, W, none, R = b.CalcPoseInWorld(c), p.world_frame(), np.zeros(3), drake.RotationMatrix()
place, point, ik = X.translation(), X @ at, drake.InverseKinematics(p)
SET
result = drake.Solve(ik.prog(), start)
if not result.is_success(): {_NONE}
p.SetPositions(c, result.GetSolution(ik.q()))
X = b.CalcPoseInWorld(c)
"""
_OF_DRAKE = {
    "pose": "value = [*X.translation(), *X.rotation().matrix().flat]",
    "place": "value = X.translation()",
    "turn": "value = X.rotation().matrix().ravel()",
    "point": "value = X @ at",
}
_CLOSE, _ROUGH = 1e-5, 3e-3
_PLACED = "ik.AddPositionConstraint(b, none, W, place, place)"
_TURNED = "ik.AddOrientationConstraint(W, X.rotation(), b, R, 1e-3)"
_SEEN = """F = drake.RigidTransform(drake.RollPitchYaw(0.5, -0.25, 1.0), [0.5, 0.25, -1.0])
y = F.inverse() @ point
ik.AddPositionConstraint(b, at, W, F, y, y)"""
_COSTS = "ik.AddPositionCost(W, place, b, none, np.eye(3))\nik.AddOrientationCost(W, X.rotation(), b, R, 1.0)"
_DISTANCES = """for w in (none, *np.eye(3)):
    far = np.linalg.norm(point - w)
    ik.AddPointToPointDistanceConstraint(W, w, b, at, far, far)"""
_ANGLES = """for w, e in ((w, e) for w in np.eye(3) for e in np.eye(3)):
    far = np.arccos(w @ X.rotation().matrix() @ e)
    ik.AddAngleBetweenVectorsConstraint(W, w, b, e, far - 1e-4, far + 1e-4)"""
DRAKE = {
    f"goal_{name}": Way(native, _PROGRAM.replace("SET", changes) + _OF_DRAKE[name.partition(":")[0]], slack)
    for name, native, changes, slack in (
        ("pose", "AddPositionConstraint, AddOrientationConstraint", f"{_PLACED}\n{_TURNED}", _ROUGH),
        ("place", "AddPositionConstraint", _PLACED, _CLOSE),
        ("turn", "AddOrientationConstraint", _TURNED, _ROUGH),
        ("point", "AddPositionConstraint", "ik.AddPositionConstraint(b, at, W, point, point)", _CLOSE),
        ("point:another frame", "AddPositionConstraint, X_AbarA", _SEEN, _CLOSE),
        ("pose:costs", "AddPositionCost, AddOrientationCost", _COSTS, _ROUGH),
        ("point:costs", "AddPositionCost", "ik.AddPositionCost(b, at, W, point, np.diag([1.0, 2.0, 3.0]))", _ROUGH),
        ("turn:costs", "AddOrientationCost", "ik.AddOrientationCost(W, X.rotation(), b, R, 2.0)", _ROUGH),
        ("point:distances", "AddPointToPointDistanceConstraint", _DISTANCES, 1e-4),
        ("turn:angles", "AddAngleBetweenVectorsConstraint", _ANGLES, _ROUGH),
    )
}
