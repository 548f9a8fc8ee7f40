# pinocchio 4.1.0, base 10 km away: data.dAg is imprecise (dA/dt).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([6400.0, -4800.0, 6000.0])), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[0.07404893536252394, 0.011777050735461883, 0.005841387202879444], [0.011777050735461883, 0.10741947676947003, -0.003784782121519158], [0.005841387202879444, -0.003784782121519158, 0.12648701812474122]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0])
v = np.array([1.0])
pin.dccrba(m, d, q, v)
value = d.dAg
import numpy as np
value, expected = np.reshape(value, (6, 1))[(4, 0)], 0.005841387202879444
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
