# drake 1.51.1, servo along a hinge: EvalTimeDerivatives, AutoDiffXd is wrong (derivative of forward dynamics by v).
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
b0 = p.AddRigidBody('a', inertia(1.0, [0.0, 0.0, 0.0], ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))))
j0 = p.AddJoint(drake.RevoluteJoint('j0', p.AddFrame(drake.FixedOffsetFrame('P0', p.world_body(), X([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]))), b0.body_frame(), [0.0, 0.0, 1.0]))
motor = p.AddJointActuator('m0', j0)
motor.set_controller_gains(drake.PdControllerGains(p=6.0, d=0.5))
def sap(p):
    if hasattr(drake, 'DiscreteContactApproximation'):
        p.set_discrete_contact_approximation(drake.DiscreteContactApproximation.kSap)
    else:
        p.set_discrete_contact_solver(drake.DiscreteContactSolver.kSap)
p.Finalize()
links = [b0]
parents = [-1]
js = [p.GetJointByName(f'j{k}') for k in range(1)]
c = p.CreateDefaultContext()
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
from pydrake.autodiffutils import AutoDiffXd, ExtractGradient, InitializeAutoDiff
ad = p.ToAutoDiffXd()
d = ad.CreateDefaultContext()
d.SetTimeStateAndParametersFrom(c)
p.SetPositions(c, q)
p.SetVelocities(c, v)
p.get_actuation_input_port().FixValue(c, [2.0])
p.get_desired_state_input_port(drake.default_model_instance()).FixValue(c, [0.25, -0.5])
N = np.stack([p.MapVelocityToQDot(c, one) for one in np.eye(len(v))], axis=1)
q_ = InitializeAutoDiff(q, 0 * N).flatten()
v_ = InitializeAutoDiff(v, np.eye(len(v))).flatten()
ad.SetPositions(d, q_)
ad.SetVelocities(d, v_)
x = InitializeAutoDiff(np.array([2.0]), np.zeros((1, len(v))))
ad.get_actuation_input_port().FixValue(d, x.flatten())
x = InitializeAutoDiff(np.array([0.25, -0.5]), np.zeros((2, len(v))))
ad.get_desired_state_input_port(drake.default_model_instance()).FixValue(d, x.flatten())
port = ad.get_applied_generalized_force_input_port()
port.FixValue(d, InitializeAutoDiff(tau, np.zeros((len(v), len(v)))).flatten())
out = ad.EvalTimeDerivatives(d).CopyToVector()[len(q):]
value = ExtractGradient(out)
import numpy as np
value, expected = np.reshape(value, (1, 1))[(0, 0)], -0.5
assert abs(value - expected) <= 5.4e-13, f"{value = }, {expected = }"
