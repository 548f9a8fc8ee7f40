"""pinocchio 4.1.0: getJointKinematicHessian, universal.

Result: their derivatives by q (L, 6, nv, nv).
Known: https://github.com/stack-of-tasks/eigenpy/issues/557.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0])
pin.computeJointJacobians(m, d, q)
pin.computeJointKinematicHessians(m, d)
value = np.array([pin.getJointKinematicHessian(m, d, j, pin.WORLD) for j in js])
value = np.array(value, dtype=float)
value = value[0, 2, 1, 1]
expected = 0.0
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.0e-12
