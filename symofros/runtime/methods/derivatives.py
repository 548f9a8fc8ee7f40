"""Derivatives of a model's functions, and its linearisation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import overload

import numpy as np

from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import ArrayLike
from symofros.runtime.methods import linear
from symofros.runtime.methods.frames import FrameFunctions
from symofros.runtime.methods.linear import FrameDerivatives, Output, StateMatrices
from symofros.runtime.methods.states import StateFunctions


class DerivativeFunctions(FrameFunctions, StateFunctions):
    """Methods of a model that differentiate; arguments as in `Model`.

    Those by q are along the manifold: column k is the change as q moves with speed k alone.
    """

    def inverse_dynamics_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array]:
        """The derivatives of `inverse_dynamics` by q and by v (..., nv, nv); that by a is M."""
        by_q, by_v = self._call(
            "inverse_dynamics_derivatives",
            "",
            {"q": q, "v": v if z is None else self._with_states(v, z), "a": a, "u": u, "t": t},
            par,
        )
        return by_q, by_v

    def forward_dynamics_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array, Array]:
        """The derivatives of `forward_dynamics` by q, v (..., nv, nv) and u (..., nv, nu), constraints kept.

        Of a quaternion among u they hold for changes that are perpendicular to it (docs/theory/linear.md, section 9).
        """
        by_q, by_v, by_u = self._call(
            "forward_dynamics_derivatives",
            "",
            {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t},
            par,
        )
        return by_q[..., : self.nv, :], by_v[..., : self.nv, :], by_u[..., : self.nv, :]

    def inverse_dynamics_by_par(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> Array:
        """The derivative of `inverse_dynamics` by the run-time parameters (..., nv, npar)."""
        return self._one(
            "inverse_dynamics_by_par",
            {"q": q, "v": v if z is None else self._with_states(v, z), "a": a, "u": u, "t": t},
            par,
        )

    def forward_dynamics_by_par(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> Array:
        """The derivative of `forward_dynamics` by the run-time parameters (..., nv, npar), constraints kept.

        At the given state: where a parameter changes the constraints themselves, the state does not follow.
        """
        return self._one(
            "forward_dynamics_by_par", {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t}, par
        )[..., : self.nv, :]

    @overload
    def linearize(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        outputs: None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array]: ...
    @overload
    def linearize(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        outputs: Sequence[Output],
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> StateMatrices: ...
    def linearize(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        outputs: Sequence[Output] | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array] | StateMatrices:
        """A (..., 2 nv, 2 nv) and B (..., 2 nv, nu) of the state's small changes: x' = A x + B u.

        With outputs C (..., p, 2 nv) and D (..., p, nu) as well: y = C x + D u.
        x = (difference of q along the manifold, difference of v). Exact: differentiated on the graph. On constraints
        only some x are possible: `sf.state_space` keeps those. Of u, changes of a quaternion are perpendicular to it.

        Args:
            q: Configuration (..., nq).
            v: Speeds (..., nv).
            u: Inputs (..., nu).
            outputs: What y stacks, in order: "q", "v", "a" (nv rows each), "lam" (nc), and ("frame_pose", frame),
                ("frame_velocity", frame), ("frame_acceleration", frame) of 6 rows in world axes, linear part first;
                of a pose the change of the origin and the small rotation.
            par: Run-time parameters.
            t: Time.
            z: States of forces (..., nz); with some, x = (difference of q, of v, of z), and "z" (nz rows) is an output.

        Raises:
            UnknownNameError: No such output or frame.
        """
        slopes = self._call(
            "forward_dynamics_derivatives",
            "",
            {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t},
            par,
        )
        if self.record.sticking:
            self._warn_of_smooth_friction(v, par)
        speeds = np.asarray(self.by_name("v", v), dtype=np.float64)
        if outputs is None:
            return linear.state_matrices(self.record.segments, slopes, speeds)

        def frame_derivatives(frame: str) -> FrameDerivatives:
            given = {"q": q, "v": v, "u": u, "t": t, "gains": np.zeros(2 * self.nc)}
            a = self._call("forward_dynamics", "", given, par)[0]
            return self.frame_derivatives(frame, q, v, a, u=u, par=par)

        return linear.linearize(self.record.segments, slopes, speeds, outputs, frame_derivatives)

    def residual_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        u: ArrayLike,
        lam: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> list[Array]:
        """Derivatives of R = (M a + h - Q - G^T lam; G a - gamma) by q, v and u (..., nv + nc, nv or nu)."""
        return self._call(
            "residual_derivatives",
            "",
            {"q": q, "v": v if z is None else self._with_states(v, z), "a": a, "u": u, "lam": lam, "t": t},
            par,
        )
