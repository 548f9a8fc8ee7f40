# exudyn-joints 1.13.6, rotations, 2^-8 from none: TExpSE3Inv is imprecise (J: the rates of the twist that leads to X are J times the twist of X in its own frame).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([0.9999925737590464, 0.002479303751871471, 0.0028772385218887456, 0.0006534356526247721])
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.9999929676404529, -0.0013369016122885523, -0.002496353660780755, -0.0024587765493400303])
R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)
X, Y = rbu.HomogeneousTransformation(R, a), rbu.HomogeneousTransformation(Q, tau)
T = lie.LogSE3(X)
value = lie.TExpSE3Inv(np.r_[T[:3, 3], rbu.Skew2Vec(T[:3, :3])])
import numpy as np
value, expected = np.reshape(value, (6, 6))[(2, 5)], -1.2568256567251072e-09
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
