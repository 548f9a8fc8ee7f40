# exudyn-joints 1.13.6, rotations, 2^-17 from none: CompositionRuleForRotationVectors is imprecise (rows of R Q).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([1.0, 0.0, 0.0, 0.0])
q2 = np.array([0.999999999973322, -2.603913535337215e-06, -4.86220453812469e-06, -4.789014747492394e-06])
R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)
r, s = rbu.RotationMatrix2RotationVector(R), rbu.RotationMatrix2RotationVector(Q)
value = np.ravel(lie.ExpSO3(lie.CompositionRuleForRotationVectors(r, s)))
import numpy as np
value, expected = np.reshape(value, (9,))[(6,)], 9.724434016350595e-06
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
