# pinocchio 4.1.0, free, 2^-12 from zero: liegroups, dIntegrate_dv is imprecise (derivative of integrate by v2).
# Known: https://github.com/stack-of-tasks/pinocchio/pull/584 (bounds of the series by the scalar's precision).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, -0.0001239995655858489, 0.0, 0.0, 0.00015242901885576232])
L = pin.liegroups
def group(joint):
    if 'Composite' in joint.shortname():
        own = [group(one) for one in joint.extract().joints]
        return sum_of(own)
    known = {(2, 1): L.SO2, (4, 3): L.SE2 if 'Planar' in joint.shortname() else L.SO3, (7, 6): L.SE3}
    return known.get((joint.nq, joint.nv), lambda: L.Rn(joint.nv))()
def sum_of(groups):
    total = groups[0]
    for one in groups[1:]: total = total * one
    return total
G = sum_of([group(one) for one in m.joints[1:] if one.nv])
value = G.dIntegrate_dv(q, v2)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 3)], 6.300377358958554e-09
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
