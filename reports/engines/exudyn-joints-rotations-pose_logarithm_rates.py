# exudyn-joints 1.13.6, rotations: TExpSE3Inv is wrong (J: the rates of the twist that leads to X are J times the twist of X in its own frame).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([0.6, 0.8, 0.0, 0.0])
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.6, 0.8, 0.0, 0.0])
R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)
X, Y = rbu.HomogeneousTransformation(R, a), rbu.HomogeneousTransformation(Q, tau)
T = lie.LogSE3(X)
value = lie.TExpSE3Inv(np.r_[T[:3, 3], rbu.Skew2Vec(T[:3, :3])])
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 4)], -0.19547141350120914
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
