# exudyn-joints 1.13.6, rotations, 2^-17 from none: CompositionRuleSemiDirectProductR3AndR3RotVec is imprecise (X Y).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([1.0, 0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.999999999973322, -2.603913535337215e-06, -4.86220453812469e-06, -4.789014747492394e-06])
R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)
X, Y = rbu.HomogeneousTransformation(R, a), rbu.HomogeneousTransformation(Q, tau)
T = lie.LogSE3(Y)
x = lie.CompositionRuleSemiDirectProductR3AndR3RotVec(np.r_[a, rbu.RotationMatrix2RotationVector(R)], np.r_[T[:3, 3], rbu.Skew2Vec(T[:3, :3])])
value = [*x[:3], *rbu.RotationVector2RotationMatrix(x[3:]).flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(9,)], 9.724434016350595e-06
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
