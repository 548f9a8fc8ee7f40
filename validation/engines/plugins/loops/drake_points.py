"""Motions of points of links in Drake, their derivatives by automatic differentiation, and what accelerates."""

from __future__ import annotations

from ...truth.points import POINT
from ..writing.source import ways_of
from .drake_forces import FORCES, QV, Q
from .drake_gradients import BY_Q, BY_V, EACH, WHOLE, gradient

_FRAMES = (
    "W, kV = p.world_frame(), drake.JacobianWrtVariable.kV\n"
    f"at = [(kV, b.body_frame(), {list(POINT)}, W, W) for b in links]\n"
)
# At the accelerations a, which forces make.
_ACCELERATED = (
    f"{QV}{FORCES}tau = p.CalcInverseDynamics(c, a, forces)\n"
    "p.get_applied_generalized_force_input_port().FixValue(c, tau)\n"
)
_SEEDED = (
    "W, kV = ad.world_frame(), drake.JacobianWrtVariable.kV\n"
    f"at = [(kV, ad.get_body(b.index()).body_frame(), {list(POINT)}, W, W) for b in links]\n"
)
_VELOCITIES = f"{_SEEDED}out = [ad.CalcJacobianTranslationalVelocity(d, *x) @ v_ for x in at]{EACH}"
_ACCELERATIONS = (
    f"{_SEEDED}out = [ad.CalcJacobianTranslationalVelocity(d, *x) @ a"
    f" + np.ravel(ad.CalcBiasTranslationalAcceleration(d, *x)) for x in at]{EACH}"
)
WAYS = ways_of(f"""
== point_jacobians | CalcJacobianTranslationalVelocity
{Q}{_FRAMES}value = [p.CalcJacobianTranslationalVelocity(c, *x) for x in at]
== point_velocity_products | CalcBiasTranslationalAcceleration
{QV}{_FRAMES}value = [np.ravel(p.CalcBiasTranslationalAcceleration(c, *x)) for x in at]
== point_velocities_dq | CalcJacobianTranslationalVelocity, AutoDiffXd | {gradient(_VELOCITIES, BY_Q)}{WHOLE}
== point_accelerations_dq | CalcBiasTranslationalAcceleration, AutoDiffXd | {gradient(_ACCELERATIONS, BY_Q)}{WHOLE}
== point_accelerations_dv | CalcBiasTranslationalAcceleration, AutoDiffXd | {gradient(_ACCELERATIONS, BY_V)}{WHOLE}
== link_accelerations:EvalBodySpatialAccelerationInWorld | EvalBodySpatialAccelerationInWorld
{_ACCELERATED}every = [p.EvalBodySpatialAccelerationInWorld(c, b) for b in links]
value = [[*x.translational(), *x.rotational()] for x in every]
== mass_centre_acceleration | CalcCenterOfMassTranslationalAccelerationInWorld
{_ACCELERATED}value = p.CalcCenterOfMassTranslationalAccelerationInWorld(c)
""")
