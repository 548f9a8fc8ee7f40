# pinocchio 4.1.0, chain 1: 0: revolute oblique, 0: revolute oblique beyond: getFrameKinematicHessian is wrong (their derivatives by q).
# Known: https://github.com/stack-of-tasks/eigenpy/issues/557.
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), 'b0')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 0.0])
pin.computeJointJacobians(m, d, q)
pin.computeJointKinematicHessians(m, d)
pin.updateFramePlacements(m, d)
value = np.array([pin.getFrameKinematicHessian(m, d, f, pin.LOCAL) for f in fs])
import numpy as np
value, expected = np.reshape(value, (2, 6, 2, 2))[(1, 0, 0, 1)], 1.0
assert abs(value - expected) <= 1.6e-12, f"{value = }, {expected = }"
