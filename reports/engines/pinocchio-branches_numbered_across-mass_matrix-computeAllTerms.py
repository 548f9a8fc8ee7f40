# pinocchio 4.1.0, branches, numbered across: computeAllTerms is wrong (M).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/1897.
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'f')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3.Identity(), 'e')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
d = m.createData()
pin.computeAllTerms(m, d, np.zeros(3), np.zeros(3))
value, expected = d.M[0, 1], 0.0
assert abs(value - expected) <= 2.9e-12, f'value = {value!r}, expected = {expected!r}'
