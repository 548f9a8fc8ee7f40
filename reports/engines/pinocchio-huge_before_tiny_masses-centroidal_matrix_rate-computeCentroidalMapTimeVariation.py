# pinocchio 4.1.0, huge before tiny masses: computeCentroidalMapTimeVariation is imprecise (dA/dt).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2093 (of both functions; what mended it mended dccrba alone).
import numpy as np
import pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(149152914.1632119, np.array([-0.043857032141920355, -0.025771785288849852, 0.18949070573878773]), np.array([[9765779.85204871, 303033.19644972985, 392273.05491541605], [303033.19644972985, 13379296.165810723, 997742.3511289492], [392273.05491541605, 997742.3511289492, 10444614.484902825]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.8591085792217488, np.array([-0.1283722546678156, 0.0949056874359388, 0.10892053953403968]), np.array([[0.09653939730059097, -0.005210450773638072, 0.010080265189673513], [-0.005210450773638072, 0.09444485801535862, -0.010289222977134565], [0.010080265189673513, -0.010289222977134565, 0.10898194686955133]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([-0.8020666483629364, 0.9725767279334938])
value = pin.computeCentroidalMapTimeVariation(m, d, q, v)
import numpy as np
value, expected = np.reshape(value, (6, 2))[(5, 0)], -0.0024141245673406
assert abs(value - expected) <= 1.2e-05, f"{value = }, {expected = }"
