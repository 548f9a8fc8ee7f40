"""pinocchio 4.1.0: computeABADerivatives, universal.

Result: derivative of forward dynamics by q (nv, nv).
Known: none found.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, -9.81])
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([1.0, 0.0, 0.0]), np.eye(3)), pin.SE3.Identity())
d = m.createData()
q = np.array([1.0, 0.0])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
value = pin.computeABADerivatives(m, d, q, v, tau)[0]
value = np.array(value, dtype=float)
expected = np.array([[0.0, -8.254830360965466], [-4.127415180482733, 0.0]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.3e-11
