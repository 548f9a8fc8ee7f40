"""Functions of trees with constraints."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ..tree import SOFT_LIMITS
from ..truth import constraints
from ..truth.acting import soft
from ..truth.arithmetic import Exact, exact
from ..truth.dynamics import Point, Truth
from .function import Function, functions_of


def _at_rest(t: Truth, s: Point) -> Exact:
    return np.concatenate([s.q, 0 * s.v])


def _constrained() -> dict[str, Function]:
    """Functions of trees with constraints."""
    half = Decimal(1) / 2
    rows: dict[str, Function] = {
        "constraint_jacobian": Function(
            "J (m, nv): velocity of a constraint's first frame against the second, along the first's axes",
            lambda t, s: constraints.jacobian(t, s.q),
        ),
        "constraint_velocity_products": Function("J' v (m)", lambda t, s: constraints.products(t, s.q, s.v)),
        "constraint_residuals": Function(
            "violations of constraints at q2 (m): points' distance along world axes; vector part of the quaternion "
            "that turns the second frame into the first, in the second; lengths less those at zero",
            lambda t, s: constraints.residuals(t, s.q2),
        ),
        "constraint_residual_products": Function(
            "second time derivative of constraint_residuals at q2 and v, with v kept (m)",
            lambda t, s: constraints.residual_products(t, s.q2, s.v),
        ),
        "constraint_points": Function(
            "both frames' origins of constraints by points, in their links (n, 6)",
            lambda t, s: exact(np.array([[x for end in one.ends for x in end.p] for one in t.tree.constraints])),
            ("points by bodies",),
        ),
        "step_at_rest": Function("q, v (nq + nv) after a step at rest, without gravity and forces", _at_rest),
        "delassus": Function("J M^-1 J^T (m, m)", lambda t, s: constraints.delassus(t, s.q)),
        "delassus_inverse": Function(
            "(J M^-1 J^T)^-1 (m, m)",
            lambda t, s: constraints.delassus_inverse(t, s.q),
        ),
        "delassus_inverse_damped": Function(
            "(J M^-1 J^T + 1e-4)^-1 (m, m)", lambda t, s: constraints.delassus_inverse(t, s.q, 1e-4)
        ),
        "kkt_inverse": Function("inverse of [[M, J^T], [J, 0]] (nv + m, nv + m)", constraints.kkt_inverse),
        "constrained_acceleration": Function(
            "a (nv): M a + h = tau + J^T f, J a + J' v = 0", lambda t, s: constraints.acceleration(t, s.q, s.v, s.tau)
        ),
        "constraint_forces": Function(
            "f (m): M a + h = tau + J^T f, J a + J' v = 0", lambda t, s: constraints.forces(t, s.q, s.v, s.tau)
        ),
        "constrained_inverse": Function(
            "forces (nv) that inverse dynamics find at the acceleration that tau makes: tau", lambda t, s: s.tau
        ),
        "impact_velocity": Function(
            "speeds after impact (nv): M (v+ - v2) = J^T impulse, J v+ = 0",
            lambda t, s: constraints.after_impact(t, s.q, s.v2, 0 * half),
        ),
        "impact_velocity_rebound": Function(
            "speeds after impact (nv): M (v+ - v2) = J^T impulse, J v+ = -J v2 / 2",
            lambda t, s: constraints.after_impact(t, s.q, s.v2, half),
        ),
        "impulses": Function(
            "impulse (m): M (v+ - v2) = J^T impulse, J v+ = 0", lambda t, s: constraints.impulses(t, s.q, s.v2)
        ),
        "impact_velocity_dq": Function(
            "derivative of the speeds after impact by q (nv, nv)",
            lambda t, s: t.kinematics.tangent(lambda q: constraints.after_impact(t, q, s.v2, 0 * half), s.q),
        ),
        "impulses_dq": Function(
            "derivative of the impulses by q (m, nv)",
            lambda t, s: t.kinematics.tangent(lambda q: constraints.impulses(t, q, s.v2), s.q),
        ),
    }
    for name, of in (("constrained_acceleration", constraints.acceleration), ("constraint_forces", constraints.forces)):
        rows |= _derivatives(name, of)
    return rows


def _derivatives(name: str, of: Callable[[Truth, Exact, Exact, Exact], Exact]) -> dict[str, Function]:
    """Derivatives of a function of coordinates, speeds and forces."""
    what = f"derivative of {name.replace('_', ' ')} by"
    return {
        f"{name}_dq": Function(f"{what} q", lambda t, s: t.kinematics.tangent(lambda q: of(t, q, s.v, s.tau), s.q)),
        f"{name}_dv": Function(f"{what} v", lambda t, s: t.along_speeds(lambda v: of(t, s.q, v, s.tau), s.v)),
        f"{name}_dtau": Function(f"{what} tau", lambda t, s: t.along_speeds(lambda tau: of(t, s.q, s.v, tau), s.tau)),
    }


def _limited() -> dict[str, Function]:
    """Functions of trees whose limits and dry friction act (`soft`)."""
    rows = {
        "limited_acceleration": ("accelerations (nv)", soft.acceleration),
        "limiting_forces": ("generalized forces of limits and dry friction (nv)", soft.forces),
        "floor_forces": ("what each floor does to its ball (n)", soft.floor_forces),
        "limited_inverse": ("forces (nv) that inverse dynamics find at these accelerations: tau", lambda t, s: s.tau),
    }
    return functions_of(rows, SOFT_LIMITS)


CONSTRAINED = _constrained() | _limited()
