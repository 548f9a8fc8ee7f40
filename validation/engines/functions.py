"""What engines are asked for: one row a function, with its truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from validation.engines.arithmetic import Exact
from validation.engines.truth import Point, Truth


@dataclass(frozen=True)
class Function:
    """One function of a tree and a state.

    Attributes:
        text: What it is, with shape and conventions.
        truth: Its value in many digits.
    """

    text: str
    truth: Callable[[Truth, Point], Exact]


FUNCTIONS: dict[str, Function] = {
    "mass_matrix": Function("M (nv, nv)", lambda t, s: t.M(s.q)),
    "bias": Function("h (nv): Coriolis, centrifugal and gravity forces", lambda t, s: t.h(s.q, s.v)),
    "gravity": Function("g (nv): gravity forces", lambda t, s: t.g(s.q)),
    "inverse_dynamics": Function("M a + h (nv)", lambda t, s: t.ID(s.q, s.v, s.a)),
    "forward_dynamics": Function("M^-1 (tau - h) (nv)", lambda t, s: t.FD(s.q, s.v, s.tau)),
    "kinetic_energy": Function("v^T M v / 2", lambda t, s: t.T(s.q, s.v)),
    "potential_energy": Function("-sum m g^T p", lambda t, s: t.V(s.q)),
    "mass_matrix_inverse": Function("M^-1 (nv, nv)", lambda t, s: t.inverse(s.q)),
}
