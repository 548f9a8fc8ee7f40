"""Drake's integrators on linear systems, linearisation, controllers, equations of Riccati, spatial algebra."""

from __future__ import annotations

from ...interface import STEP
from ...truth.features.systems import GAINS, INTEGRATORS, PENDULUM, PERIOD
from ..writing.source import Way, ways_of

_F = "def f(x): return x / (1 + np.abs(x))\n"
_A = f"{_F}A = np.array([f(v), f(a), f(v2)]) - 2 * np.eye(3)\nO = np.zeros((0, 0))\n"
_AFFINE = f"{_A}system = drake.AffineSystem(A, np.zeros((3, 0)), f(v), np.eye(3), np.zeros((3, 0)), np.zeros(3))\n"
_SIMULATED = f"""sim = drake.Simulator(system)
drake.ResetIntegratorFromFlags(sim, 'NAME', {STEP})
one = sim.get_mutable_integrator()
one.set_fixed_step_mode(True)
sim.get_mutable_context().SetContinuousState(tau)
sim.AdvanceTo({STEP})
value = sim.get_context().get_continuous_state_vector().CopyToVector()"""
# Newton's iterations of implicit methods end where a step is small beside this accuracy.
_IMPLICIT = ("radau1", "radau3")
WAYS = {
    f"linear_step_{name}": Way(
        name,
        _AFFINE + _SIMULATED.replace("NAME", name),
        1e-9 if name in _IMPLICIT else 0.0,
    )
    for name in INTEGRATORS
}
_DISCRETE = (
    f"{_A}system = drake.AffineSystem(A, np.zeros((3, 0)), f(v), A.T, np.zeros((3, 0)), np.zeros(3), {PERIOD})\n"
)
_LINEAR = (
    f"{_A}system = drake.LinearSystem(A, A, A.T, A)\nc = system.CreateDefaultContext()\nc.SetContinuousState(tau)\n"
)
_MASS, _LENGTH, _GRAVITY = PENDULUM
_PENDULUM = f"""p = drake.MultibodyPlant(0.0)
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -{_GRAVITY}])
place = np.array([0.0, 0.0, -{_LENGTH}])
G = drake.UnitInertia.PointMass(place)
b = p.AddRigidBody('b', drake.SpatialInertia({_MASS}, place, G))
j = p.AddJoint(drake.RevoluteJoint('j', p.world_frame(), b.body_frame(), [0, 1, 0]))
p.AddJointActuator('m', j)
p.Finalize()
c = p.CreateDefaultContext()
p.SetPositions(c, tau[:1])
"""
_HELD = f"port = p.get_actuation_input_port()\nport.FixValue(c, [{_MASS * _GRAVITY * _LENGTH} * np.sin(tau[0])])\n"
_OF = "input_port_index=port.get_index(), output_port_index=drake.OutputPortSelection.kNoOutput"
_OUT = "value = np.c_[linear.A(), linear.B()]"
_INTEGRATOR = "np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])"
_X = "x = np.abs(v) + 0.5\n"
_SOLVED = f"{_A}X = np.outer(f(tau), f(tau)) + np.eye(3)\n"
_KP, _KI, _KD = (f"np.full(3, {gain})" for gain in GAINS)
_TWISTS = "V, U = drake.SpatialVelocity(w=a, v=v), drake.SpatialVelocity(w=tau, v=v2)\n"
_RATES = "B, D = drake.SpatialAcceleration(alpha=tau, a=v2), drake.SpatialAcceleration(alpha=a, a=v)\n"
_LISTED = "value = [*T.translational(), *T.rotational()]"


def _controlled(made: str, more: str) -> str:
    """Torque of a controller of the pendulum at tau."""
    return f"{_PENDULUM}s = drake.{made}\ne = s.CreateDefaultContext()\n{more}"


