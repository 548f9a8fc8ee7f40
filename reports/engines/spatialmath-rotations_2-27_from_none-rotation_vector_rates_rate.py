# spatialmath 1.1.18, rotations, 2^-27 from none: rotvelxform_inv_dot raises (time derivative of the latter at r = tau, r' = a).
import numpy as np
import spatialmath.base as sm
a = np.array([-0.45902228709100545, -0.39625206603607555, -0.8533158648967247])
tau = np.array([-6.666994525157017e-09, 4.581736450708939e-09, 4.668613311494632e-09])
value = sm.rotvelxform_inv_dot(tau, a, representation='exp')
