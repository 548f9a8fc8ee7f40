"""pinocchio 4.1.0: computeCoriolisMatrix, universal.

Result: C v = h - g (nv), C the Coriolis matrix.
Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.array([[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]])), pin.SE3.Identity())
d = m.createData()
q = np.array([0.0, 1.0])
v = np.array([1.0, 1.0])
value = pin.computeCoriolisMatrix(m, d, q, v) @ v
value = np.array(value, dtype=float)
expected = np.array([1.8185948536513634, -0.9092974268256817])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 4.3e-12
