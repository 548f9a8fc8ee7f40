# pinocchio 4.1.0, chain 29: free base, oblique gravity, 0: offset hinges, 0: turned, 0: prismatic oblique beyond, 0: mass at the origin, 0: armature: getJointAccelerationDerivatives is wrong (derivative of the accelerations by q).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
c = pin.JointModelComposite()
c.addJoint(pin.JointModelRZ(), pin.SE3.Identity())
c.addJoint(pin.JointModelRZ(), pin.SE3(np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([0.0, 0.0, 0.0])))
j0 = m.addJoint(0, c, pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
m.armature = np.array([1.0, 1.0])
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0])
v = np.array([1.0, 1.0])
a = np.array([0.0, 0.0])
pin.computeForwardKinematicsDerivatives(m, d, q, v, a)
js
value = np.array([pin.getJointAccelerationDerivatives(m, d, j, pin.LOCAL_WORLD_ALIGNED)[1] for j in js])
import numpy as np
value, expected = np.reshape(value, (1, 6, 2))[(0, 5, 1)], 0.0
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
