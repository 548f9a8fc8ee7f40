# spatialmath 1.1.18, rotations: Twist3.pole is wrong (the point of that line nearest to the origin).
import numpy as np
import spatialmath.base as sm
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 1.0])
import spatialmath as cls
away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))
S = cls.Twist3(a, v + away)
value = S.pole() if callable(S.pole) else S.pole
import numpy as np
value, expected = np.reshape(value, (3,))[(0,)], -0.05555555555555555
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
