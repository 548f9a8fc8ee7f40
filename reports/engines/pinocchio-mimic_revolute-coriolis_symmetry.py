# pinocchio 4.1.0, mimic revolute: computeCoriolisMatrix is wrong (C + C^T = dM/dt).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
s1 = pin.JointModelRY()
s1.setIndexes(j0, m.idx_qs[j0], m.idx_vs[j0])
j1 = m.addJoint(j0, pin.JointModelMimic(s1, 1.5, 0.0), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.array([[0.13349253681611525, -0.015084174080295353,
    -0.001681908851122453], [-0.015084174080295353, 0.14619719354235916, 0.01669103038317761], [-0.001681908851122453,
    0.01669103038317761, 0.1330986226923458]])), pin.SE3.Identity())
C = pin.computeCoriolisMatrix(m, m.createData(), np.zeros(1), np.array([1.0]))
value, expected = (C + C.T)[0, 0], 0.07006391017093189
assert abs(value - expected) <= 9.6e-14, f'value = {value!r}, expected = {expected!r}'
