"""Functions of a model's constraints: phi(q) = 0, G v = b, G v' = gamma."""

from __future__ import annotations

from typing import Literal

from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import ArrayLike, Functions


class ConstraintFunctions(Functions):
    """Methods of a model that tell of its constraints; arguments as in `Model`."""

    def constraint(
        self, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None, t: ArrayLike = 0.0
    ) -> Array:
        """Residual phi(q) of the constraints' positions (..., nc); zero for conditions on speeds."""
        return self._one("constraint", {"q": q, "u": u, "t": t}, par)

    def constraint_rate(
        self,
        q: ArrayLike,
        v: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> Array:
        """G v - b (..., nc): the rate of phi, and the residual of conditions on speeds."""
        return self._one("constraint_rate", {"q": q, "v": v, "u": u, "t": t}, par)

    def constraint_rate_derivative(
        self,
        q: ArrayLike,
        v: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> Array:
        """The derivative of G v - b by q (..., nc, nv); that by v is G."""
        return self._one("constraint_rate_derivative", {"q": q, "v": v, "u": u, "t": t}, par)

    def constraint_jacobian(
        self, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None, t: ArrayLike = 0.0
    ) -> Array:
        """Constraint Jacobian G(q) (..., nc, nv)."""
        return self._one("constraint_jacobian", {"q": q, "u": u, "t": t}, par)

    def constraint_bias(
        self,
        q: ArrayLike,
        v: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> Array:
        """Right-hand side gamma(q, v) of G v' = gamma (..., nc)."""
        return self._one("constraint_bias", {"q": q, "v": v, "u": u, "t": t}, par)

    def closure_wrench(
        self,
        name: str,
        q: ArrayLike,
        lam: ArrayLike,
        *,
        on: Literal["second", "first"] = "second",
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> Array:
        """What a constraint exerts on a frame: force and moment about its origin, in world axes (..., 6) [N, N m].

        Args:
            name: Name of a closure, rod, knife edge or rolling contact.
            q: Configuration (..., nq).
            lam: Multipliers of all conditions (..., nc), from `forward_dynamics`.
            on: Its second frame, the one that follows, or its first, the reference; of a knife edge or a rolling
                contact the second is the frame that touches, the first the world.
            u: Inputs, for prescribed motions.
            par: Run-time parameters.
            t: Time.

        The force on the second frame of a rod points to the first where the rod pulls: its size is the tension.
        """
        if name not in self.record.wrench_names:
            raise self._unknown(
                "constraint with a wrench",
                name,
                self.record.wrench_names,
                "conditions by formula have a generalized force G^T lam alone",
            )
        on_second, on_first = self._call("closure_wrenches", "", {"q": q, "lam": lam, "u": u, "t": t}, par)
        wrench: Array = (on_second if on == "second" else on_first)[..., self.record.wrench_names.index(name), :]
        return wrench

    def project(
        self,
        q: ArrayLike,
        v: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> tuple[Array, Array, Array]:
        """The nearest state that meets the constraints: q (..., nq), v (..., nv), and what is left of |phi| (...,).

        Newton's method on phi(q) = 0, then G v = b, each by the least change in the metric of M: for states that have
        drifted. It does not judge what it reaches; `sf.assemble` starts from afar, holds coordinates, and does.
        Conditions that repeat others are met by the same change; NaN where M and G determine none.
        """
        on_q, on_v, residual, *_ = self._call("project", "", {"q": q, "v": v, "u": u, "t": t}, par)
        return on_q, on_v, residual
