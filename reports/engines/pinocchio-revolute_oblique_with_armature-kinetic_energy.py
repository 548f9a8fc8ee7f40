# pinocchio 4.1.0, revolute oblique with armature: computeKineticEnergy is wrong (T = v^T M v / 2).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333,
    0.6666666666666666])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
m.armature = np.array([1.0])
value, expected = pin.computeKineticEnergy(m, m.createData(), np.zeros(1), np.array([1.0])), 1.0
assert abs(value - expected) <= 2e-12, f'value = {value!r}, expected = {expected!r}'
