"""pinocchio 4.1.0: getJointKinematicHessian, revolute x.

Result: their derivatives by q (L, 6, nv, nv).
Known: https://github.com/stack-of-tasks/eigenpy/issues/557.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRX(), pin.SE3(np.eye(3), np.array([0.0, 1.0, 0.0])), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 0.0])
pin.computeJointJacobians(m, d, q)
pin.computeJointKinematicHessians(m, d)
value = np.array([pin.getJointKinematicHessian(m, d, j, pin.LOCAL_WORLD_ALIGNED) for j in js])
value = np.array(value, dtype=float)
value = value[1, 0, 0, 1]
expected = 0.0
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.4e-12
