# mujoco 4.0.0, vectors: mju_encodePyramid is wrong (edges of a contact force, of frictions (0.5, 0.25)).
import numpy as np
import mujoco as mj
v = np.array([0.0, 0.0, 0.0])
w = np.array([8 * (1 + abs(v[1]) + abs(v[2])), v[1], v[2]])
value = np.zeros(4)
mj.mju_encodePyramid(value, w, np.array([0.5, 0.25]))
import numpy as np
value, expected = np.reshape(value, (4,))[(0,)], 2.0
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
