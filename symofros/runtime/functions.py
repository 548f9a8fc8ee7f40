"""How a model's functions are called: kernels made on demand, arrays checked and broadcast."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import Any, Self

import numpy as np

from symofros.base.arguments import check_argument
from symofros.base.functions import FRAME_FUNCTIONS, FUNCTIONS, INPUTS, MODEL_FUNCTIONS, generated_with
from symofros.base.routes import Choice
from symofros.errors import ParameterError, Problem, ShapeError, SymofrosError
from symofros.runtime.arguments import Arguments
from symofros.runtime.arguments import ArrayLike as ArrayLike
from symofros.runtime.background import BackgroundCompilation
from symofros.runtime.beams import ElasticBeam
from symofros.runtime.calls.bound import into, receivers
from symofros.runtime.calls.extension import begin
from symofros.runtime.calls.kernel import Array, BatchOptions, Kernel, Numbers, Precision, Unit
from symofros.runtime.calls.layout import by_columns, flat, states
from symofros.runtime.calls.library import CompiledKernel
from symofros.runtime.calls.plain import PlainCall, PlainCalls, plain_call
from symofros.runtime.cuda.device_code import DeviceCode
from symofros.runtime.instants import NO_INSTANTS, Instants
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.record import ModelRecord

Key = tuple[str, str]
ParameterCheck = Callable[[Array], Sequence[Problem]]
# Largest array of parameters that is remembered as checked.
_KEPT_BYTES = 1 << 16


@dataclass(frozen=True)
class Rate:
    """A formula of t and parameters, differentiated by t.

    Attributes:
        formula: Text or SymPy expression.
        order: Number of differentiations by time.
    """

    formula: Any
    order: int


class Functions(Arguments):
    """The functions of one mechanism by name, with its sizes, names and parameter values.

    Args:
        record: Sizes, names, defaults.
        build: Generates and compiles functions by key, and calls what it is given as a C compiler starts to work; None
            where all there is has been built.
        units: Functions built already.
        par: Values of the run-time parameters; None for the defaults.
        formulas: Generates and compiles a user's formulas.
        beams: Gives the elastic beams at values of the run-time parameters (npar).
        threads: Number of threads that share a large batch.
        precision: Precision of what functions take and return.
        parameter_check: Problems of sets of run-time parameters (n, npar); None where nothing is known of them.
        origin: Makes the model again, for copies in other processes; None where it has no description.
        device_code: Generates kernels of a function, for graphics processors; None where there is no description.
        instants: Gives the instants at which formulas of time bend, jump or change fast, the model's own and those of
            laws, from laws, parameters (npar), start and end of a run; None where no formulas are known.
        routes: Tells the methods of the functions of one unit; None where there is no description.
        background: What is compiled while the functions are on tape; None where they are what they stay.
    """

    def __init__(
        self,
        record: ModelRecord,
        build: Callable[[tuple[Key, ...], Callable[[], None] | None], Unit] | None,
        units: tuple[Unit, ...] = (),
        par: Array | None = None,
        formulas: Callable[[tuple[Any, ...], bool, bool], Unit] | None = None,
        beams: Callable[[Array], tuple[ElasticBeam, ...]] | None = None,
        threads: int = 1,
        precision: Precision = "double",
        parameter_check: ParameterCheck | None = None,
        origin: Callable[[], Functions] | None = None,
        device_code: Callable[[Key, Precision], DeviceCode] | None = None,
        instants: Instants | None = None,
        routes: Callable[[tuple[Key, ...]], Mapping[Key, tuple[Choice, ...]]] | None = None,
        background: BackgroundCompilation | None = None,
    ) -> None:
        check_argument("Model: record", record, ModelRecord)
        super().__init__(record, np.array(record.par_default if par is None else par, dtype=np.float64))
        self._threads = threads
        self._precision = precision
        self._build = build
        self._parameter_check, self._last_checked = parameter_check, b""
        self._build_formulas = formulas
        self._origin = origin
        self._device_code = device_code
        self._beams_at = beams
        self.formula_instants = NO_INSTANTS if instants is None else instants
        self._routes_of = routes
        self._background = background
        self._kernels: dict[Key, Kernel] = {key: kernel for unit in units for key, kernel in unit.kernels.items()}
        self._prepared: dict[Key, Array] = {}
        self._plain_calls = PlainCalls()

    def __repr__(self) -> str:
        """Name and sizes."""
        return f"Model({self.record.name!r}, nq={self.nq}, nv={self.nv}, nu={self.nu}, npar={self.npar}, nc={self.nc})"

    def checked_parameters(self, par: ArrayLike) -> Array:
        """Sets of run-time parameters (..., npar), which the conditions of the description hold for.

        They are those at the description's own values: finite, positive masses, lengths and stiffnesses, moments of
        inertia that a body can have, some inertia for each joint. `with_parameter_checks(False)` leaves them out.

        Raises:
            ShapeError: They are not an array of that shape.
            ParameterError: A condition does not hold; names it, and the first set where it fails.
        """
        array = np.asarray(self._array("par", par, self.npar), dtype=np.float64)
        if self._parameter_check is None or self.npar == 0 or array.size == 0:
            return array
        # Loops pass the same values again and again; only few are kept.
        content = array.tobytes() if array.nbytes <= _KEPT_BYTES else b""
        if not content or content != self._last_checked:
            problems = self._parameter_check(array.reshape(-1, self.npar))
            if problems:
                raise ParameterError(
                    [replace(problem, what=f"model '{self.record.name}': {problem.what}") for problem in problems]
                )
            self._last_checked = content
        return array

    @property
    def threads(self) -> int:
        """Number of threads that share a large batch."""
        return self._threads

    @property
    def precision(self) -> Precision:
        """Floating-point type of inputs and outputs: "double" or "single"."""
        return self._precision

    def _like(self, par: Array | None = None, threads: int | None = None, precision: Precision | None = None) -> Self:
        """A copy with other parameters, threads or precision, which shares the compiled kernels."""
        other = type(self)(
            self.record,
            self._build,
            (),
            self._par if par is None else par,
            self._build_formulas,
            self._beams_at,
            threads or self._threads,
            precision or self._precision,
            self._parameter_check,
            self._origin,
            self._device_code,
            self.formula_instants,
            self._routes_of,
            self._background,
        )
        other._kernels = self._kernels  # Shared, so that what either compiles serves both.
        return other

    def beams(self, par: ArrayLike | None = None) -> tuple[ElasticBeam, ...]:
        """The elastic beams as numbers, by which bending is judged, at these run-time parameters (npar)."""
        if self._beams_at is None:
            return ()
        return self._beams_at(self._par if par is None else self._array("par", par, self.npar))

    def kernel(self, name: str, frame: str = "") -> Kernel:
        """A function as the thing that is called, made on demand; for loops of one's own.

        Args:
            name: The function.
            frame: Frame of a frame function.

        Raises:
            UnknownNameError: There is no such function or frame.
        """
        return self._kernel(name, self._frame_or_none(frame), "a kernel of a function of frames is asked for with one")

    def has(self, name: str) -> bool:
        """Whether a function of the whole model can be called: `Options.functions` may have left it out."""
        return self._build is not None or (name, "") in self._kernels

    @property
    def libraries(self) -> frozenset[Path]:
        """The shared libraries of the functions made so far; none of those that are interpreted."""
        compiled = (kernel.library for kernel in self._kernels.values() if isinstance(kernel, CompiledKernel))
        return frozenset(path for path in compiled if path is not None)

    def _check_name(self, name: str, frame: str, rule: str) -> None:
        known = FRAME_FUNCTIONS if frame else MODEL_FUNCTIONS
        if not isinstance(name, str) or name not in known:
            raise self._unknown("function", str(name)[:80], known, rule)

    def _kernel(self, name: str, frame: str, rule: str) -> Kernel:
        """A function whose name a user gave, of a frame that exists."""
        self._check_name(name, frame, rule)
        return self._kernels.get((name, frame)) or self._make(name, frame)

    def evaluate(
        self,
        name: str,
        frame: str = "",
        *,
        par: ArrayLike | None = None,
        out: Mapping[str, Numbers] | None = None,
        **inputs: ArrayLike | None,
    ) -> list[Numbers]:
        """Any function by its name in the table of functions (`symofros/base/functions.py`).

        Args:
            name: The function; most have a method of that name.
            frame: Frame of a frame function.
            par: Run-time parameters.
            out: Arrays by names of outputs, which receive these and are returned. Batches are computed in place, unless
                an array overlaps an input.
            inputs: The function's inputs by name; `t` is 0 and `u` the default inputs where they are left out; those of
                no entries, multipliers of a tree, may be left out, too.

        Returns:
            The function's outputs in the order of the table, each (..., *shape).

        Raises:
            UnknownNameError: No such function, frame, input or output.
            ShapeError: An input is missing, or an array does not fit.
        """
        public = self._frame_or_none(frame)
        kernel = self._kernel(name, public, "functions of frames are evaluated with their frame")
        for group in inputs:
            if group not in INPUTS:
                raise self._unknown("input", group, tuple(INPUTS), f"{name} takes {', '.join(FUNCTIONS[name].inputs)}")
        values = {"u": None, "t": 0.0, "gains": np.zeros(2 * self.nc)} | inputs
        for group, size in kernel.signature.inputs:
            if group not in values and size == 0:  # A tree has no multipliers, and none that are wrong.
                values[group] = np.zeros(0)
            elif group not in values:
                takes = ", ".join(FUNCTIONS[name].inputs)
                raise ShapeError(f"{name}: no {group}", f"{', '.join(inputs) or 'nothing'}", takes, "add it")
        return self._call(name, public, values, par, out)

    def formulas(self, formulas: Sequence[Any], derivatives: bool = True, reactions: bool = False) -> Kernel:
        """Formulas over the model's names, compiled: (q, v, u, t; a, lam) -> values, and derivatives by q and by v.

        Args:
            formulas: Numbers, texts such as "10*(sin(t) - q1) - dq1", SymPy expressions, or Rates of them.
            derivatives: Whether those are wanted, too.
            reactions: Whether they may use multipliers, wrenches and reactions, and are of a and lam then.

        Raises:
            UnknownNameError: A formula uses a name that the mechanism lacks, or that it may not use.
            DescriptionError: A text is not a formula.
        """
        if self._build_formulas is None:
            raise SymofrosError(f"model '{self.record.name}': a model without its description compiles no formulas")
        return self._build_formulas(tuple(formulas), derivatives, reactions).kernels["formulas", ""]

    # How a call is made.

    def _one(self, name: str, given: Mapping[str, ArrayLike | None], par: ArrayLike | None) -> Numbers:
        if par is None or par is self._par:  # The shortest way: each call on it costs a twentieth of a small one.
            plain = self._plain_calls.prepared.get(name)
            outputs = None if plain is None else plain(given)
            if outputs is not None:
                return outputs[0]
        return self._call(name, "", given, par)[0]

    def _call(
        self,
        name: str,
        frame: str,
        given: Mapping[str, ArrayLike | None],
        par: ArrayLike | None,
        out: Mapping[str, Numbers] | None = None,
    ) -> list[Numbers]:
        par = None if par is self._par else par  # As runs pass the model's own.
        if par is None and self._precision == "double":
            outputs = self._plain(name, frame)(given, out)
            if outputs is not None:
                return outputs
        return self._call_batch(name, frame, given, par, out)

    def _plain(self, name: str, frame: str) -> PlainCall:
        """The plain call of a function, prepared at the first time."""
        key = (name, frame) if frame else name
        calls = self._plain_calls  # As they are before: a better call may be there before this one is made.
        if key not in calls.prepared:
            kernel = self._kernels.get((name, frame)) or self._make(name, frame, begin)
            default = np.array(self.record.u_default)
            quaternions, better = self.record.quaternions, self._forget_plain_calls
            calls.prepared[key] = plain_call(kernel, self._par, default, quaternions, better, self._threads)
        return calls.prepared[key]

    def _forget_plain_calls(self) -> None:
        """The next call of each function prepares it anew."""
        self._plain_calls = PlainCalls()

    def _call_batch(
        self,
        name: str,
        frame: str,
        given: Mapping[str, ArrayLike | None],
        par: ArrayLike | None,
        out: Mapping[str, Numbers] | None = None,
    ) -> list[Numbers]:
        kernel = self._kernels.get((name, frame)) or self._make(name, frame)
        dtype = BatchOptions(precision=self._precision).dtype
        u = given.get("u")
        arrays = [
            self._array(group, self.record.u_default if group == "u" and u is None else given[group], size, dtype)
            for group, size in kernel.signature.inputs
        ]
        shapes = [array.shape[:-1] for array in arrays]
        par_array = None
        if par is not None:
            par_array = self.checked_parameters(par)
            shapes.append(par_array.shape[:-1])
        batch = self._batch_shape(name, shapes, given)
        if self.record.quaternions:
            for k, (group, _) in enumerate(kernel.signature.inputs):
                if group in self.record.quaternions:
                    arrays[k] = at_unit_length(self.record, group, arrays[k])
        if par is None and self._precision == "double" and all(array.ndim == 1 for array in arrays):
            # One state after all: as lists, by name, or of other numbers.
            named = {group: x for (group, _), x in zip(kernel.signature.inputs, arrays, strict=True)}
            plain = self._plain(name, frame)
            outputs = plain(named | {"t": float(named["t"][0])} if "t" in named else named)
            if outputs is not None:
                return outputs if out is None else into(out, kernel.signature, outputs)
        n = prod(batch)
        pre = self._pre(kernel, (name, frame), par_array, batch)
        inputs = [states(array, batch) for array in arrays]
        options = BatchOptions(self._threads, by_columns(inputs), self._precision)
        shapes_out = [shape for _, shape in kernel.signature.outputs]
        if out is None:
            outputs = kernel.run(n, pre, inputs, options)
            return [output.reshape(batch + shape) for output, shape in zip(outputs, shapes_out, strict=True)]
        places = receivers(out, kernel.signature, batch, dtype)
        # What is written into while inputs are read must not be one of them.
        rows = [
            None if place is None or any(np.may_share_memory(place, x) for x in inputs) else place.reshape(n, *shape)
            for place, shape in zip(places, shapes_out, strict=True)
        ]
        outputs = kernel.run(n, pre, inputs, options, rows)
        for place, row, output in zip(places, rows, outputs, strict=True):
            if place is not None and output is not row:
                place[...] = output.reshape(place.shape)
        return [
            output.reshape(batch + shape) if place is None else place
            for place, output, shape in zip(places, outputs, shapes_out, strict=True)
        ]

    def _pre(self, kernel: Kernel, key: Key, par: Array | None, batch: tuple[int, ...]) -> Array:
        if par is not None:
            return kernel.prepare(flat(par, batch))
        if key not in self._prepared:
            self._prepared[key] = kernel.prepare(self._par.reshape(1, -1))
        return self._prepared[key]

    def _make(self, name: str, frame: str, meanwhile: Callable[[], None] | None = None) -> Kernel:
        together = self._unit_of(name, frame)
        assert self._build is not None, "what a model of chosen functions has is made"
        self._kernels.update(self._build(together, meanwhile).kernels)
        return self._kernels[name, frame]

    def _unit_of(self, name: str, frame: str) -> tuple[Key, ...]:
        """Keys of the functions that are made in one unit with a function, itself among them."""
        if self._build is not None:
            return ((name, frame),) if frame else tuple((other, "") for other in generated_with(name, self.nc > 0))
        if (name, frame) not in self._kernels:
            what = f"{name} of frame '{frame}'" if frame else name
            raise SymofrosError(
                f"model '{self.record.name}': {what} was not generated",
                ", ".join(sorted({key[0] for key in self._kernels})),
                "Options(functions=…, frames=…) generates what it names, and nothing else",
                "add it to the options, or leave functions out to have each made when first called",
            )
        return tuple(self._kernels)
