# exudyn-joints 1.13.6, rotations: TExpSE3 is wrong (J: the twist of exp x in its own frame is J x', at x = (v; v2)).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
v = np.array([0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, 1.0])
value = lie.TExpSE3(np.r_[v, v2])
import numpy as np
value, expected = np.reshape(value, (6, 6))[(1, 3)], -0.3817732906760362
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
