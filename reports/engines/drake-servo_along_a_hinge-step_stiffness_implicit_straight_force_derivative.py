# drake 1.51.1, servo along a hinge: FirstOrderTaylorApproximation: B is wrong (derivative of q+ along speeds and v+ of that step by tau (2 nv, nv)).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.015625)
def X(R, r): return drake.RigidTransform(drake.RotationMatrix(np.array(R)), r)
def inertia(mass, com, I):
    if mass == 0 and not np.any(I): return drake.SpatialInertia.Zero()
    I = np.array(I)
    about = drake.RotationalInertia(*I.diagonal(), I[0, 1], I[0, 2], I[1, 2])
    return drake.SpatialInertia.MakeFromCentralInertia(mass, com, about)
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
b0 = p.AddRigidBody('a', inertia(1.0, [0.0, 0.0, 0.0], ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))))
j0 = p.AddJoint(drake.RevoluteJoint('j0', p.AddFrame(drake.FixedOffsetFrame('P0', p.world_body(), X([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]))), b0.body_frame(), [0.0, 0.0, 1.0]))
motor = p.AddJointActuator('m0', j0)
motor.set_controller_gains(drake.PdControllerGains(p=6.0, d=0.5))
def sap(p):
    if hasattr(drake, 'DiscreteContactApproximation'):
        p.set_discrete_contact_approximation(drake.DiscreteContactApproximation.kSap)
    else:
        p.set_discrete_contact_solver(drake.DiscreteContactSolver.kSap)
sap(p); p.SetUseSampledOutputPorts(False)
p.Finalize()
links = [b0]
parents = [-1]
js = [p.GetJointByName(f'j{k}') for k in range(1)]
c = p.CreateDefaultContext()
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
p.SetPositions(c, q)
p.SetVelocities(c, v)
p.get_actuation_input_port().FixValue(c, [2.0])
p.get_desired_state_input_port(drake.default_model_instance()).FixValue(c, [0.25, -0.5])
port = p.get_applied_generalized_force_input_port()
port.FixValue(c, tau)
linear = drake.FirstOrderTaylorApproximation(p, c, port.get_index(), drake.OutputPortSelection.kNoOutput)
end, n = p.CreateDefaultContext(), len(v)
p.SetPositionsAndVelocities(end, p.EvalUniquePeriodicDiscreteUpdate(c).value())
def along_speeds(X): return np.vstack([np.stack([p.MapQDotToVelocity(end, x) for x in X[:-n].T], axis=1), X[-n:]])
N = np.stack([p.MapVelocityToQDot(c, one) for one in np.eye(n)], axis=1)
value = along_speeds(linear.B())
import numpy as np
value, expected = np.reshape(value, (2, 1))[(1, 0)], 0.015481373971940009
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
