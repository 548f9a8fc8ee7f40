"""roboticstoolbox 1.5.0: rne, fixed links amid.

Result: h (nv): Coriolis, centrifugal and gravity forces.
Known: none found.
"""

import numpy as np
from roboticstoolbox import ET, ETS, Link, Robot
def make():
    l0_0 = Link(ETS([ET.SE3(np.array([[-0.5834432847763826, -0.5364250393248788, -0.6097885786357817, 0.0], [0.5900284573887218, -0.7959108880210977, 0.13561813227202704, 0.0], [-0.5580863310643168, -0.28066712581770215, 0.7808749013538595, 0.0], [0.0, 0.0, 0.0, 1.0]]))]), name='b', parent=None, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    l1_0 = Link(ETS([ET.SE3(np.array([[-0.7071067811865475, -0.2357022603955158, 0.6666666666666666, 0.0], [0.0, -0.9428090415820632, -0.3333333333333333, 0.0], [0.7071067811865475, -0.2357022603955158, 0.6666666666666666, 0.0], [0.0, 0.0, 0.0, 1.0]])), ET.Rz(jindex=0)]), name='d', parent=l0_0, m=1.0, r=[-0.7071067811865475, -0.2357022603955158, 0.6666666666666666], I=np.array([[0.9999999999999998, -9.149958124033984e-19, -7.66449056764364e-18], [-9.149958124033984e-19, 0.9999999999999998, 1.7974594420119498e-17], [-7.66449056764364e-18, 1.7974594420119498e-17, 0.9999999999999999]]))
    return Robot([l0_0, l1_0], gravity=[0.0, 0.0, -9.81])
robot = make()
q = np.array([0.0])
v = np.array([0.0])
value = robot.rne(q, v, np.zeros(len(v)))
value = np.array(value, dtype=float)
expected = np.array([0.7178979245793486])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 3.4e-12
