# idyntree 15.1.0, rotations, 2^-40 from none: Rotation.leftJacobianInverse is imprecise (A^-1 at r = v, along the axes before).
import numpy as np
import idyntree.bindings as iDynTree
v = np.array([0.0, 0.0, 2.549801294476529e-11])
value = iDynTree.Rotation.leftJacobianInverse(iDynTree.Vector3.FromPython(v)).toNumPy()
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 1)], 1.2749006472382644e-11
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
