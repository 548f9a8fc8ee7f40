# trimesh 5.2.0, rotations, 2^-27 from none: quaternion_slerp is imprecise (rows of the rotation a quarter of the way from R to Q, the shorter way).
import numpy as np
import trimesh
from trimesh import transformations as tr
q = np.array([1.0, 0.0, 0.0, 0.0])
q2 = np.array([1.0, -2.5428705261084143e-09, -4.748220877582511e-09, -4.676746860152509e-09])
value = tr.quaternion_matrix(tr.quaternion_slerp(q, q2, 0.25))[:3, :3].ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(6,)], 2.374110440277801e-09
assert abs(value - expected) <= 1.7e-12, f"{value = }, {expected = }"
