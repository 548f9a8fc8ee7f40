# pinocchio 4.1.0, revolute x: computeCentroidalMapTimeVariation is wrong (dA/dt).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2093 (of both functions; what mended it mended dccrba alone).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.2266489680764823, np.array([-0.1404018666962753, -0.19092806659330575, 0.17522556112929938]), np.array([[0.06982435939689069, -0.016589734274119947, 0.006802938969565607], [-0.016589734274119947, 0.07976249076681992, 0.004781782214263152], [0.006802938969565607, 0.004781782214263152, 0.09209434540359612]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRX(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(0.9580501576643867, np.array([0.07960795520047353, -0.17660585198000947, 0.14250302570126155]), np.array([[0.10427043973207122, -0.000454189254111427, -0.016110575320656788], [-0.000454189254111427, 0.13385750473995514, -0.01328348092080805], [-0.016110575320656788, -0.01328348092080805, 0.09889730873039354]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([-0.8020666483629364, 0.9725767279334938])
value = pin.computeCentroidalMapTimeVariation(m, d, q, v)
import numpy as np
value, expected = np.reshape(value, (6, 2))[(3, 0)], -0.05951206276524856
assert abs(value - expected) <= 6.4e-13, f"{value = }, {expected = }"
