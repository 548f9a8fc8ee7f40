# spatialmath 1.1.18, rotations: Twist3.unit is wrong (the twist (a; v + (4, -8, 8)) for a radian).
# Known: https://github.com/bdaiinstitute/spatialmath-python/pull/225.
import numpy as np
import spatialmath.base as sm
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 1.0])
import spatialmath as cls
away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))
S = cls.Twist3(a, v + away)
value = S.unit().S
import numpy as np
value, expected = np.reshape(value, (6,))[(2,)], 0.08333333333333333
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
