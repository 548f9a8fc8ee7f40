"""pinocchio 4.1.0: computeABADerivatives, universal.

Result: derivative of forward dynamics by v (nv, nv).
Known: none found.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.array([[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]])), pin.SE3.Identity())
d = m.createData()
q = np.array([0.0, 1.0])
v = np.array([0.0, 1.0])
tau = np.array([0.0, 0.0])
value = pin.computeABADerivatives(m, d, q, v, tau)[1]
value = np.array(value, dtype=float)
expected = np.array([[-0.5323526594920907, 0.0], [0.0, 0.0]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.2e-12
