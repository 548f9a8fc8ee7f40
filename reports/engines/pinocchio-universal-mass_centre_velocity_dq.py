"""pinocchio 4.1.0: getCenterOfMassVelocityDerivatives, universal.

Result: derivative of its velocity by q (3, nv).
Known: none found.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([1.0, 0.0, 0.0]), np.eye(3)), pin.SE3.Identity())
d = m.createData()
q = np.array([0.0, 0.0])
v = np.array([1.0, 0.0])
pin.computeAllTerms(m, d, q, v)
value = pin.getCenterOfMassVelocityDerivatives(m, d)
value = np.array(value, dtype=float)
expected = np.array([[0.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.9e-12
