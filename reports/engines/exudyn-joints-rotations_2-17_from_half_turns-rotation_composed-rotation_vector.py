# exudyn-joints 1.13.6, rotations, 2^-17 from half turns: CreateRigidBody: initialRotationMatrix is imprecise (rows of R Q).
import numpy as np
import exudyn as exu
import exudyn.utilities as ut
from exudyn import lieGroupBasics as lie
from exudyn import rigidBodyUtilities as rbu
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.9999999999719328, 4.8199832725041895e-06, 5.593603258995662e-06, 1.270336042097247e-06])
container = exu.SystemContainer()
mbs, matrix = container.AddSystem(), ut.EulerParameters2RotationMatrix
body = mbs.CreateRigidBody(
    inertia=ut.InertiaCuboid(1000, [1, 1, 1]), referenceRotationMatrix=matrix(q), initialRotationMatrix=matrix(q2),
    nodeType=exu.NodeType.RotationRotationVector)
mbs.Assemble()
what, when = exu.OutputVariableType.RotationMatrix, exu.ConfigurationType.Initial
value = mbs.GetObjectOutputBody(body, what, [0, 0, 0], when)
import numpy as np
value, expected = np.reshape(value, (9,))[(1,)], 2.540618161974902e-06
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
