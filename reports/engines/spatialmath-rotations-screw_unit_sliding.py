# spatialmath 1.1.18, rotations: Twist3.unit raises (the twist (v + (4, -8, 8); 0) for a metre).
import numpy as np
import spatialmath.base as sm
v = np.array([0.3881357647151733, -0.10262307947376259, 0.280353617179524])
a = np.array([-0.45902228709100545, -0.39625206603607555, -0.8533158648967247])
import spatialmath as cls
away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))
S = cls.Twist3(a, v + away)
value = cls.Twist3(v + away, 0 * v).unit().S
