"""Model: the functions of one mechanism as methods."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Literal, overload

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import check_argument
from symofros.base.arrays import numeric
from symofros.base.functions import MODEL_FUNCTIONS, generated_with
from symofros.base.threads import ending_together, submit
from symofros.runtime.calls.bound import Bound, Layout, bind, bind_batch
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import ArrayLike as ArrayLike
from symofros.runtime.functions import Key as Key
from symofros.runtime.functions import Rate as Rate
from symofros.runtime.instants import Motion as Motion
from symofros.runtime.methods.adjoint import AdjointFunctions
from symofros.runtime.methods.configurations import ConfigurationFunctions
from symofros.runtime.methods.constraints import ConstraintFunctions
from symofros.runtime.methods.copies import CopyFunctions
from symofros.runtime.methods.derivatives import DerivativeFunctions
from symofros.runtime.methods.frames import FrameFunctions
from symofros.runtime.methods.identification import IdentificationFunctions
from symofros.runtime.methods.identification import JointTerm as JointTerm
from symofros.runtime.methods.linear import FrameDerivatives as FrameDerivatives
from symofros.runtime.methods.linear import Output as Output
from symofros.runtime.methods.linear import StateMatrices as StateMatrices
from symofros.runtime.methods.momentum import MomentumFunctions
from symofros.runtime.methods.reactions import ContactForces as ContactForces
from symofros.runtime.methods.reactions import ReactionFunctions
from symofros.runtime.methods.routes import RouteFunctions
from symofros.runtime.methods.states import StateFunctions


class Model(
    AdjointFunctions,
    ConfigurationFunctions,
    ReactionFunctions,
    ConstraintFunctions,
    CopyFunctions,
    DerivativeFunctions,
    FrameFunctions,
    IdentificationFunctions,
    MomentumFunctions,
    RouteFunctions,
    StateFunctions,
):
    """The equations of one mechanism, ready to be evaluated.

    Every function takes float64 arrays with any leading batch dimensions, broadcasts them, and returns new arrays
    (float32 after `with_precision("single")`). Results lie in memory as inputs do: with the batch as their fast axis if
    that is so in all inputs (`np.asfortranarray(q)`, `Q.T`), which is the fastest; else row by row.
    Values may be given by name, too: `{"shoulder": 0.1}` for q, with the others at their defaults; so they may wherever
    states, inputs or parameters are asked for.
    `par=` overrides the run-time parameters (..., npar), judged as the description's own (`with_parameter_checks`);
    `t=` gives the time (...,) to models that depend on it; `u=` matters where a motion is prescribed, because its
    coordinates, speeds and their rates are inputs.
    `z=` gives the states (..., nz) of forces to models that have some, as of friction by bristles; the neutral ones,
    zeros, by default.
    Quaternions are rotations: near unit length, to 1e-3, they are taken at it, others raise ShapeError.
    NaN in a state or an input propagates to what depends on it, so that one bad state does not spoil its batch.
    Methods raise ShapeError where an array does not fit, UnknownNameError for a name that is not in the model, and
    ParameterError for parameters that the description refuses.
    Functions may be called from several threads; C runs without the interpreter lock.
    """

    # Functions ahead of their first call.

    def prepare(self, *names: str) -> None:
        """Generate and compile functions of the whole model that are not there yet, several at the same time.

        Each is made when it is first called, too; together they take about as long as the slowest. A model of chosen
        functions (`Options(functions=...)`) has no others, and stays as it is.

        Args:
            names: Names of functions.

        Raises:
            UnknownNameError: There is no such function.
            CompileError: The C compiler failed.
        """
        for name in names:
            if not isinstance(name, str) or name not in MODEL_FUNCTIONS:
                rule = "functions of frames are made when they are called"
                raise self._unknown("function", str(name)[:80], MODEL_FUNCTIONS, rule)
        missing = [name for name in names if (name, "") not in self._kernels and self._build is not None]
        units = dict.fromkeys(generated_with(name, self.nc > 0) for name in missing)
        if not units:
            return
        # A few threads more than processors: dozens of compilers at once only take memory.
        with ThreadPoolExecutor() as pool, ending_together():
            try:
                for made in [submit(pool, self._make, unit[0], "") for unit in units]:
                    made.result()
            except BaseException:  # Ctrl-C, too: what has not begun is left.
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    # Calls without checks.

    def bind(
        self,
        name: str,
        frame: str = "",
        *,
        n: int | None = None,
        layout: Layout = "rows",
        par: ArrayLike | None = None,
        **arrays: Array,
    ) -> Bound:
        """A function bound to fixed memory: a call takes a fraction of a microsecond more than its C.

        `M = model.bind("mass_matrix")`, then write into `M.inputs["q"]`, call `M()`, read `M.outputs["M"]`.
        With n, of that many states: `M.inputs["q"]` is (n, nq), `M.outputs["M"]` (n, nv, nv), and a call gives the
        bits of `model.mass_matrix(q)` in double precision, by vectors and in the model's threads where that does.
        Quaternions are not looked at: they are of unit length.

        Args:
            name: Name of the function, as of the method.
            frame: The frame that it is about, for frame functions.
            n: States of a batch; None: one state, without a batch dimension.
            layout: Layout of allocated arrays of a batch: "rows", the numbers of a state contiguous; or "columns",
                the states contiguous, which is faster by vectors.
            par: Run-time parameters (npar), or (n, npar); the model's by default. They are read here, and not again.
            arrays: Memory of the caller's for inputs and outputs, by name; what is left out is allocated. Inputs of a
                batch may be (size), for all states.

        Raises:
            UnknownNameError: There is no such function, frame, input or output.
            ParameterError: The description refuses the parameters.
            ShapeError: An array is not a writeable float64 array of its shape, contiguous (of batches: which lies in
                even steps); or n is below 1.
        """
        values = self.parameter_values if par is None else self.checked_parameters(par)
        kernel = self._kernel(name, self._frame_or_none(frame), "frame functions are bound with their frame")
        defaults = {"u": np.array(self.record.u_default)}
        if n is None:
            return bind(kernel, values, arrays, defaults)
        return bind_batch(kernel, n, layout, values, arrays, defaults, self.threads)

    # Dynamics: M(q) v' + h(q, v) = Q(q, v, u).

    def mass_matrix(self, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None) -> Array:
        """Mass matrix M(q) (..., nv, nv)."""
        return self._one("mass_matrix", {"q": q, "u": u}, par)

    def bias(self, q: ArrayLike, v: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None) -> Array:
        """Coriolis, centrifugal and gravity terms h(q, v) (..., nv)."""
        return self._one("bias", {"q": q, "v": v, "u": u}, par)

    def generalized_force(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> Array:
        """Applied and joint forces Q(q, v, u) (..., nv)."""
        return self._one(
            "generalized_force", {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t}, par
        )

    def dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array, Array]:
        """M (..., nv, nv), h (..., nv) and Q (..., nv) in one call."""
        M, h, Q = self._call(
            "dynamics", "", {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t}, par
        )
        return M, h, Q

    @overload
    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        gains: npt.ArrayLike | None = None,
        multipliers: Literal[False] = False,
        z: ArrayLike | None = None,
    ) -> Array: ...
    @overload
    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        gains: npt.ArrayLike | None = None,
        multipliers: Literal[True],
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array]: ...
    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        gains: npt.ArrayLike | None = None,
        multipliers: bool = False,
        z: ArrayLike | None = None,
    ) -> Array | tuple[Array, Array]:
        """Accelerations v' (..., nv) that the forces produce, constraints kept.

        Args:
            q: Configuration (..., nq).
            v: Speeds (..., nv).
            u: Inputs (..., nu).
            par: Run-time parameters (..., npar).
            t: Time (...,).
            gains: Baumgarte's (alpha, beta) for all constraints, or (..., 2 nc): alpha of each, then beta of each
                [1/s]; none: accelerations only, so that errors of phi and G v drift.
            multipliers: Whether to return lam (..., nc) as well: G^T lam are the constraint forces.
            z: States of forces (..., nz).
        """
        if multipliers is not False:
            check_argument("forward_dynamics: multipliers", multipliers, bool)
        if multipliers:
            return self.constrained_dynamics(q, v, u, par=par, t=t, gains=gains, z=z)[:2]
        a = self._one(
            "forward_dynamics",
            {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t, "gains": self._gains(gains)},
            par,
        )
        if self.record.sticking:
            self._warn_of_smooth_friction(v, par)
        return a

    def constrained_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        gains: npt.ArrayLike | None = None,
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array, Array]:
        """Accelerations v' (..., nv), multipliers (..., nc) and the rank of G (...,).

        Conditions that repeat others leave v' as it is and get multipliers of least norm; ones that contradict each
        other are met in the sense of least squares. A rank of -1 marks a state that has no acceleration (NaN).
        """
        given = {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t, "gains": self._gains(gains)}
        a, *constrained = self._call("forward_dynamics", "", given, par)
        if self.record.sticking:
            self._warn_of_smooth_friction(v, par)
        if not constrained:
            batch = a.shape[:-1]
            return a, np.zeros((*batch, 0)), np.zeros(batch)
        lam, rank = constrained
        return a, lam, rank

    def _gains(self, gains: npt.ArrayLike | None) -> ArrayLike:
        if gains is None:
            return np.zeros(2 * self.nc)
        given = numeric("gains", gains)
        return np.repeat(given, self.nc, axis=-1) if given.shape == (2,) else given

    def inverse_dynamics(
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
        """M a + h - Q(q, v, 0) (..., nv): what the inputs must supply for v' = a; of u, only motions count."""
        return self._one(
            "inverse_dynamics", {"q": q, "v": v if z is None else self._with_states(v, z), "a": a, "u": u, "t": t}, par
        )

    def kinetic_energy(
        self, q: ArrayLike, v: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """Kinetic energy (...,) [J]."""
        return self._one("kinetic_energy", {"q": q, "v": v, "u": u}, par)

    def potential_energy(
        self,
        q: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> Array:
        """Potential energy (...,) [J]: of the weight, zero for mass at the world origin, and of springs."""
        given: dict[str, ArrayLike | None] = {"q": q, "u": u, "t": t}
        if self.nz or z is not None:
            at_states = self._at_states(z)
            given |= {"v": at_states} if self.nz else {}
        return self._one("potential_energy", given, par)
