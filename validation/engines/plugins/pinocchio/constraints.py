"""Pinocchio's constraints: rigid ones with their dynamics, impacts and derivatives, and the anchors of Pinocchio 4."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from ...interface import Constraint, End
from ..writing.source import Way, ways_of

KINDS = {"point": "RigidConstraintModel, CONTACT_3D", "weld": "RigidConstraintModel, CONTACT_6D"}
_TYPES = {"point": "CONTACT_3D", "weld": "CONTACT_6D"}
_ANCHORS = {"point": "PointAnchorConstraintModel", "weld": "FrameAnchorConstraintModel"}

# Where an end stands: variable of its joint, placement there.
Place = Callable[[End], tuple[str, str]]


def optional(constraints: tuple[Constraint, ...], place: Place) -> Mapping[str, tuple[str, ...]]:
    """Statements that define the constraints of a tree: `cm` the rigid ones, `am` the anchors."""
    if not constraints:
        return {}
    rigid = [
        f"pin.RigidConstraintModel(pin.ContactType.{one}, pin.LOCAL)" for one in _calls(constraints, place, _TYPES)
    ]
    anchors = [f"pin.ConstraintModel(pin.{one})" for one in _calls(constraints, place, _ANCHORS)]
    return {
        "cm": (f"cm = pin.StdVec_RigidConstraintModel([{', '.join(rigid)}])",),
        "am": (f"am = pin.StdVec_ConstraintModel([{', '.join(anchors)}])",),
    }


def _calls(constraints: tuple[Constraint, ...], place: Place, names: Mapping[str, str]) -> Iterator[str]:
    for one in constraints:
        (joint, X), (joint2, X2) = (place(end) for end in one.ends)
        name = names[one.kind]
        yield (
            f"{name}, m, {joint}, {X}, {joint2}, {X2}"
            if name in _TYPES.values()
            else f"{name}(m, {joint}, {X}, {joint2}, {X2})"
        )


_DATA = "cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])\n"
_SOLVED = f"{_DATA}ps = pin.ProximalSettings(1e-14, 1e-12, 20)\npin.initConstraintDynamics(m, d, cm, cd)\n"
_DYNAMICS = f"{_SOLVED}value = pin.constraintDynamics(m, d, q, v, tau, cm, cd, ps)\n"
_IMPACT = f"{_SOLVED}value = pin.impulseDynamics(m, d, q, v2, cm, cd, "
_PLACED = f"{_DATA}pin.computeJointJacobians(m, d, q)\nfor one, data in zip(cm, cd): one.calc(m, d, data)\n"
_JACOBIAN = f"{_PLACED}J = pin.getConstraintsJacobian(m, d, cm, cd)\n"
_CHOLESKY = (
    f"{_DATA}pin.crba(m, d, q, pin.Convention.WORLD)\n"
    "for one, data in zip(cm, cd): one.calc(m, d, data)\n"
    "C = pin.ContactCholeskyDecomposition(m, d, cm, cd)\nC.compute(m, d, cm, cd, 1e-12)\n"
)
_DERIVATIVES = f"{_DYNAMICS}value = pin.computeConstraintDynamicsDerivatives(m, d, cm, cd, ps)"
# With its own regularisation, 1e-6, and accuracy: what the proximal steps leave.
_PROXIMAL = 1e-8
# The inverse is what is left of 1 by a difference: as its note says, damping and what it scales by lose their digits.
_DAMPED = 1e-7
# What mu = 1e-12 makes of a matrix whose entries are of order one, or of its inverse.
_REGULAR = 1e-9

WAYS = ways_of(f"""
== constraint_jacobian | getConstraintsJacobian | {_JACOBIAN}value = J
== constraint_jacobian:anchors | getConstraintsJacobian of anchors
ad = pin.StdVec_ConstraintData([one.createData() for one in am])
pin.computeJointJacobians(m, d, q)
for one, data in zip(am, ad): one.calc(m, d, data)
value = -pin.getConstraintsJacobian(m, d, am, ad)
== delassus | computeDelassusMatrix | {_DATA}value = pin.computeDelassusMatrix(m, d, q, cm, cd, 0.0)
== delassus:ContactCholesky ~ {_REGULAR} | getInverseOperationalSpaceInertiaMatrix
{_CHOLESKY}value = C.getInverseOperationalSpaceInertiaMatrix()
== delassus_inverse_damped ~ {_DAMPED} | computeDampedDelassusMatrixInverse
{_DATA}value = pin.computeDampedDelassusMatrixInverse(m, d, q, cm, cd, 1e-4, True) / 1e-4
== delassus_inverse ~ {_REGULAR} | getOperationalSpaceInertiaMatrix
{_CHOLESKY}value = C.getOperationalSpaceInertiaMatrix()
== kkt_inverse | computeKKTContactDynamicMatrixInverse
{_JACOBIAN}value = pin.computeKKTContactDynamicMatrixInverse(m, d, q, J, 0.0)
== kkt_inverse:ContactCholesky ~ {_REGULAR} | ContactCholeskyDecomposition.inverse
{_CHOLESKY}value = np.roll(C.inverse(), (m.nv, m.nv), (0, 1))
== constrained_acceleration | constraintDynamics | {_DYNAMICS}
== constrained_acceleration:proximal ~ {_PROXIMAL} | constraintDynamics, mu = 1e-6
{_SOLVED}ps = pin.ProximalSettings(1e-13, 1e-6, 100)
value = pin.constraintDynamics(m, d, q, v, tau, cm, cd, ps)
== constrained_acceleration:lcaba ~ {_PROXIMAL} | lcaba, mu = 1e-6
{_SOLVED}ps = pin.ProximalSettings(1e-13, 1e-6, 100)
pin.computeJointMinimalOrdering(m, d, cm)
value = pin.lcaba(m, d, q, v, tau, cm, cd, ps)
== constraint_forces | constraintDynamics: lambda_c | {_DYNAMICS}value = d.lambda_c
== impact_velocity ~ {_REGULAR} | impulseDynamics | {_IMPACT}0.0, ps)
== impact_velocity_rebound ~ {_REGULAR} | impulseDynamics | {_IMPACT}0.5, ps)
== impact_velocity:forms ~ {_REGULAR} | impulseDynamics of a Jacobian
{_JACOBIAN}value = pin.impulseDynamics(m, d, q, v2, J, 0.0, 1e-12)
== impulses ~ {_REGULAR} | impulseDynamics: impulse_c | {_IMPACT}0.0, ps)\nvalue = d.impulse_c
== impact_velocity_dq ~ {_REGULAR} | computeImpulseDynamicsDerivatives
{_IMPACT}0.0, ps)
pin.computeImpulseDynamicsDerivatives(m, d, cm, cd, 0.0, ps)
value = d.ddq_dq
== impulses_dq ~ {_REGULAR} | computeImpulseDynamicsDerivatives
{_IMPACT}0.0, ps)
pin.computeImpulseDynamicsDerivatives(m, d, cm, cd, 0.0, ps)
value = d.dlambda_dq
""")
for _number, _name in enumerate(("dq", "dv", "dtau")):
    _native = "computeConstraintDynamicsDerivatives"
    WAYS[f"constrained_acceleration_{_name}"] = Way(_native, f"{_DERIVATIVES}[{_number}]")
    WAYS[f"constraint_forces_{_name}"] = Way(_native, f"{_DERIVATIVES}[{_number + 3}]")

# Anchors have the other sign; their decomposition and its operators say the same of both.
_ANCHORED = (
    "ad = pin.StdVec_ConstraintData([one.createData() for one in am])\n"
    "pin.crba(m, d, q, pin.Convention.WORLD)\nfor one, data in zip(am, ad): one.calc(m, d, data)\n"
)
_DECOMPOSED = (
    f"{_ANCHORED}C = pin.ConstraintCholeskyDecomposition(m, d, am, ad)\nC.compute(m, d, am, ad, 1e-12)\n"
    "G = C.getDelassusOperatorCholeskyExpression()\n"
)
# Accelerations without the constraints, and what these make of them: J a + J' v.
_APART = (
    f"{_DYNAMICS}bound = value.copy()\nfree = pin.aba(m, d, q, v, tau).copy()\n{_PLACED}"
    "J = pin.getConstraintsJacobian(m, d, cm, cd)\ng = J @ (free - bound)\n"
)
WAYS |= ways_of(f"""
== constraint_jacobian:jacobianMatrixProduct | jacobianMatrixProduct
{_ANCHORED}value = -np.vstack([one.jacobianMatrixProduct(m, d, data, np.eye(m.nv)) for one, data in zip(am, ad)])
== constraint_jacobian:jacobianTransposeMatrixProduct | jacobianTransposeMatrixProduct
{_ANCHORED}value = -np.hstack([one.jacobianTransposeMatrixProduct(m, d, data, np.eye(one.residualSize())) for one, \
data in zip(am, ad)]).T
== constraint_jacobian:jacobian | jacobian
{_ANCHORED}value = -np.vstack([one.jacobian(m, d, data) for one, data in zip(am, ad)])
== constraint_jacobian:getConstraintJacobian | getConstraintJacobian
{_PLACED}value = np.vstack([pin.getConstraintJacobian(m, d, one, data) for one, data in zip(cm, cd)])
== delassus:anchors ~ {_REGULAR} | ConstraintCholeskyDecomposition
{_DECOMPOSED}value = C.getInverseOperationalSpaceInertiaMatrix()
== delassus:operator ~ {_REGULAR} | DelassusOperatorCholeskyExpression.matrix | {_DECOMPOSED}value = G.matrix()
== delassus_inverse:anchors ~ {_REGULAR} | ConstraintCholeskyDecomposition
{_DECOMPOSED}value = C.getOperationalSpaceInertiaMatrix()
== delassus_inverse:operator ~ {_REGULAR} | DelassusOperatorCholeskyExpression.solve
{_DECOMPOSED}value = G.solve(np.eye(G.size()))
== constrained_acceleration:forwardDynamics | forwardDynamics
{_APART}value = pin.forwardDynamics(m, d, q, v, tau, J, -J @ bound, 0.0)
== constraint_forces:forwardDynamics | forwardDynamics: lambda_c
{_APART}pin.forwardDynamics(m, d, q, v, tau, J, -J @ bound, 0.0)
value = d.lambda_c
== kkt_inverse:getKKTContactDynamicMatrixInverse | forwardDynamics, getKKTContactDynamicMatrixInverse
{_APART}pin.forwardDynamics(m, d, q, v, tau, J, -J @ bound, 0.0)
value = pin.getKKTContactDynamicMatrixInverse(m, d, J)
""")

# Points and welds along the world's axes: where they hold, accelerations, speeds and their derivatives are the same.
_ALIGNED = (("pin.LOCAL)", "pin.LOCAL_WORLD_ALIGNED)"),)
_KEPT = (
    "value = np.concatenate([one.contact_force.vector[: 3 if c.type == pin.ContactType.CONTACT_3D else 6]"
    " for one, c in zip(cd, cm)])"
)
WAYS |= {
    f"{name}:aligned": WAYS[name]._replace(native=f"{WAYS[name].native}, LOCAL_WORLD_ALIGNED", built=_ALIGNED)
    for name in (
        "constrained_acceleration",
        "impact_velocity",
        "impact_velocity_rebound",
        "constrained_acceleration_dtau",
    )
}
WAYS |= {
    f"{name}:data": Way(f"data.{kept}", f"{_DERIVATIVES}\nvalue = d.{kept}")
    for name, kept in {
        "constrained_acceleration": "ddq",
        "constrained_acceleration_dv": "ddq_dv",
        "constrained_acceleration_dtau": "ddq_dtau",
        "constraint_forces_dv": "dlambda_dv",
        "constraint_forces_dtau": "dlambda_dtau",
    }.items()
} | {
    "constraint_forces:contact_force": Way("RigidConstraintData.contact_force", f"{_DYNAMICS}{_KEPT}"),
    "impact_velocity:dq_after": Way("data.dq_after", f"{_IMPACT}0.0, ps)\nvalue = d.dq_after", _REGULAR),
}
