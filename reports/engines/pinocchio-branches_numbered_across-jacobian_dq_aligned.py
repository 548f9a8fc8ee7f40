"""pinocchio 4.1.0: getJointKinematicHessian, branches, numbered across.

Result: their derivatives by q (L, 6, nv, nv).
Known: https://github.com/stack-of-tasks/pinocchio/issues/1897.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3.Identity(), 'c')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3(np.eye(3), np.array([1.0, 0.0, 0.0])), 'f')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 0.0])
pin.computeJointJacobians(m, d, q)
pin.computeJointKinematicHessians(m, d)
value = np.array([pin.getJointKinematicHessian(m, d, j, pin.LOCAL_WORLD_ALIGNED) for j in js])
value = np.array(value, dtype=float)
value = value[1, 0, 1, 0]
expected = 0.0
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.1e-12
