# exudyn-joints 1.13.6, rotations, 2^-17 from half turns: CompositionRuleForRotationVectors is imprecise (rows of R Q).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.0, 0.0, 0.0, 1.0])
R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)
r, s = rbu.RotationMatrix2RotationVector(R), rbu.RotationMatrix2RotationVector(Q)
value = np.ravel(lie.ExpSO3(lie.CompositionRuleForRotationVectors(r, s)))
import numpy as np
value, expected = np.reshape(value, (9,))[(1,)], 0.0
assert abs(value - expected) <= 2.8e-12, f"{value = }, {expected = }"
