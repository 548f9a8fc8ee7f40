# drake 1.51.1, force elements: Wing is wrong (force of a flat plate in the wind tau, and where it acts).
import numpy as np
import numpy as np
import pydrake.all as drake
q = np.array([0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
v2 = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.2887209756040745, -0.34129830280374557, -0.6372954148539809, -0.6277023346743316])
R = drake.RotationMatrix(drake.Quaternion(q))
Q = drake.RotationMatrix(drake.Quaternion(q2))
s = drake.Wing(drake.BodyIndex(1), 0.75, drake.RigidTransform(Q, [0.25, -0.5, 0.125]), 1.25)
c = s.CreateDefaultContext()
s.get_body_poses_input_port().FixValue(c, [drake.RigidTransform(), drake.RigidTransform(R, a)])
s.get_body_spatial_velocities_input_port().FixValue(c, [drake.SpatialVelocity.Zero(), drake.SpatialVelocity(w=v, v=v2)])
s.get_wind_velocity_input_port().FixValue(c, tau)
F = s.get_spatial_force_output_port().Eval(c)[0]
value = [*F.F_Bq_W.translational(), *s.get_aerodynamic_center_output_port().Eval(c)]
import numpy as np
value, expected = np.reshape(value, (6,))[(1,)], 0.10375464414953825
assert abs(value - expected) <= 1.6e-12, f"{value = }, {expected = }"
