# drake 1.51.1, four-bar in a plane: AdvanceTo with a constraint crashes (q, v (nq + nv) after a step at rest, without gravity and forces).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.015625)
def X(R, r): return drake.RigidTransform(drake.RotationMatrix(np.array(R)), r)
def inertia(mass, com, I):
    if mass == 0 and not np.any(I): return drake.SpatialInertia.Zero()
    I = np.array(I)
    about = drake.RotationalInertia(*I.diagonal(), I[0, 1], I[0, 2], I[1, 2])
    return drake.SpatialInertia.MakeFromCentralInertia(mass, com, about)
b0 = p.AddRigidBody('a', inertia(1.5, [0.5, 0.0, 0.25], ((0.2, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))))
j0 = p.AddJoint(drake.RevoluteJoint('j0', p.AddFrame(drake.FixedOffsetFrame('P0', p.world_body(), X([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]))), b0.body_frame(), [0.0, 1.0, 0.0]))
b1 = p.AddRigidBody('b', inertia(1.5, [0.5, 0.0, 0.25], ((0.2, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))))
j1 = p.AddJoint(drake.RevoluteJoint('j1', p.AddFrame(drake.FixedOffsetFrame('P1', b0, X([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [1.0, 0.0, 0.0]))), b1.body_frame(), [0.0, 1.0, 0.0]))
b2 = p.AddRigidBody('c', inertia(1.5, [0.5, 0.0, 0.25], ((0.2, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))))
j2 = p.AddJoint(drake.RevoluteJoint('j2', p.AddFrame(drake.FixedOffsetFrame('P2', b1, X([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [1.0, 0.0, 0.0]))), b2.body_frame(), [0.0, 1.0, 0.0]))
def sap(p):
    if hasattr(drake, 'DiscreteContactApproximation'):
        p.set_discrete_contact_approximation(drake.DiscreteContactApproximation.kSap)
    else:
        p.set_discrete_contact_solver(drake.DiscreteContactSolver.kSap)
sap(p)
p.AddBallConstraint(b2, [1.0, 0.0, 0.0], p.world_body(), [0.75, 0.0, 0.5])
p.mutable_gravity_field().set_gravity_vector([0, 0, 0]); p.Finalize()
links = [b0, b1, b2]
parents = [-1, 0, 1]
js = [p.GetJointByName(f'j{k}') for k in range(3)]
c = p.CreateDefaultContext()
q = np.array([0.5805871885690933, -1.2164764741184444, -2.03375583370991])
v = np.array([-0.49281934847680364, 0.4330983300299781, -0.45686421012988154])
sim = drake.Simulator(p)
sim.get_mutable_context().SetTimeStateAndParametersFrom(c)
c = sim.get_mutable_context()
c.SetTime(0.0)
p.SetPositions(c, q)
p.SetVelocities(c, 0 * v)
sim.AdvanceTo(0.015625)
value = np.r_[p.GetPositions(c), p.GetVelocities(c)]
