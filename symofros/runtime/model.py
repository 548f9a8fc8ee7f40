"""Model: a compiled mechanism in the hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

from symofros.errors import Problem, ShapeError, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime import linear, manifold
from symofros.runtime.kernel import Array, Kernel, Unit
from symofros.runtime.record import ModelRecord

Given = npt.ArrayLike
Key = tuple[str, str]


@dataclass(frozen=True)
class Names:
    """Names of coordinates, speeds, inputs, run-time parameters, frames and constraints, in order."""

    q: tuple[str, ...]
    v: tuple[str, ...]
    u: tuple[str, ...]
    par: tuple[str, ...]
    frames: tuple[str, ...]
    constraints: tuple[str, ...]


class Model:
    """The equations of one mechanism, ready to be evaluated.

    Every function takes float64 arrays with any leading batch dimensions, broadcasts them, and returns new arrays.
    `par=` overrides the run-time parameters (..., npar), `t=` gives the time (...,) to models that depend on it; `u=`
    matters where a motion is prescribed, because its coordinates, speeds and their rates are inputs.
    NaN in an argument propagates to what depends on it, so that one bad state does not spoil its batch.
    Methods raise ShapeError where an array does not fit and UnknownNameError for a name that is not in the model.
    Functions may be called from several threads; C runs without the interpreter lock.

    Args:
        record: Sizes, names, defaults.
        build: Generates and compiles functions by key; None where all there is has been built.
        units: Functions built already.
        par: Values of the run-time parameters; None for the defaults.
    """

    def __init__(
        self,
        record: ModelRecord,
        build: Callable[[tuple[Key, ...]], Unit] | None,
        units: tuple[Unit, ...] = (),
        par: Array | None = None,
    ) -> None:
        self.record = record
        self._build = build
        self._par = np.array(record.par_default if par is None else par, dtype=np.float64)
        self._par.flags.writeable = False
        self._kernels: dict[Key, Kernel] = {key: kernel for unit in units for key, kernel in unit.kernels.items()}
        self._prepared: dict[Key, Array] = {}
        self.names = Names(
            record.q_names, record.v_names, record.u_names, record.par_names, record.frame_names,
            record.constraint_names,
        )  # fmt: skip

    def __repr__(self) -> str:
        """Name and sizes."""
        return f"Model({self.record.name!r}, nq={self.nq}, nv={self.nv}, nu={self.nu}, npar={self.npar}, nc={self.nc})"

    @property
    def nq(self) -> int:
        """Number of coordinates."""
        return len(self.record.q_names)

    @property
    def nv(self) -> int:
        """Number of speeds."""
        return len(self.record.v_names)

    @property
    def nu(self) -> int:
        """Number of inputs."""
        return len(self.record.u_names)

    @property
    def npar(self) -> int:
        """Number of run-time parameters."""
        return len(self.record.par_names)

    @property
    def nc(self) -> int:
        """Number of constraints."""
        return self.record.nc

    @property
    def parameters(self) -> Mapping[str, float]:
        """Name -> value of the run-time parameters."""
        return MappingProxyType(dict(zip(self.record.par_names, self._par.tolist(), strict=True)))

    def with_parameters(self, **values: float) -> Model:
        """The same compiled code with other parameter values.

        Raises:
            UnknownNameError: No such run-time parameter.
            ValueError: A value is not a finite number.
        """
        par = self._par.copy()
        for name, value in values.items():
            if name not in self.record.par_names:
                raise self._unknown("run-time parameter", name, self.record.par_names,
                                    "constants are hard-coded: change them in the description")  # fmt: skip
            par[self.record.par_names.index(name)] = self._finite(name, value)
        other = Model(self.record, self._build, (), par)
        other._kernels = self._kernels  # Shared, so that what either compiles serves both.
        return other

    # Configurations.

    def neutral(self) -> Array:
        """A valid configuration (nq): zeros, and quaternions of no rotation."""
        return np.array(self.record.q_neutral)

    def random_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """A random q (nq) on the manifold, within the limits, and v (nv)."""
        return manifold.random_state(self.record, rng)

    def integrate(self, q: Given, dq: Given) -> Array:
        """Move from q (..., nq) along the manifold by dq (..., nv), a velocity times a time."""
        return manifold.integrate(self.record, self._array("q", q, self.nq), self._array("dq", dq, self.nv))

    def difference(self, q0: Given, q1: Given) -> Array:
        """The dq (..., nv) that leads from q0 to q1 (..., nq)."""
        return manifold.difference(self.record, self._array("q0", q0, self.nq), self._array("q1", q1, self.nq))

    # Dynamics: M(q) v' + h(q, v) = Q(q, v, u).

    def mass_matrix(self, q: Given, *, u: Given | None = None, par: Given | None = None) -> Array:
        """M(q) (..., nv, nv)."""
        return self._one("mass_matrix", {"q": q, "u": u}, par)

    def bias(self, q: Given, v: Given, *, u: Given | None = None, par: Given | None = None) -> Array:
        """h(q, v) (..., nv): Coriolis, centrifugal and gravity terms."""
        return self._one("bias", {"q": q, "v": v, "u": u}, par)

    def generalized_force(self, q: Given, v: Given, u: Given, *, par: Given | None = None, t: Given = 0.0) -> Array:
        """Q(q, v, u) (..., nv): applied and joint forces."""
        return self._one("generalized_force", {"q": q, "v": v, "u": u, "t": t}, par)

    def dynamics(
        self, q: Given, v: Given, u: Given, *, par: Given | None = None, t: Given = 0.0
    ) -> tuple[Array, Array, Array]:
        """M (..., nv, nv), h (..., nv) and Q (..., nv) in one call."""
        M, h, Q = self._call("dynamics", "", {"q": q, "v": v, "u": u, "t": t}, par)
        return M, h, Q

    @overload
    def forward_dynamics(
        self,
        q: Given,
        v: Given,
        u: Given,
        *,
        par: Given | None = None,
        t: Given = 0.0,
        gains: Given | None = None,
        multipliers: Literal[False] = False,
    ) -> Array: ...
    @overload
    def forward_dynamics(
        self,
        q: Given,
        v: Given,
        u: Given,
        *,
        par: Given | None = None,
        t: Given = 0.0,
        gains: Given | None = None,
        multipliers: Literal[True],
    ) -> tuple[Array, Array]: ...
    def forward_dynamics(
        self,
        q: Given,
        v: Given,
        u: Given,
        *,
        par: Given | None = None,
        t: Given = 0.0,
        gains: Given | None = None,
        multipliers: bool = False,
    ) -> Array | tuple[Array, Array]:
        """The v' (..., nv) that the forces produce, constraints kept.

        Args:
            q: Configuration (..., nq).
            v: Speeds (..., nv).
            u: Inputs (..., nu).
            par: Run-time parameters (..., npar).
            t: Time (...,).
            gains: Baumgarte's (alpha, beta) for all constraints, or (..., 2 nc): alpha of each, then beta of each
                [1/s]; none: accelerations only, so that errors of phi and G v drift.
            multipliers: Whether to return lam (..., nc) as well: G^T lam are the constraint forces.
        """
        a, lam, _ = self.constrained_dynamics(q, v, u, par=par, t=t, gains=gains)
        return (a, lam) if multipliers else a

    def constrained_dynamics(
        self, q: Given, v: Given, u: Given, *, par: Given | None = None, t: Given = 0.0, gains: Given | None = None
    ) -> tuple[Array, Array, Array]:
        """V' (..., nv), multipliers (..., nc) and the rank of G (...,).

        Conditions that repeat others leave v' as it is and get multipliers of least norm; ones that contradict each
        other are met in the sense of least squares. A rank of -1 marks a state that has no acceleration (NaN).
        """
        given = {"q": q, "v": v, "u": u, "t": t, "gains": self._gains(gains)}
        found = self._call("forward_dynamics", "", given, par)
        if len(found) == 1:
            batch = found[0].shape[:-1]
            return found[0], np.zeros((*batch, 0)), np.zeros(batch)
        a, lam, rank = found
        return a, lam, rank

    def _gains(self, gains: Given | None) -> Given:
        if gains is None:
            return np.zeros(2 * self.nc)
        given = np.asarray(gains, dtype=np.float64)
        return np.repeat(given, self.nc, axis=-1) if given.shape == (2,) else given

    # Derivatives. Those by q are along the manifold: column k is the change as q moves with speed k alone.

    def inverse_dynamics_derivatives(
        self, q: Given, v: Given, a: Given, *, u: Given | None = None, par: Given | None = None, t: Given = 0.0
    ) -> tuple[Array, Array]:
        """The derivatives of `inverse_dynamics` by q and by v (..., nv, nv); that by a is M."""
        by_q, by_v = self._call("inverse_dynamics_derivatives", "", {"q": q, "v": v, "a": a, "u": u, "t": t}, par)
        return by_q, by_v

    def forward_dynamics_derivatives(
        self, q: Given, v: Given, u: Given, *, par: Given | None = None, t: Given = 0.0
    ) -> tuple[Array, Array, Array]:
        """The derivatives of `forward_dynamics` by q, v (..., nv, nv) and u (..., nv, nu), constraints kept."""
        found = linear.accelerations(self, q, v, u, par=par, t=t)
        return found.by_q, found.by_v, found.by_u

    def linearize(
        self, q: Given, v: Given, u: Given, *, par: Given | None = None, t: Given = 0.0
    ) -> tuple[Array, Array]:
        """A (..., 2 nv, 2 nv) and B (..., 2 nv, nu) of the state's small changes: x' = A x + B u.

        x = (difference of q along the manifold, difference of v). Exact: differentiated on the graph.
        """
        return linear.state_matrices(self, q, v, u, par=par, t=t)

    def residual_derivatives(
        self, q: Given, v: Given, a: Given, u: Given, lam: Given, *, par: Given | None = None, t: Given = 0.0
    ) -> list[Array]:
        """Of R = (M a + h - Q - G^T lam; G a - gamma) by q, v and u, and of G v - b by q."""
        return self._call("residual_derivatives", "", {"q": q, "v": v, "a": a, "u": u, "lam": lam, "t": t}, par)

    def regressor(self, q: Given, v: Given, a: Given, *, u: Given | None = None, par: Given | None = None) -> Array:
        """Y (..., nv, 10 links) with M a + h = Y pi, for the links' inertial parameters pi.

        Ten a link, in the order of the tree: m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin of its body
        frame, along its axes; what is fixed to a body counts with it. Rotors, armatures and beams are not in pi.
        """
        return self._one("regressor", {"q": q, "v": v, "a": a, "u": u}, par)

    # Constraints: phi(q) = 0, G v = b, G v' = gamma.

    def constraint(self, q: Given, *, u: Given | None = None, par: Given | None = None, t: Given = 0.0) -> Array:
        """Phi(q) (..., nc); zero for conditions on speeds."""
        return self._one("constraint", {"q": q, "u": u, "t": t}, par)

    def constraint_rate(
        self, q: Given, v: Given, *, u: Given | None = None, par: Given | None = None, t: Given = 0.0
    ) -> Array:
        """G v - b (..., nc): the rate of phi, and the residual of conditions on speeds."""
        return self._one("constraint_rate", {"q": q, "v": v, "u": u, "t": t}, par)

    def constraint_jacobian(
        self, q: Given, *, u: Given | None = None, par: Given | None = None, t: Given = 0.0
    ) -> Array:
        """G(q) (..., nc, nv)."""
        return self._one("constraint_jacobian", {"q": q, "u": u, "t": t}, par)

    def constraint_bias(
        self, q: Given, v: Given, *, u: Given | None = None, par: Given | None = None, t: Given = 0.0
    ) -> Array:
        """Gamma(q, v) (..., nc): what G v' equals."""
        return self._one("constraint_bias", {"q": q, "v": v, "u": u, "t": t}, par)

    def inverse_dynamics(
        self, q: Given, v: Given, a: Given, *, u: Given | None = None, par: Given | None = None, t: Given = 0.0
    ) -> Array:
        """M a + h - Q(q, v, 0) (..., nv): what the inputs must supply for v' = a; of u, only motions count."""
        return self._one("inverse_dynamics", {"q": q, "v": v, "a": a, "u": u, "t": t}, par)

    def kinetic_energy(self, q: Given, v: Given, *, u: Given | None = None, par: Given | None = None) -> Array:
        """Kinetic energy (...,) [J]."""
        return self._one("kinetic_energy", {"q": q, "v": v, "u": u}, par)

    def potential_energy(self, q: Given, *, u: Given | None = None, par: Given | None = None, t: Given = 0.0) -> Array:
        """Potential energy (...,) [J]: of the weight, zero for mass at the world origin, and of springs."""
        return self._one("potential_energy", {"q": q, "u": u, "t": t}, par)

    # Frames, in world axes; linear part first.

    def frame_pose(
        self, frame: str, q: Given, *, u: Given | None = None, par: Given | None = None
    ) -> tuple[Array, Array]:
        """p_WF (..., 3) and R_WF (..., 3, 3)."""
        p, R = self._call("frame_pose", self._frame(frame), {"q": q, "u": u}, par)
        return p, R

    def frame_velocity(
        self, frame: str, q: Given, v: Given, *, u: Given | None = None, par: Given | None = None
    ) -> Array:
        """Velocity of the frame's origin and angular velocity (..., 6)."""
        return self._one("frame_velocity", {"q": q, "v": v, "u": u}, par, frame)

    def frame_acceleration(
        self, frame: str, q: Given, v: Given, a: Given, *, u: Given | None = None, par: Given | None = None
    ) -> Array:
        """The rate of `frame_velocity` when v' = a (..., 6)."""
        return self._one("frame_acceleration", {"q": q, "v": v, "a": a, "u": u}, par, frame)

    def frame_jacobian(self, frame: str, q: Given, *, u: Given | None = None, par: Given | None = None) -> Array:
        """J (..., 6, nv) with frame_velocity = J v."""
        return self._one("frame_jacobian", {"q": q, "u": u}, par, frame)

    def frame_jacobian_rate(
        self, frame: str, q: Given, v: Given, *, u: Given | None = None, par: Given | None = None
    ) -> Array:
        """dJ/dt (..., 6, nv), so that frame_acceleration = J a + dJ/dt v."""
        return self._one("frame_jacobian_rate", {"q": q, "v": v, "u": u}, par, frame)

    # How a call is made.

    def _frame(self, frame: str) -> str:
        if frame in self.record.frame_names:
            return frame
        if frame in self.record.frame_aliases:
            return self.record.frame_aliases[frame]
        raise self._unknown("frame", frame, self.record.frame_names, "frames are listed in model.names.frames")

    def _unknown(self, kind: str, name: str, known: tuple[str, ...], rule: str) -> UnknownNameError:
        found = f"{len(known)} {kind}s" + (": " + ", ".join(known[:12]) if known else "")
        what = f"model '{self.record.name}': no {kind} '{name}'"
        return UnknownNameError(str(Problem(what, found, rule, did_you_mean(name, known) or "use another model")))

    def _finite(self, name: str, value: float) -> float:
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = np.nan
        if not np.isfinite(number):
            what = f"model '{self.record.name}': parameter '{name}' is not a finite number"
            raise ValueError(str(Problem(what, repr(value)[:80], "a parameter is one finite number",
                                         "pass par=… to a function for values that vary by state")))  # fmt: skip
        return number

    def _one(self, name: str, given: Mapping[str, Given | None], par: Given | None, frame: str = "") -> Array:
        return self._call(name, self._frame(frame) if frame else "", given, par)[0]

    def _call(self, name: str, frame: str, given: Mapping[str, Given | None], par: Given | None) -> list[Array]:
        kernel = self._kernels.get((name, frame)) or self._make(name, frame)
        arrays = [self._array(group, self._given(given[group]), size) for group, size in kernel.signature.inputs]
        shapes = [array.shape[:-1] for array in arrays]
        par_array = None
        if par is not None:
            par_array = self._array("par", par, self.npar)
            shapes.append(par_array.shape[:-1])
        batch = self._batch_shape(name, shapes, given)
        n = int(np.prod(batch))
        pre = self._pre(kernel, (name, frame), par_array, batch)
        outputs = kernel.run(n, pre, [_flat(array, batch) for array in arrays])
        shaped = zip(outputs, kernel.signature.outputs, strict=True)
        return [output.reshape(batch + shape) for output, (_, shape) in shaped]

    def _given(self, values: Given | None) -> Given:
        """What was given; the default inputs where nothing was."""
        return self.record.u_default if values is None else values

    def _pre(self, kernel: Kernel, key: Key, par: Array | None, batch: tuple[int, ...]) -> Array:
        if par is not None:
            flat = _flat(par, batch)
            return kernel.prepare(flat)
        if key not in self._prepared:
            self._prepared[key] = kernel.prepare(self._par.reshape(1, -1))
        return self._prepared[key]

    def _batch_shape(
        self, name: str, shapes: list[tuple[int, ...]], given: Mapping[str, Given | None]
    ) -> tuple[int, ...]:
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            shown = ", ".join(f"{group} {np.shape(x)}" for group, x in given.items() if x is not None)
            raise ShapeError(
                f"{name}: batch dimensions do not broadcast\n  found:  {shown}\n"
                "  rule:   all but the last dimension of each array broadcast together\n"
                "  remedy: give each array the same leading dimensions, or none"
            ) from None

    def _make(self, name: str, frame: str) -> Kernel:
        if self._build is None:
            what = f"{name} of frame '{frame}'" if frame else name
            raise SymofrosError(
                f"model '{self.record.name}': {what} was not generated\n"
                f"  found:  {', '.join(sorted({key[0] for key in self._kernels}))}\n"
                "  rule:   Options(functions=…, frames=…) generates what it names, and nothing else\n"
                "  remedy: add it to the options, or leave functions out to have each made when first called"
            )
        self._kernels.update(self._build(((name, frame),)).kernels)
        return self._kernels[name, frame]

    def _array(self, group: str, values: Given, size: int) -> Array:
        try:
            array = np.asarray(values, dtype=np.float64)
        except (TypeError, ValueError):
            raise ShapeError(
                f"model '{self.record.name}': {group} is not an array of numbers\n  found:  {type(values).__name__}\n"
                f"  rule:   {group} is a float64 array of shape (..., {size})" + self._hint(group)
            ) from None
        if group == "t":
            return array[..., np.newaxis]
        if array.ndim == 0 or array.shape[-1] != size:
            raise ShapeError(
                f"model '{self.record.name}': {group} has the wrong shape\n  found:  {array.shape}\n"
                f"  rule:   {group} has shape (..., {size})" + self._hint(group)
            )
        return array

    def _hint(self, group: str) -> str:
        names: dict[str, Any] = {"q": self.names.q, "v": self.names.v, "a": self.names.v, "u": self.names.u}
        shown = names.get(group, ())
        listed = ", ".join(shown[:8]) + (", …" if len(shown) > 8 else "")
        return f"\n  remedy: its last dimension runs over {listed}" if shown else ""


def _flat(array: Array, batch: tuple[int, ...]) -> Array:
    """(n or 1, size), contiguous: one row where the array has no batch of its own."""
    size = array.shape[-1]
    if array.size == size:
        return np.ascontiguousarray(array.reshape(1, size))
    return np.ascontiguousarray(np.broadcast_to(array, (*batch, size))).reshape(-1, size)
