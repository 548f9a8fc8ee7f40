# drake 1.51.1, rotations, 2^-12 from each other: Quaternion.slerp is imprecise (rows of the rotation a quarter of the way from R to Q, the shorter way).
import numpy as np
import numpy as np
import pydrake.all as drake
q = np.array([-0.18877504894423414, 0.6317591176355501, 0.7331581168476692, 0.16650397557065305])
q2 = np.array([-0.18858278102034484, 0.631688369282471, 0.7332704294561494, 0.16649569394155392])
value = drake.Quaternion(q).slerp(0.25, drake.Quaternion(q2)).rotation().ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(8,)], -0.8733184824139285
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
