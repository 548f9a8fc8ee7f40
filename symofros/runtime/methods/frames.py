"""Functions of a model's frames, in world axes, linear part first."""

from __future__ import annotations

from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import ArrayLike, Functions
from symofros.runtime.methods.linear import FrameDerivatives


class FrameFunctions(Functions):
    """Methods of a model that tell of its frames; arguments as in `Model`."""

    def frame_pose(
        self, frame: str, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Position p_WF (..., 3) and rotation R_WF (..., 3, 3)."""
        p, R = self._call("frame_pose", self._frame(frame), {"q": q, "u": u}, par)
        return p, R

    def frame_velocity(
        self, frame: str, q: ArrayLike, v: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """Velocity of the frame's origin and angular velocity (..., 6)."""
        return self._call("frame_velocity", self._frame(frame), {"q": q, "v": v, "u": u}, par)[0]

    def frame_acceleration(
        self,
        frame: str,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
    ) -> Array:
        """The rate of `frame_velocity` when v' = a (..., 6)."""
        return self._call("frame_acceleration", self._frame(frame), {"q": q, "v": v, "a": a, "u": u}, par)[0]

    def frame_jacobian(
        self, frame: str, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """Jacobian J (..., 6, nv) with frame_velocity = J v."""
        return self._call("frame_jacobian", self._frame(frame), {"q": q, "u": u}, par)[0]

    def frame_derivatives(
        self,
        frame: str,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
    ) -> FrameDerivatives:
        """The derivatives of the frame's pose, velocity and acceleration by q, v and u; by a the last has J."""
        given = {"q": q, "v": v, "a": a, "u": u}
        return FrameDerivatives(*self._call("frame_derivatives", self._frame(frame), given, par))

    def frame_jacobian_rate(
        self, frame: str, q: ArrayLike, v: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """Rate dJ/dt of the Jacobian (..., 6, nv), so that frame_acceleration = J a + dJ/dt v."""
        return self._call("frame_jacobian_rate", self._frame(frame), {"q": q, "v": v, "u": u}, par)[0]
