# pinocchio 4.1.0, base 10 km away: computeCentroidalMapTimeVariation is wrong (dA/dt).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.8187017420963922, np.array([-0.043751762992496473, -0.1844729293362066, 0.1707799604227791]), np.array([[0.07404893536252394, 0.011777050735461883, 0.005841387202879444], [0.011777050735461883, 0.10741947676947003, -0.003784782121519158], [0.005841387202879444, -0.003784782121519158, 0.12648701812474122]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(0.7734754996812343, np.array([-0.0928185856251782, 0.1325220813545292, 0.006391162859845423]), np.array([[0.13910965735131725, -0.02510358457377781, -0.018588767412343218], [-0.02510358457377781, 0.1539231661941898, 0.015871486910339756], [-0.018588767412343218, 0.015871486910339756, 0.13342292270116682]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([-0.1816631824515902, -0.8567209055906702])
value = pin.computeCentroidalMapTimeVariation(m, d, q, v)
import numpy as np
value, expected = np.reshape(value, (6, 2))[(5, 0)], -0.024706307131026017
assert abs(value - expected) <= 6.3e-13, f"{value = }, {expected = }"
