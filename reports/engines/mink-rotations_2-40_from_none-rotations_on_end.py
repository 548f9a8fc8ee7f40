# mink 1.3.0, rotations, 2^-40 from none: SO3.as_rpy_radians is imprecise (rows of Rz(v[2]) Ry(p) Rx(v[0]), p a quarter turn up and down, once they are angles).
import numpy as np
import mink
v = np.array([0.0, 0.0, 2.549801294476529e-11])
(c, x), (d, z) = ((np.cos(angle), np.sin(angle)) for angle in (v[0], v[2]))
on_end = [
    np.array([[d, -z, 0], [z, d, 0], [0, 0, 1.0]])
    @ np.array([[0, 0, s], [0, 1.0, 0], [-s, 0, 0]])
    @ np.array([[1.0, 0, 0], [0, c, -x], [0, x, c]])
    for s in (1.0, -1.0)
]
value = [mink.SO3.from_rpy_radians(*mink.SO3.from_matrix(H).as_rpy_radians()).as_matrix().ravel() for H in on_end]
import numpy as np
value, expected = np.reshape(value, (2, 9))[(0, 1)], -2.549801294476529e-11
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
