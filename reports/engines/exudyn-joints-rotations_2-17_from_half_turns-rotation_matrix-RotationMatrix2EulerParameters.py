# exudyn-joints 1.13.6, rotations, 2^-17 from half turns: RotationMatrix2EulerParameters is imprecise (rows of R).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([6.117185651155329e-06, 0.6433231366387009, 0.7465840232303513, 0.1695512845280324])
q2 = np.array([6.117185651155329e-06, 0.6433231366387009, 0.7465840232303513, 0.1695512845280324])
R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)
value = np.ravel(rbu.EulerParameters2RotationMatrix(rbu.RotationMatrix2EulerParameters(R)))
import numpy as np
value, expected = np.reshape(value, (9,))[(6,)], 0.21814339438124067
assert abs(value - expected) <= 1.6e-12, f"{value = }, {expected = }"
