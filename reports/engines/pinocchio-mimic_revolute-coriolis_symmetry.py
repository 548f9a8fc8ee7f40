"""pinocchio 4.1.0: computeCoriolisMatrix, mimic revolute.

Result: C + C^T = dM/dt (nv, nv).
Known: none found.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
s1 = pin.JointModelRY()
s1.setIndexes(j0, m.idx_qs[j0], m.idx_vs[j0])
j1 = m.addJoint(j0, pin.JointModelMimic(s1, 2.0, 0.0), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.array([[0.1334925368161152, -0.015084174080295394, -0.0016819088511224373], [-0.015084174080295394, 0.1461971935423592, 0.01669103038317763], [-0.0016819088511224373, 0.01669103038317763, 0.1330986226923458]])), pin.SE3.Identity())
d = m.createData()
q = np.array([0.0])
v = np.array([1.0])
C = pin.computeCoriolisMatrix(m, d, q, v)
value = C + C.T
value = np.array(value, dtype=float)
expected = np.array([[0.1268006076609313]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.8e-13
