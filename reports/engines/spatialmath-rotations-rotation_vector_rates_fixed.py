# spatialmath 1.1.18, rotations: rotvelxform raises (A^-1 at r = v, along the axes before).
import numpy as np
import spatialmath.base as sm
v = np.array([0.0, 0.0, 0.0])
value = sm.rotvelxform(v, inverse=True, representation='exp')
