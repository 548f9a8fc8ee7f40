# drake 1.51.1, millimetres: runge_kutta2 is imprecise (q+, v+ (nq + nv) after a step: Heun's method of order 2, in coordinates).
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
b0 = p.AddRigidBody('a', inertia(1.0, [0.0, 0.0, 0.0], ((1.5387418968542935e-16, -1.040257262437649e-18, -7.580033460432243e-18), (-1.040257262437649e-18, 1.570376058065325e-16, 7.857115752477788e-18), (-7.580033460432243e-18, 7.857115752477788e-18, 1.848297784889552e-16))))
j0 = p.AddJoint(drake.RevoluteJoint('j0', p.AddFrame(drake.FixedOffsetFrame('P0', p.world_body(), X([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]))), b0.body_frame(), [1.0, 0.0, 0.0]))
b1 = p.AddRigidBody('b', inertia(1.2036421551830162e-09, [-0.00012569491797322378, -4.368872038720237e-05, -0.00014679687296337136], ((1.4176586036222517e-16, -9.179437276663084e-18, -2.1797232902586208e-17), (-9.179437276663084e-18, 1.3614809591212705e-16, -8.263564708340657e-18), (-2.1797232902586208e-17, -8.263564708340657e-18, 1.4611189783779985e-16))))
j1 = p.AddJoint(drake.RevoluteJoint('j1', p.AddFrame(drake.FixedOffsetFrame('P1', b0, X([[-0.3057757785909339, -0.3793430037985685, -0.8732697513919667], [0.9452144776247547, -0.23108388696921345, -0.23058583753509626], [-0.11432744428032225, -0.8959347758917939, 0.4292203546338999]], [0.0001560235050976978, 9.882011712036254e-05, 0.0003782126711535207]))), b1.body_frame(), [0.6666666666666666, -0.3333333333333333, 0.6666666666666666]))
p.Finalize()
links = [b0, b1]
js = [p.GetJointByName(f'j{k}') for k in range(2)]
c = p.CreateDefaultContext()
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([0.0, 0.0])
tau = np.array([-0.39625206603607555, -0.8533158648967247])
c.SetTime(0.0)
sim = drake.Simulator(p, c)
drake.ResetIntegratorFromFlags(sim, 'runge_kutta2', 0.015625)
sim.get_mutable_integrator().set_fixed_step_mode(True)
p.SetPositions(c, q)
p.SetVelocities(c, v)
p.get_applied_generalized_force_input_port().FixValue(c, tau)
sim.AdvanceTo(0.015625)
value = np.r_[p.GetPositions(c), p.GetVelocities(c)]
import numpy as np
value, expected = np.reshape(value, (4,))[(3,)], 4.030895050434303e+24
assert abs(value - expected) <= 2.7e+13, f"{value = }, {expected = }"
