# idyntree 15.1.0, rotations, 2^-17 from none: Rotation.leftJacobian is imprecise (A at r = tau, in the turned axes).
import numpy as np
import idyntree.bindings as iDynTree
tau = np.array([0.0, 0.0, 4.780660030970503e-06])
value = iDynTree.Rotation.leftJacobian(iDynTree.Vector3.FromPython(tau)).toNumPy().T
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 1)], 2.390330015480699e-06
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
