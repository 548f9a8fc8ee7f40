"""Answers that are altered as a fault would alter them are red cells, where the engine's own are right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

from tests.late import needs_extra
from validation.engines.interface import Tree
from validation.engines.matrix import cells
from validation.engines.models import acting, hostile, loops, sensed, single, soft, transformed
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN
from validation.engines.plugins.writing.source import Source, SourcePlugin
from validation.engines.workers import registry

_FAMILIES: Mapping[str, Tree] = (
    acting.trees() | hostile.trees() | loops.trees() | sensed.trees() | single.trees() | soft.trees()
)
# Engine, tree, function, text of the call -> what it is in a call that has the fault.
FAULTS = [
    ("mujoco", "revolute x", "joint_wrenches_driven", "= q, v, tau", "= q, v, 2 * tau"),
    ("mujoco", "free", "joint_wrenches_driven", "mj.mj_rnePostConstraint(m, d)\n", ""),
    ("casadi", "ball", "mass_matrix_dq", "by_q(", "2 * by_q("),
    ("casadi", "free", "link_poses_dq", "ca.vec(R.T)", "ca.vec(R)"),
    ("drake", "revolute x", "joint_wrenches_driven", "FixValue(c, tau)", "FixValue(c, 2 * tau)"),
    ("drake", "ball", "mass_matrix_dq", "(q, N)", "(q, 2 * N)"),
    ("drake", "free", "link_poses_dq", "(q, N)", "(q, 2 * N)"),
    ("drake", "servos along joints", "step_stiffness_implicit_straight", "FixValue(c, tau)", "FixValue(c, tau + 0.5)"),
    (
        "drake",
        "servos against the order of joints",
        "controlled_forces",
        "control().Eval(e)",
        "control().Eval(e)[::-1]",
    ),
    (
        "drake",
        "forces against the order of joints",
        "actuated_forces",
        "output_port().Eval(c)",
        "output_port().Eval(c)[::-1]",
    ),
    ("drake", "rotations", "rotation_matrix_dq", "R.matrix()", "R.matrix().T"),
    ("drake", "rotations", "rotation_to_rpy_dq", ".vector()", ".vector()[::-1]"),
    ("drake", "rotations", "rotation_of_rpy_du", "_[AD](u)", "_[AD](2 * u)"),
    ("drake", "rotations", "rotation_exponential_du", "(length,", "(2 * length,"),
    ("drake", "rotations", "unit_vector_du", "MakeFromOneVector(u, 0)", "MakeFromOneVector(u + 1, 0)"),
    (
        "pybullet",
        "free base without weight",
        "inverse_dynamics",
        "inverse_dynamics(q,",
        "inverse_dynamics(np.r_[q[:7], q[6:-1]],",
    ),
    ("pybullet", "revolute x", "joint_wrenches_from_rest", "force=force", "force=2 * force"),
    ("sapien", "servo along a hinge", "step_stiffness_implicit", "tau +", "tau + 0.5 +"),
    ("newton", "servos along joints", "step_semi_implicit_normalized", "(tau + fed)", "(tau + 2 * fed)"),
    (
        "newton",
        "servo before a force against the order of joints",
        "step_semi_implicit_normalized",
        "assign(places",
        "assign(0 * places",
    ),
    ("sapien", "revolute x", "joint_wrenches_driven", "(tau)", "(50 * tau)"),
    ("dart", "planar", "link_turning", "b.getAngularVelocity()", "b.getLinearVelocity()"),
    ("roboticstoolbox", "three hinges", "inverse_dynamics:trajectory", ")[1]", ")[0]"),
    ("roboticstoolbox", "three hinges", "link_poses:ETS, trajectory", ").A[1]", ").A[2]"),
    ("dart", "revolute x", "joint_wrenches_driven", "setForces(tau)", "setForces(2 * tau)"),
    (
        "symofros",
        "revolute x",
        "joint_wrenches_driven",
        "forward_dynamics(q, v, tau)",
        "forward_dynamics(q, v, 2 * tau)",
    ),
    ("frax", "revolute oblique", "mass_matrix_dq", "@ rates(q)", "@ rates(2 * q) * 2"),
    ("pinocchio", "revolute x", "mass_matrix:saveToString", "m = n\n", "m = n\n    m.armature = m.armature + 1\n"),
    ("pinocchio", "ball", "bias:copied", "pin.Model(m)\n", "pin.Model(m)\n    m.gravity.linear = np.ones(3)\n"),
    ("pinocchio", "ball", "link_poses:buildReducedModel", "pin.neutral(m))", "pin.neutral(m)); fs.reverse()"),
    ("mujoco", "revolute x", "bias:pickle", "in (m, d))", "in (m, d)); m.body_mass[:] *= 2"),
    ("dart", "revolute x", "mass_matrix:clone", "s.clone()", "s.clone(); s.getBodyNode(0).setMass(9.0)"),
    ("drake", "revolute x", "link_poses:Clone", "(b.index()) for b in links]", "(b.index()) for b in links][::-1]"),
    ("pybullet", "revolute x", "link_poses:saveState", "p.restoreState(kept)", "kept"),
    ("exudyn-joints", "rotations", "rpy_rates_rate", "(-v, -a) @ B", "(-v, a) @ B"),
    ("exudyn-joints", "rotations", "pose_logarithm", "*T[:3, 3]", "*X[:3, 3]"),
    ("exudyn-joints", "rotations", "spatial_inertia_sum", "I.Transformed(X) + I", "I + I"),
    ("newton", "revolute z, 2^-12 from zero", "coordinates_of_links", "= q1.numpy()", "= 0 * q1.numpy()"),
    ("newton", "cylindrical", "speeds_of_links", "= v1.numpy()", "= v1.numpy()[::-1]"),
    ("exudyn", "revolute x", "bias:GetSystemState", "mbs.systemData.SetSystemState(kept)", "kept"),
    ("mjx", "revolute x", "link_poses:get_data", "get_data(m, forward(q", "get_data(m, forward(2 * q"),
    ("adam", "revolute oblique", "mass_matrix_dq", "ca.vec(M.T)", "2 * ca.vec(M.T)"),
    ("pinocchio", "universal", "acceleration_local:JointData", " + own.c", ""),
    ("pinocchio", "free", "integrate_dq:lieGroup", "dIntegrate_dq", "dIntegrate_dv"),
    ("pinocchio", "planar", "placement_regressor_world:computeFrameKinematicRegressor", "own]", "own[::-1]]"),
    ("pinocchio", "ball", "link_accelerations:RobotWrapper", "f, True, pin.LOCAL_WORLD_ALIGNED", "f"),
    ("pinocchio", "sensors beyond a ball", "frame_accelerations", "(m, d, q, v, a)", "(m, d, q, 2 * v, a)"),
    ("drake", "ball", "relative_accelerations", "(c, A, A)", "(c, A, p.world_frame())"),
    ("drake", "free", "coordinates_of_links", "Quaternion(x)", "Quaternion(x[::-1])"),
    ("drake", "universal", "stored_energy_rate", "-p.", "p."),
    ("drake", "free", "link_jacobians:kQDot", "@ N", "@ (2 * N)"),
    ("drake", "sensors on hinges", "frame_velocity_products", "kV, f", "kV, own[0]"),
    ("drake", "sensors on hinges", "applied_wrenches:applied_spatial_force", "index(), r", "index(), -np.array(r)"),
    ("drake", "sensors on hinges", "gyroscopes", "(c, v)", "(c, 2 * v)"),
    ("mujoco", "sensors on hinges", "frame_velocities_seen:camera", "frameangvel", "framelinvel"),
    ("mujoco", "sensors beyond a ball", "frame_accelerations:geom", " + np.r_[m.opt.gravity, 0, 0, 0]", ""),
    ("pinocchio", "point between branches", "constraint_jacobian:jacobianTransposeMatrixProduct", "-np", "np"),
    ("pinocchio", "weld between branches", "delassus_inverse:operator", ".solve(", ".matrix() @ ("),
    ("pinocchio", "point between branches", "constraint_forces:forwardDynamics", "-J @ bound", "J @ bound"),
    ("idyntree", "revolute oblique", "torque_regressor", "5, 7, 6, 8", "5, 6, 7, 8"),
    ("idyntree", "free", "centroidal_matrix:average velocity", "value = I", "value = 2 * I"),
    ("exudyn-joints", "springs and dampers on hinges and a slide", "passive_forces", "(q, v)[-1]", "(q, 2 * v)[-1]"),
    ("exudyn-joints", "tendon over points of one branch", "passive_forces:Rxyz", "value = D.T", "value = 2 * D.T"),
    ("dart", "universal", "acceleration_local:joints", " + rate @ v", ""),
    ("dart", "free", "coordinates_of_links", "q[own]", "q[own[::-1]]"),
    ("dart", "ball", "link_jacobian_rates:linear and angular", "AngularJacobianDeriv", "AngularJacobian"),
    ("mujoco", "hinge below its limit", "limited_acceleration:attach", "q, v, tau", "q, 2 * v, tau"),
    ("mujoco", "hinge below its limit", "limited_acceleration", "q, v, tau", "q, 2 * v, tau"),
    ("mujoco", "limits beside friction", "limiting_forces", "= q, v, tau", "= q, 2 * v, tau"),
    (
        "mujoco",
        "tendons with dry friction",
        "limiting_forces:mj_mulJacTVec",
        "d.efc_force)",
        "d.efc_force[::-1].copy())",
    ),
    ("mujoco", "balls below floors and above one", "floor_forces", "wrench[0]", "wrench[1]"),
    ("mujoco", "balls below floors and above one", "limiting_forces", "q, v, tau", "q, 2 * v, tau"),
    ("mujoco", "rotations", "solution:band and dense rows", "L, 3, 2, 1, 0.0", "L, 3, 2, 1, 0.125"),
    ("mujoco", "rotations", "solution_in_a_box", "A, -tau", "A, tau"),
    ("mujoco", "hinges beyond limits", "limited_inverse", "value = d.qfrc_inverse", "value = d.qfrc_inverse + d.qacc"),
    ("pinocchio", "rotations", "logarithmic_derivatives", "C.calculateJacobian()", "C.calculateJacobian().T"),
    ("pinocchio", "rotations", "rotation_difference_dq", "pin.ARG0", "pin.ARG1"),
    ("pinocchio", "rotations", "momentum_rate_regressor", "(V, A)", "(V, V)"),
    ("pinocchio", "ball", "subtree_centre_accelerations:acom", "q, v, a)", "q, v, v)"),
    ("pinocchio", "planar", "difference_dq2:liegroups", "ARG1", "ARG0"),
    ("pinocchio", "free", "coordinates_normalized", "pin.normalize(m, x)", "x"),
    ("pinocchio", "revolute x", "link_distances", "Sphere(0.125)", "Sphere(0.25)"),
    ("pinocchio", "ball", "carried_inertias:computeSupportedInertiaByFrame", "True)", "False)"),
    ("pinocchio", "sensors on hinges", "pushed_accelerations_dq", "tau, given", "tau"),
    (
        "pinocchio",
        "revolute oblique",
        "bias:appendModel to nothing",
        "SE3.Identity())",
        "SE3.Identity()); m.gravity.linear = -m.gravity.linear",
    ),
    ("pinocchio", "point between branches", "constrained_acceleration_dtau:data", "value = d.ddq", "value = 2 * d.ddq"),
    ("spatialmath", "rotations", "turn_about_line", "exp(tau[0])", "exp(-tau[0])"),
    ("idyntree", "rotations", "rpy_rates_rate", "(*v, *a)", "(*v, *v)"),
    ("idyntree", "rotations", "wrench_transform", "asAdjointTransformWrench", "asAdjointTransform"),
    ("idyntree", "free", "jacobian_world", "H[:3, 3])", "-H[:3, 3])"),
    ("idyntree", "free", "acceleration_local", "- np.cross(u[3:], u[:3])", ""),
    ("idyntree", "sensors on hinges", "accelerometers", "turned, 0", "0 * turned, 0"),
    ("idyntree", "free", "mass_matrix:updateInertialParameters", "(given)", "(given); given.setVal(0, 9.0)"),
    ("pybullet", "sensors on hinges", "pushed_accelerations", "p.LINK_FRAME", "p.WORLD_FRAME"),
    ("mujoco", "sensors on hinges", "magnetic_fields", "[0.25, -0.5, 1.0]", "[0.25, 1.0, -0.5]"),
]


@pytest.mark.parametrize(("engine", "name", "function", "right", "wrong"), FAULTS)
def test_a_planted_fault_is_a_red_cell(
    engine: str, name: str, function: str, right: str, wrong: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plugin = OWN[engine]
    assert isinstance(plugin, SourcePlugin)
    if not plugin.version():
        pytest.skip(needs_extra(engine, plugin.package))
    tree = _FAMILIES[name] if name in _FAMILIES else tree_of(name)
    (sound,) = cells(plugin, tree, (function,))
    written = plugin.written(tree)
    assert isinstance(written, Source)
    code = written.spelled(plugin.ways[function].code)
    assert right in code
    planted = replace(written, spelling={plugin.ways[function].code: code.replace(right, wrong)})
    monkeypatch.setitem(registry().plugins, engine, replace(plugin, write=lambda tree: planted))
    (red,) = cells(plugin, tree, (function,))
    assert sound.verdict == "right" or (engine == "pybullet" and sound.verdict == "imprecise")
    assert red.verdict == "wrong"


def test_mimicking_joints_are_not_asked_to_be_read_again() -> None:
    """Pinocchio leaves what they follow unset, so that it crashes, or answers by chance."""
    plugin = OWN["pinocchio"]
    asked = {
        cell.function for cell in cells(plugin, tree_of("mimic revolute"), ("link_poses", "link_poses:saveToString"))
    }
    assert "link_poses" in asked
    (again,) = cells(plugin, tree_of("mimic revolute"), ("link_poses:saveToString",))
    assert again.verdict == "not offered"


def test_masses_are_changed_after_they_were_used() -> None:
    tree = transformed.trees()["mass changed"]
    plugin = OWN["pybullet"]
    assert isinstance(plugin, SourcePlugin)
    made = plugin.write(tree)
    assert isinstance(made, Source)
    before, used, after = made.closing[1:]
    assert str([link.mass for link in tree.before.links]) in before and str([link.mass for link in tree.links]) in after
    assert "calculateMassMatrix" in used and "calculateInverseDynamics" in used
