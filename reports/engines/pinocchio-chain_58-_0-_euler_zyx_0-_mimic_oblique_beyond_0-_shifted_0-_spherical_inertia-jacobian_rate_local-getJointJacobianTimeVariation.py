# pinocchio 4.1.0, chain 58: 0: euler zyx, 0: mimic oblique beyond, 0: shifted, 0: spherical inertia: getJointJacobianTimeVariation is wrong (their time derivatives).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelSphericalZYX(), pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 1.0])
pin.computeJointJacobiansTimeVariation(m, d, q, v)
js
value = np.array([pin.getJointJacobianTimeVariation(m, d, j, pin.LOCAL) for j in js])
import numpy as np
value, expected = np.reshape(value, (1, 6, 3))[(0, 4, 0)], 1.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
