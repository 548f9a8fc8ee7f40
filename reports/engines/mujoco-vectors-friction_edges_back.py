# mujoco 4.0.0, vectors: mju_decodePyramid is wrong (normal and tangents of that force, from these edges).
import numpy as np
import mujoco as mj
v = np.array([0.0, 0.0, 1.0])
w = np.array([8 * (1 + abs(v[1]) + abs(v[2])), v[1], v[2]])
mu, edges = np.array([0.5, 0.25]), np.zeros(4)
mj.mju_encodePyramid(edges, w, mu)
value = np.zeros(3)
mj.mju_decodePyramid(value, edges, mu)
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], 1.0
assert abs(value - expected) <= 2.3e-11, f"{value = }, {expected = }"
