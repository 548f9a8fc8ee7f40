"""pinocchio 4.1.0: computeRNEADerivatives, branches, numbered across.

Result: derivative of M a + h by q (nv, nv).
Known: https://github.com/stack-of-tasks/pinocchio/issues/1897.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, -9.81])
j0 = m.addJoint(0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3.Identity(), 'f')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(j0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3.Identity(), 'e')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.array([1.0, 0.0, 0.0]), np.eye(3)), pin.SE3.Identity())
d = m.createData()
q = np.array([0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0])
value = pin.computeRNEADerivatives(m, d, q, v, a)[0]
value = np.array(value, dtype=float)
expected = np.array([[4.36, 0.0, 4.36], [0.0, 0.0, 0.0], [4.36, 0.0, 4.36]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 7.7e-12
