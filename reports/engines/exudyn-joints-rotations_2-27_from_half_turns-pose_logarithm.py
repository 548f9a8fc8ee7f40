# exudyn-joints 1.13.6, rotations, 2^-27 from half turns: LogSE3 is wrong (twist (linear; angular) that leads to X in unit time).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([1.8521579162458794e-09, -0.6309942593863409, -0.5766413171834431, -0.5189711320858095])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([1.0, -1.7878053885508259e-09, -1.6338063875640902e-09, -1.470408596056961e-09])
R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)
X, Y = rbu.HomogeneousTransformation(R, a), rbu.HomogeneousTransformation(Q, tau)
T = lie.LogSE3(X)
value = [*T[:3, 3], *rbu.Skew2Vec(T[:3, :3])]
import numpy as np
value, expected = np.reshape(value, (6,))[(3,)], -1.982326927408059
assert abs(value - expected) <= 2.1e-12, f"{value = }, {expected = }"
