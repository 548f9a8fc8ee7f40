# spatialmath 1.1.18, rotations: Plane3.intersection raises (the point of these and the one through v2 normal to (8, -4, 4)).
import numpy as np
import spatialmath.base as sm
a = np.array([-0.45902228709100545, -0.39625206603607555, -0.8533158648967247])
tau = np.array([-0.8948288577550136, 0.6149502567089378, 0.6266106715793658])
v2 = np.array([-0.9900567750811642, -0.33988931180500503, -0.821826286778075])
import spatialmath as cls
away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))
def unit(x): return x / np.linalg.norm(x)
A, B, C = (cls.Plane3.PointNormal(x, unit(n)) for x, n in ((a, away), (tau, aside), (v2, beside)))
value = cls.Plane3.intersection(A, B, C)