_ESTIMATED = "s.get_input_port_estimated_state().FixValue(e, tau[:2])\n"
_INVERSE_DYNAMICS = (
    _controlled("InverseDynamics(p)", f"{_ESTIMATED}s.get_input_port_desired_acceleration().FixValue(e, a[:1])\n")
    + "value = s.get_output_port_generalized_force().Eval(e)"
)
_JOINT_STIFFNESS_CONTROLLER = (
    _controlled(
        f"JointStiffnessController(p, [{GAINS[0]}], [{GAINS[2]}])",
        f"{_ESTIMATED}s.get_input_port_desired_state().FixValue(e, v[:2])\n",
    )
    + "value = s.get_output_port_actuation().Eval(e)"
)
WAYS |= ways_of(f"""
== linear_update | AffineSystem with a period
{_DISCRETE}c = system.CreateDefaultContext()
c.SetDiscreteState(tau)
value = system.EvalUniquePeriodicDiscreteUpdate(c).value()
== linear_update:Simulator | AdvanceTo of an AffineSystem with a period
{_DISCRETE}sim = drake.Simulator(system)
sim.get_mutable_context().SetDiscreteState(tau)
sim.AdvanceTo({PERIOD / 2})
value = sim.get_context().get_discrete_state_vector().CopyToVector()
== linear_output | LinearSystem
{_LINEAR}system.get_input_port().FixValue(c, f(v))
value = system.get_output_port().Eval(c)
== pendulum_linear | Linearize | {_PENDULUM}{_HELD}linear = drake.Linearize(p, c, {_OF})\n{_OUT}
== pendulum_linear:FirstOrderTaylorApproximation | FirstOrderTaylorApproximation
{_PENDULUM}p.SetVelocities(c, v[1:2])
{_HELD}linear = drake.FirstOrderTaylorApproximation(p, c, {_OF})
{_OUT}
== pendulum_torque | InverseDynamics | {_INVERSE_DYNAMICS}
== pendulum_holding | InverseDynamics, kGravityCompensation
{_controlled("InverseDynamics(p, drake.InverseDynamics.kGravityCompensation)", _ESTIMATED)}value = \
s.get_output_port_generalized_force().Eval(e)
== pendulum_stiffness | JointStiffnessController | {_JOINT_STIFFNESS_CONTROLLER}
== regulator ~ 1e-09 | LinearQuadraticRegulator
{_X}K, S = drake.LinearQuadraticRegulator({_INTEGRATOR}, np.diag(x[:2]), [[x[2]]])
value = [*K.flat, *S.flat]
== regulator:ContinuousAlgebraicRiccatiEquation ~ 1e-09 | ContinuousAlgebraicRiccatiEquation
{_X}A, B = {_INTEGRATOR}
S = drake.ContinuousAlgebraicRiccatiEquation(A, B, np.diag(x[:2]), [[x[2]]])
value = [*(B.T @ S / x[2]).flat, *S.flat]
== regulator_discrete ~ 1e-09 | DiscreteTimeLinearQuadraticRegulator
{_X}K, S = drake.DiscreteTimeLinearQuadraticRegulator(*(np.array([[y]]) for y in (*x, 1.0)))
value = [*K.flat, *S.flat]
== regulator_discrete:DiscreteAlgebraicRiccatiEquation ~ 1e-09 | DiscreteAlgebraicRiccatiEquation
{_X}S = drake.DiscreteAlgebraicRiccatiEquation(*(np.array([[y]]) for y in (*x, 1.0)))
value = [x[0] * x[1] * S[0, 0] / (1 + x[1] ** 2 * S[0, 0]), S[0, 0]]
== lyapunov ~ 1e-09 | RealContinuousLyapunovEquation
{_SOLVED}Q = -(A.T @ X + X @ A)
value = drake.RealContinuousLyapunovEquation(A, (Q + Q.T) / 2)
== lyapunov:RealDiscreteLyapunovEquation ~ 1e-09 | RealDiscreteLyapunovEquation
{_SOLVED}A = A / 8
Q = X - A.T @ X @ A
value = drake.RealDiscreteLyapunovEquation(A, (Q + Q.T) / 2)
== controllability | ControllabilityMatrix
{_A}value = drake.ControllabilityMatrix(drake.LinearSystem(A, f(v)[:, None], np.eye(3), np.zeros((3, 1))))
== controllability:ObservabilityMatrix | ObservabilityMatrix
{_A}value = drake.ObservabilityMatrix(drake.LinearSystem(A.T, np.zeros((3, 1)), f(v)[None], np.zeros((1, 1)))).T
== controlled_by_gains | PidController
s = drake.PidController({_KP}, {_KI}, {_KD})
c = s.CreateDefaultContext()
c.SetContinuousState(tau)
s.get_input_port_estimated_state().FixValue(c, np.r_[v, tau])
s.get_input_port_desired_state().FixValue(c, np.r_[a, v2])
value = s.get_output_port_control().Eval(c)
== filtered_rate | FirstOrderLowPassFilter
s = drake.FirstOrderLowPassFilter({GAINS[2]}, 3)
c = s.CreateDefaultContext()
s.set_initial_output_value(c, tau)
s.get_input_port().FixValue(c, v)
value = s.EvalTimeDerivatives(c).CopyToVector()
== waves | Sine
{_F}s = drake.Sine(2.0, 3.0, 0.5, 1, False)
c = s.CreateDefaultContext()
s.get_input_port(0).FixValue(c, f(v)[:1])
value = [s.get_output_port(k).Eval(c)[0] for k in range(3)]
== velocity_composed | SpatialVelocity.ComposeWithMovingFrameVelocity
{_F}{_TWISTS}T = V.ComposeWithMovingFrameVelocity(f(tau), U)
{_LISTED}
== velocity_composed:Shift | SpatialVelocity.Shift, + | {_F}{_TWISTS}T = V.Shift(f(tau)) + U\n{_LISTED}
== acceleration_composed | SpatialAcceleration.ComposeWithMovingFrameAcceleration
{_F}{_TWISTS}{_RATES}T = B.ComposeWithMovingFrameAcceleration(f(tau), a, U, D)
{_LISTED}
== acceleration_shifted | SpatialAcceleration.Shift
{_F}T = drake.SpatialAcceleration(alpha=a, a=v).Shift(f(tau), v2)
{_LISTED}
== power_of_wrench | SpatialForce.dot | value = [drake.SpatialForce(tau=v2, f=tau).dot(drake.SpatialVelocity(w=a, v=v))]
== power_of_wrench:SpatialVelocity | SpatialVelocity.dot
value = [drake.SpatialVelocity(w=a, v=v).dot(drake.SpatialForce(tau=v2, f=tau))]
== power_of_wrench:SpatialMomentum | SpatialMomentum.dot
value = [drake.SpatialMomentum(h=v2, l=tau).dot(drake.SpatialVelocity(w=a, v=v))]
== nearest_quaternion | ClosestQuaternion, QuaternionToCanonicalForm
import pydrake.math as dm
x, y = drake.Quaternion(q), drake.Quaternion(q2)
value = np.r_[dm.ClosestQuaternion(y, x).wxyz(), dm.QuaternionToCanonicalForm(x).wxyz()]
== turns_about_axes | RotationMatrix.MakeXRotation, MakeYRotation, MakeZRotation
{_F}x, y, z = f(v)
T = drake.RotationMatrix
R = T.MakeXRotation(x) @ T.MakeYRotation(y) @ T.MakeZRotation(z)
value = (R @ T(drake.Quaternion(q))).matrix().ravel()
""")
