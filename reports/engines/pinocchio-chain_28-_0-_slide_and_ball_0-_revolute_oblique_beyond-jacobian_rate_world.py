# pinocchio 4.1.0, chain 28: 0: slide and ball, 0: revolute oblique beyond: getFrameJacobianTimeVariation is wrong (their time derivatives).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
c = pin.JointModelComposite()
c.addJoint(pin.JointModelPX(), pin.SE3.Identity())
c.addJoint(pin.JointModelSpherical(), pin.SE3.Identity())
j0 = m.addJoint(0, c, pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 0.0, 1.0])
pin.computeJointJacobiansTimeVariation(m, d, q, v)
pin.updateFramePlacements(m, d)
value = np.array([pin.getFrameJacobianTimeVariation(m, d, f, pin.WORLD) for f in fs])
import numpy as np
value, expected = np.reshape(value, (1, 6, 4))[(0, 1, 0)], 0.0
assert abs(value - expected) <= 2.3e-12, f"{value = }, {expected = }"
