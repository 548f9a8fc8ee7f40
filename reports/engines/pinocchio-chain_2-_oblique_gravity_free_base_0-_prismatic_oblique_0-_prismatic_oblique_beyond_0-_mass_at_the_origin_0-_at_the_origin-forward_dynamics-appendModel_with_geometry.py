# pinocchio 4.1.0, chain 2: oblique gravity, free base, 0: prismatic oblique, 0: prismatic oblique beyond, 0: mass at the origin, 0: at the origin: appendModel with geometry, aba is wrong (M^-1 (tau - h)).
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
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
if globals().get('made_by') != 'appendModel with geometry':
    made_by = 'appendModel with geometry'
    import coal
    g = pin.GeometryModel()
    g.addGeometryObject(pin.GeometryObject('ball', 0, 0, pin.SE3.Identity(), coal.Sphere(0.25)))
    m, g = pin.appendModel(m, pin.Model(), g, pin.GeometryModel(), 0, pin.SE3.Identity())
    d = m.createData()
value = pin.aba(m, d, q, v, tau)
import numpy as np
value, expected = np.reshape(value, (6,))[(2,)], 0.0
assert abs(value - expected) <= 3.3e-13, f"{value = }, {expected = }"
