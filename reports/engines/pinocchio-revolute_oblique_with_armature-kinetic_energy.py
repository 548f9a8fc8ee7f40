"""pinocchio 4.1.0: computeKineticEnergy, revolute oblique with armature.

Result: T = v^T M v / 2.
Known: none found.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
m.armature = np.array([1.0])
d = m.createData()
q = np.array([0.0])
v = np.array([1.0])
value = pin.computeKineticEnergy(m, d, q, v)
value = np.array(value, dtype=float)
expected = 1.0
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.0e-12
