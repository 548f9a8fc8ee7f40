"""What Pinocchio offers a second time: of joints instead of frames, in parallel, in data; and points of links."""

from __future__ import annotations

from ...functions import ALIGNED
from ...truth.points import POINT
from ..writing.source import Way, ways_of
from .functions import FRAMES
from .functions import WAYS as FIRST

_JOINTS = "js\nvalue = np.array([{of} for j in js])"
_FK = "pin.forwardKinematics(m, d, q, v, a)\n"
_FK_D = "pin.computeForwardKinematicsDerivatives(m, d, q, v, a)\n"
_TERMS = "pin.computeAllTerms(m, d, q, v)\nvalue = {of}"


def _of_joints(frame: str, rf: str) -> dict[str, Way]:
    """Functions of frames, of joints."""
    names = ALIGNED if frame == "aligned" else (f"jacobian_{frame}", f"jacobian_rate_{frame}", f"velocity_{frame}")
    rows = (
        (names[0], "getJointJacobian", "pin.computeJointJacobians(m, d, q)\n", "(m, d, j, {})"),
        (
            names[1],
            "getJointJacobianTimeVariation",
            "pin.computeJointJacobiansTimeVariation(m, d, q, v)\n",
            "(m, d, j, {})",
        ),
        (names[2], "getVelocity", _FK, "(m, d, j, {}).vector"),
        (f"acceleration_{frame}", "getAcceleration", _FK, "(m, d, j, {}).vector"),
        (f"velocity_dq_{frame}", "getJointVelocityDerivatives", _FK_D, "(m, d, j, {})[0]"),
        (f"acceleration_dq_{frame}", "getJointAccelerationDerivatives", _FK_D, "(m, d, j, {})[1]"),
        (f"acceleration_dv_{frame}", "getJointAccelerationDerivatives", _FK_D, "(m, d, j, {})[2]"),
    )
    ways = {
        f"{name}:{native}": Way(native, before + _JOINTS.format(of=f"pin.{native}{call.format(rf)}"))
        for name, native, before, call in rows
    }
    ways[f"{names[1]}:frameJacobianTimeVariation"] = Way(
        "frameJacobianTimeVariation", f"value = [pin.frameJacobianTimeVariation(m, d, q, v, f, {rf}) for f in fs]"
    )
    return ways


# Placement of the point in the joint's frame, whose derivatives are of components along the world's axes.
_AT = f"js\nX = pin.SE3(np.eye(3), np.array({list(POINT)}))\n{_FK_D}value = np.array([{{of}} for j in js])"
_VELOCITY = "pin.getPointVelocityDerivatives(m, d, j, X, pin.{})[{}]"
_ACCELERATION = "pin.getPointClassicAccelerationDerivatives(m, d, j, X, pin.{})[{}]"
_TURNED = "d.oMi[j].rotation @ {}"


def _points() -> dict[str, Way]:
    """Derivatives of motions of points, along the world's axes and along the joint's."""
    velocity, acceleration = "getPointVelocityDerivatives", "getPointClassicAccelerationDerivatives"
    aligned, local = "LOCAL_WORLD_ALIGNED", "LOCAL"
    turned = {place: _AT.format(of=_TURNED.format(_VELOCITY.format(local, place))) for place in (0, 1)}
    return {
        "point_jacobians": Way(velocity, _AT.format(of=_VELOCITY.format(aligned, 1))),
        "point_jacobians:local": Way(velocity, turned[1]),
        "point_jacobians:acceleration": Way(acceleration, _AT.format(of=_ACCELERATION.format(aligned, 3))),
        "point_velocities_dq": Way(velocity, _AT.format(of=_VELOCITY.format(aligned, 0))),
        "point_accelerations_dq": Way(acceleration, _AT.format(of=_ACCELERATION.format(aligned, 1))),
        "point_accelerations_dv": Way(acceleration, _AT.format(of=_ACCELERATION.format(aligned, 2))),
    }


