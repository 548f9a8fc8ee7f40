"""pinocchio 4.1.0: computeABADerivatives, universal.

Result: derivative of forward dynamics by v (nv, nv).
Known: none found.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3.Identity(), 'c')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
d = m.createData()
q = np.array([0.0, 0.0, 1.0])
v = np.array([0.0, 1.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
value = pin.computeABADerivatives(m, d, q, v, tau)[1]
value = np.array(value, dtype=float)
expected = np.array([[0.3076923076923077, 0.0, -0.4358974358974359], [-0.15384615384615385, 0.0, 0.05128205128205128], [-0.9230769230769231, 0.0, 0.3076923076923077]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.0e-12
