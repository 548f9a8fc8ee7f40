"""What Pinocchio offers by objects: joints' data, the Lie group of a model, its robot; what else is asked by frames."""

from __future__ import annotations

from ...functions import ALIGNED
from ..writing.source import Way, ways_of
from .functions import FRAMES

_FK = "pin.forwardKinematics(m, d, q, v, a)\n"
_G = "G = pin.lieGroup(m)\n"
_THERE = f"{_G}q1 = G.integrate(q, v2)\n"
_ROBOT = "r = pin.RobotWrapper(m)\n"
_EACH_JOINT = "js\nvalue = np.array([{of} for j in js])"
_EACH_FRAME = "value = np.array([{of} for f in fs])"
# Placements, velocities and accelerations of joints, each from the one before by what the joint's own data say.
_BY_DATA = """js
X, V, A, J = [pin.SE3.Identity()], [pin.Motion.Zero()], [pin.Motion.Zero()], [np.zeros((6, m.nv))]
for j in range(1, m.njoints):
    own, parent = m.joints[j].createData(), m.parents[j]
    m.joints[j].calc(own, q, v)
    at, rows = m.jointPlacements[j] * own.M, range(m.joints[j].idx_v, m.joints[j].idx_v + m.joints[j].nv)
    X.append(X[parent] * at)
    V.append(at.actInv(V[parent]) + own.v)
    S = np.reshape(own.S, (6, -1))
    A.append(at.actInv(A[parent]) + own.c + V[j].cross(own.v) + pin.Motion(S @ a[rows]))
    J.append(at.inverse().action @ J[parent])
    J[j][:, rows] += S
"""
FROM_DATA = {
    "link_poses": "[*X[j].translation, *X[j].rotation.flat]",
    "velocity_local": "V[j].vector",
    "acceleration_local": "A[j].vector",
    "jacobian_local": "J[j]",
}
_GROUP = {
    "integrate": ("integrate", f"{_G}value = G.integrate(q, v2)"),
    "interpolate": ("interpolate", f"{_THERE}value = G.interpolate(q, q1, 0.25)"),
    "difference": ("difference", f"{_THERE}value = G.difference(q, q1)"),
    "integrate_dq": ("dIntegrate_dq", f"{_G}value = G.dIntegrate_dq(q, v2)"),
    "integrate_dv": ("dIntegrate_dv", f"{_G}value = G.dIntegrate_dv(q, v2)"),
    "difference_dq": ("dDifference", f"{_THERE}value = G.dDifference(q, q1, pin.ARG0)"),
    "difference_dq2": ("dDifference", f"{_THERE}value = G.dDifference(q, q1, pin.ARG1)"),
    "squared_distance": ("squaredDistance", f"{_THERE}value = [G.squaredDistance(q, q1)]"),
    "coordinate_rates": ("tangentMap", f"{_G}value = G.tangentMap(q) @ v"),
}
_WRAPPED = {
    "mass_matrix": "r.mass(q)",
    "bias": "r.nle(q, v)",
    "gravity": "r.gravity(q)",
    "mass_centre": "r.com(q)",
    "mass_centre_velocity": "r.vcom(q, v)",
    "mass_centre_acceleration": "r.acom(q, v, a)",
    "mass_centre_jacobian": "r.Jcom(q)",
    "centroidal_matrix": "r.centroidalMap(q)",
    "centroidal_momentum": "r.centroidal(q, v)[0].vector",
    "centroidal_momentum_rate": "r.centroidalMomentumVariation(q, v, a).vector",
}
_OF_FRAMES = {
    ALIGNED[2]: "r.frameVelocity(q, v, f, True, pin.LOCAL_WORLD_ALIGNED).vector",
    "velocity_local": "r.frameVelocity(q, v, f).vector",
    "acceleration_local": "r.frameAcceleration(q, v, a, f).vector",
    "link_accelerations": "r.frameClassicalAcceleration(q, v, a, f, True, pin.LOCAL_WORLD_ALIGNED).vector",
    "jacobian_local": "r.computeFrameJacobian(q, f)",
}
WAYS = (
    {
        f"{name}:JointData": Way("JointData: M, v, c, S", f"{_BY_DATA}value = [{of} for j in js]")
        for name, of in FROM_DATA.items()
    }
    | {f"{name}:lieGroup": Way(f"lieGroup.{native}", code) for name, (native, code) in _GROUP.items()}
    | {f"{name}:RobotWrapper": Way("RobotWrapper", f"{_ROBOT}value = {of}") for name, of in _WRAPPED.items()}
    | {
        f"{name}:RobotWrapper": Way("RobotWrapper", f"{_ROBOT}{_EACH_FRAME.format(of=of)}")
        for name, of in _OF_FRAMES.items()
    }
    | ways_of(f"""
== link_poses:updateFramePlacement | updateGlobalPlacements, updateFramePlacement
{_FK}for X in d.oMi: X.setIdentity()
pin.updateGlobalPlacements(m, d)
at = [pin.updateFramePlacement(m, d, f) for f in fs]
value = [[*X.translation, *X.rotation.flat] for X in at]
== coriolis_symmetry:getCoriolisMatrix | computeRNEADerivatives, getCoriolisMatrix
pin.computeRNEADerivatives(m, d, q, v, a)
C = pin.getCoriolisMatrix(m, d)
value = C + C.T
== coriolis_forces:getCoriolisMatrix | computeRNEADerivatives, getCoriolisMatrix
pin.computeRNEADerivatives(m, d, q, v, a)
value = pin.getCoriolisMatrix(m, d) @ v
""")
    | {
        f"{name}:getCentroidalDynamicsDerivatives": Way(
            "computeRNEADerivatives, getCentroidalDynamicsDerivatives",
            f"pin.computeRNEADerivatives(m, d, q, v, a)\nvalue = pin.getCentroidalDynamicsDerivatives(m, d)[{place}]",
        )
        for place, name in enumerate(
            (
                "centroidal_momentum_dq",
                "centroidal_momentum_rate_dq",
                "centroidal_momentum_rate_dv",
                "centroidal_matrix",
            )
        )
    }
)
# Columns of joints as the links' order has them.
_REGRESSOR = "js\nown = [6 * (j - 1) + k for j in js for k in range(6)]\n" + _FK + "pin.updateFramePlacements(m, d)\n"
for _frame, _rf in FRAMES.items():
    WAYS |= {
        f"placement_regressor_{_frame}": Way(
            "computeJointKinematicRegressor",
            _REGRESSOR + _EACH_JOINT.format(of=f"pin.computeJointKinematicRegressor(m, d, j, {_rf})[:, own]"),
        ),
        f"placement_regressor_{_frame}:computeFrameKinematicRegressor": Way(
            "computeFrameKinematicRegressor",
            _REGRESSOR + _EACH_FRAME.format(of=f"pin.computeFrameKinematicRegressor(m, d, f, {_rf})[:, own]"),
        ),
        f"jacobian_dq_{_frame}:getFrameKinematicHessian": Way(
            "getFrameKinematicHessian",
            "pin.computeJointJacobians(m, d, q)\npin.computeJointKinematicHessians(m, d)\n"
            "pin.updateFramePlacements(m, d)\n"
            + _EACH_FRAME.format(of=f"pin.getFrameKinematicHessian(m, d, f, {_rf})"),
        ),
    }