_GIVEN = FIRST["applied_wrenches"].code[: FIRST["applied_wrenches"].code.index("value =")]
WAYS = (
    ways_of(f"""
== link_accelerations:getClassicalAcceleration | getClassicalAcceleration
{_FK}{_JOINTS.format(of="pin.getClassicalAcceleration(m, d, j, pin.LOCAL_WORLD_ALIGNED).vector")}
== link_accelerations:classicAcceleration | classicAcceleration
{_FK}js
value = np.array([[*(d.oMi[j].rotation @ pin.classicAcceleration(d.v[j], d.a[j])), *(d.oMi[j].rotation @ \
d.a[j].angular)] for j in js])
== jacobian_local:computeJointJacobian | computeJointJacobian
{_JOINTS.format(of="pin.computeJointJacobian(m, d, q, j)")}
== integrate_dq:dIntegrateTransport | dIntegrateTransport
value = pin.dIntegrateTransport(m, q, v2, np.eye(m.nv), pin.ARG0)
== integrate_dv:dIntegrateTransport | dIntegrateTransport
value = pin.dIntegrateTransport(m, q, v2, np.eye(m.nv), pin.ARG1)
== coordinate_rates:tangentMapTransposeProduct | tangentMapTransposeProduct
value = pin.tangentMapTransposeProduct(m, q, np.eye(m.nq)).T @ v
== inverse_dynamics:rneaInParallel | rneaInParallel
pool = pin.ModelPool(m, 2)
q2 = pin.neutral(m)
value = pin.rneaInParallel(2, pool, np.column_stack([q2, q]), np.column_stack([a, v]), np.column_stack([v, a]))[:, 1]
== forward_dynamics:abaInParallel | abaInParallel
pool = pin.ModelPool(m, 2)
q2 = pin.neutral(m)
value = pin.abaInParallel(2, pool, np.column_stack([q2, q]), np.column_stack([tau, v]), np.column_stack([v, tau]))[:, 1]
== bias:computeAllTerms | computeAllTerms: nle | {_TERMS.format(of="d.nle")}
== gravity:computeAllTerms | computeAllTerms: g | {_TERMS.format(of="d.g")}
== kinetic_energy:computeAllTerms | computeAllTerms: kinetic_energy | {_TERMS.format(of="d.kinetic_energy")}
== potential_energy:computeAllTerms | computeAllTerms: potential_energy | {_TERMS.format(of="d.potential_energy")}
== centroidal_momentum:computeAllTerms | computeAllTerms: hg | {_TERMS.format(of="d.hg.vector")}
== mass_centre_velocity:computeAllTerms | computeAllTerms: vcom | {_TERMS.format(of="d.vcom[0]")}
== link_regressors:frameBodyRegressor | frameBodyRegressor
pin.rnea(m, d, q, v, a)
value = [pin.frameBodyRegressor(m, d, f) for f in fs]
== link_regressors:bodyRegressor | bodyRegressor
pin.rnea(m, d, q, v, a)
{_JOINTS.format(of="pin.bodyRegressor(d.v[j], d.a_gf[j])")}
== applied_wrenches_dq | computeStaticTorqueDerivatives
{_GIVEN}still = pin.computeGeneralizedGravityDerivatives(m, d, q).copy()
value = still - pin.computeStaticTorqueDerivatives(m, d, q, pin.StdVec_Force(given))
== applied_wrenches_dq:computeRNEADerivatives | computeRNEADerivatives with external forces
{_GIVEN}still = pin.computeRNEADerivatives(m, d, q, 0 * v, 0 * v)[0].copy()
value = still - pin.computeRNEADerivatives(m, d, q, 0 * v, 0 * v, pin.StdVec_Force(given))[0]
""")
    | _points()
)
for _frame, _rf in FRAMES.items():
    WAYS |= _of_joints(_frame, _rf)
