# pinocchio 4.1.0, chain 16: 0: ball, 0: armature, 0: ball beyond: getJointAccelerationDerivatives is wrong (derivative of the accelerations by q).
# Known: https://github.com/stack-of-tasks/pinocchio/pull/770 (mended the same term of other functions in 2019).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelSpherical(), pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
m.armature = np.array([0.0, 1.0, 1.0, 1.0])
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0, 0.0])
pin.computeForwardKinematicsDerivatives(m, d, q, v, a)
js
value = np.array([pin.getJointAccelerationDerivatives(m, d, j, pin.LOCAL_WORLD_ALIGNED)[1] for j in js])
import numpy as np
value, expected = np.reshape(value, (2, 6, 4))[(1, 3, 1)], 0.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
