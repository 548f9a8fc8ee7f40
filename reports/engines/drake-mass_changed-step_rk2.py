# drake 1.51.1, mass changed: runge_kutta2 is wrong (q+, v+ (nq + nv) after a step: Heun's method of order 2, in coordinates).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
def X(R, r): return drake.RigidTransform(drake.RotationMatrix(np.array(R)), r)
def inertia(mass, com, I):
    if mass == 0 and not np.any(I): return drake.SpatialInertia.Zero()
    I = np.array(I)
    about = drake.RotationalInertia(*I.diagonal(), I[0, 1], I[0, 2], I[1, 2])
    return drake.SpatialInertia.MakeFromCentralInertia(mass, com, about)
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
b0 = p.AddRigidBody('a', inertia(2.0, [1.0, 0.0, 0.0], ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))))
j0 = p.AddJoint(drake.RevoluteJoint('j0', p.AddFrame(drake.FixedOffsetFrame('P0', p.world_body(), X([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]))), b0.body_frame(), [0.0, 0.0, 1.0]))
p.Finalize()
links = [b0]
js = [p.GetJointByName(f'j{k}') for k in range(1)]
c = p.CreateDefaultContext()
p.CalcMassMatrix(c)
b0.SetSpatialInertiaInBodyFrame(c, inertia(1.0, [1.0, 0.0, 0.0], ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))))
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([1.0])
sim = drake.Simulator(p)
c = sim.get_mutable_context()
drake.ResetIntegratorFromFlags(sim, 'runge_kutta2', 0.015625)
sim.get_mutable_integrator().set_fixed_step_mode(True)
p.SetPositions(c, q)
p.SetVelocities(c, v)
p.get_applied_generalized_force_input_port().FixValue(c, tau)
sim.AdvanceTo(0.015625)
value = np.r_[p.GetPositions(c), p.GetVelocities(c)]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 0.0078125
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
