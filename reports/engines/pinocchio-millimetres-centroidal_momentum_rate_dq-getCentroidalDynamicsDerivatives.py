# pinocchio 4.1.0, millimetres: computeRNEADerivatives, getCentroidalDynamicsDerivatives is imprecise (derivative of d(A v)/dt by q).
import numpy as np
import pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([-0.0001328901818215445, -0.0001889288693407729, 4.2692941312331146e-05]), np.array([[1.5387418968542935e-16, -1.040257262437649e-18, -7.580033460432243e-18], [-1.040257262437649e-18, 1.570376058065325e-16, 7.857115752477788e-18], [-7.580033460432243e-18, 7.857115752477788e-18, 1.848297784889552e-16]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0])
v = np.array([-0.8020666483629364])
a = np.array([0.0])
pin.computeRNEADerivatives(m, d, q, v, a)
value = pin.getCentroidalDynamicsDerivatives(m, d)[1]
import numpy as np
value, expected = np.reshape(value, (6, 1))[(1, 0)], 2.7464834858593312e-05
assert abs(value - expected) <= 3.8e-16, f"{value = }, {expected = }"
