# dart 6.20.0, rotations: matrixToEulerZYX, eulerZYXToMatrix is wrong (rows of Rz(v[2]) Ry(p) Rx(v[0]), p a quarter turn up and down, once they are angles).
import numpy as np
import dartpy as dart
v = np.array([0.0, 0.0, 0.0])
(c, x), (d, z) = ((np.cos(angle), np.sin(angle)) for angle in (v[0], v[2]))
on_end = [
    np.array([[d, -z, 0], [z, d, 0], [0, 0, 1.0]])
    @ np.array([[0, 0, s], [0, 1.0, 0], [-s, 0, 0]])
    @ np.array([[1.0, 0, 0], [0, c, -x], [0, x, c]])
    for s in (1.0, -1.0)
]
value = [dart.math.eulerZYXToMatrix(dart.math.matrixToEulerZYX(H)).ravel() for H in on_end]
import numpy as np
value, expected = np.reshape(value, (2, 9))[(1, 2)], -1.0
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
