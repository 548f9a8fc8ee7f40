"""pinocchio 4.1.0: getJointKinematicHessian, revolute x.

Result: their derivatives by q (L, 6, nv, nv).
Known: https://github.com/stack-of-tasks/eigenpy/issues/557.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.array([[-0.02467881964266927, 0.9722568533170932, 0.2326103330443185], [-0.5086234790106703, -0.2125260893928938, 0.8343469409822547], [0.8606352958484369, -0.09772037917091789, 0.49975755625559615]]), np.zeros(3)), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
js = [j0]
d = m.createData()
q = np.array([1.0])
pin.computeJointJacobians(m, d, q)
pin.computeJointKinematicHessians(m, d)
value = np.array([pin.getJointKinematicHessian(m, d, j, pin.LOCAL) for j in js])
value = np.array(value, dtype=float)
expected = np.array([[[[0.0]], [[0.0]], [[0.0]], [[0.0]], [[-2.218131586663793e-16]], [[-2.403017130605087e-16]]]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 3.5e-28
