"""The stepping loop in C, in Python's hands: built once, bound to a model, advanced in spells."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import cffi
import numpy as np

from symofros.errors import CompileError, Problem, SymofrosError
from symofros.native import native_text
from symofros.runtime.build import build_library
from symofros.runtime.kernel import Array, Kernel
from symofros.runtime.library import CompiledKernel
from symofros.runtime.model import Model
from symofros.runtime.toolchain import DEFAULT_FLAGS, NO_COMPILER, find_toolchain
from symofros.simulation.events import Event
from symofros.simulation.inputs import InputPlan
from symofros.simulation.methods import KIND_CODES, Method

_PARTS = (
    "manifold.c",
    "scene.c",
    "linear.c",
    "explicit.c",
    "implicit.c",
    "second_order.c",
    "pace.c",
    "within.c",
    "run.c",
    "flat.c",
    "instance.c",
    "selftest.c",
)
_HEADERS = ("symofros_stepper.h", "symofros_instance.h")
# Of Python's library only: many trajectories at once.
_CREW, _CREW_HEADER = "crew.c", "symofros_crew.h"
_SEGMENTS = {"linear": 0, "quaternion": 1, "pose": 2}

GOING, DONE, FULL, EVENT = 0, 1, 2, 3
DIVERGED, NO_MOTION, TINY_STEP, CALLBACK, NO_CONVERGENCE, OFF = -1, -2, -3, -4, -5, -6


def _native(name: str) -> str:
    return native_text(f"stepping/{name}")


def native_headers() -> dict[str, str]:
    """File name -> text of the headers that `native_source` includes, besides symofros_model.h."""
    return {name: _native(name) for name in _HEADERS}


def native_source() -> str:
    """The stepping loop as one C file: C99, and POSIX or Windows for the clock."""
    return "\n".join([_native("preamble.c"), *map(_native, _PARTS)])


@cache
def library() -> tuple[Any, Any]:
    """The cffi interface and the loaded library of native/, compiled at first use and cached.

    Raises:
        CompileError: There is no C compiler.
    """
    source = "\n".join([native_source(), f'#include "{_CREW_HEADER}"', _native(_CREW)])
    return bound(source, native_headers() | {_CREW_HEADER: _native(_CREW_HEADER)})


def bound(source: str, headers: Mapping[str, str], *flags: str) -> tuple[Any, Any]:
    """Hand-written C as a library, with the cffi interface of what its headers declare between their cdef marks.

    Args:
        source: One C file.
        headers: File name -> text of what it includes besides symofros_model.h; later ones include earlier ones.
        flags: Of the compiler, besides the default ones.

    Raises:
        CompileError: There is no C compiler.
    """
    toolchain = find_toolchain(None)
    if toolchain is None:
        raise CompileError(NO_COMPILER)
    header, ffi = native_text("model/symofros_model.h"), cffi.FFI()
    for text in (header, *headers.values()):
        match = re.search(r"/\* cdef begin.*?\*/(.*?)/\* cdef end \*/", text, re.DOTALL)
        if match is not None:
            ffi.cdef(match.group(1))
    for name, text in reversed(list(headers.items())):  # In one file, as the cache keeps it.
        source = source.replace(f'#include "{name}"', text)
    return ffi, ffi.dlopen(str(build_library(source, header, toolchain, (*DEFAULT_FLAGS, "-O3", *flags))))


class Stepper:
    """One run of one model.

    Args:
        model: Compiled to C.
        method: How to step.
        inputs: What drives it.
        events: What to look for.
        par: Run-time parameters (npar).

    Raises:
        SymofrosError: The model is interpreted.
    """

    def __init__(self, model: Model, method: Method, inputs: InputPlan, events: Sequence[Event], par: Array) -> None:
        self.ffi, self.native = library()
        self.model, self.method, self.events = model, method, events
        self.par = par
        self.failure: BaseException | None = None  # What an input function raised.
        self._keep: list[Any] = []  # What C holds pointers to.
        self.kernels: dict[str, CompiledKernel] = {}
        self.scene = self.ffi.new("sym_scene *")
        self.run = self.ffi.new("sym_run *")
        self._fill_scene(inputs)
        self._fill_method()
        self.run.scene = self.scene

    def numbers(self, values: Any) -> Any:
        """A C array of doubles that lives as long as the run."""
        array = np.array(values, dtype=np.float64).reshape(-1)
        array = array if array.size else np.zeros(1)
        self._keep.append(array)
        return self.ffi.cast("double *", self.ffi.from_buffer(array))

    def shared(self, values: Array) -> Any:
        """The numbers of a contiguous array themselves, as a C array; kept as long as the run."""
        self._keep.append(values)
        return self.ffi.cast("double *", self.ffi.from_buffer(values))

    def keep(self, thing: Any) -> None:
        """Let a thing that C points to live as long as the run."""
        self._keep.append(thing)

    def _fill_scene(self, inputs: InputPlan) -> None:
        model, scene, ffi = self.model, self.scene, self.ffi
        scene.nq, scene.nv, scene.nu, scene.nc = model.nq, model.nv, model.nu, model.nc
        segments = [(_SEGMENTS[s.kind], s.q, s.v, s.size) for s in model.record.segments]
        scene.n_segments, scene.segments = len(segments), self.own("sym_segment[]", segments)
        for name, size in (
            ("q", model.nq),
            ("v", model.nv),
            ("u", model.nu),
            ("t", 1),
            ("gains", 2 * model.nc),
            ("a", model.nv),
            ("lam", model.nc),
            ("rank", 1),
        ):
            setattr(scene, name, self.numbers(np.zeros(size)))
        scene.constant = self.numbers(inputs.constant)
        signals = []
        for index, t, values, linear in inputs.signals:
            signals.append((index, int(linear), len(t), self.shared(t), self.shared(values)))
        scene.n_signals, scene.signals = len(signals), self.own("sym_signal[]", signals)
        given, implicit = sorted(inputs.formulas), self.method.family.implicit
        scene.n_law, scene.law_inputs = len(given), self.own("int32_t[]", given)
        if given:
            self._bind("law", model.formulas([inputs.formulas[i] for i in given], implicit), {})
        scene.n_events = len(self.events)
        scene.event_direction = self.own("int32_t[]", [event.sign for event in self.events])
        scene.event_terminal = self.own("int32_t[]", [int(event.terminal) for event in self.events])
        if self.events:
            self._bind("events", model.formulas([event.formula for event in self.events], derivatives=False), {})
        self._bind("forward", model.kernel("forward_dynamics"), {"a": scene.a, "lam": scene.lam, "rank": scene.rank})
        for slot, name in self.method.family.functions.items():
            self._bind(slot, model.kernel(name), {})
        if model.nc:
            self._bind("project", model.kernel("project"), {})
        on_speeds = [int(name in model.record.speed_conditions) for name in model.names.constraints]
        scene.on_speeds = self.own("int32_t[]", on_speeds)
        if inputs.callback is not None:
            self._attach(inputs.callback)
        scene.data = ffi.NULL

    def own(self, kind: str, values: Any) -> Any:
        """A C array of a size or of values, that lives as long as the run."""
        array = self.ffi.new(kind, values or 1)
        self._keep.append(array)
        return array

    def _bind(self, slot: str, kernel: Kernel, outputs: dict[str, Any]) -> None:
        """Make a model's function callable from the loop; outputs that are not placed get arrays of their own."""
        if not isinstance(kernel, CompiledKernel):
            raise SymofrosError(
                Problem(
                    f"model '{self.model.record.name}': simulation steps in C",
                    "an interpreted model",
                    "the loop calls compiled functions",
                    "compile with backend='c'",
                )
            )
        call = getattr(self.scene, slot)
        call.function = self.ffi.cast("sym_function *", kernel.address)
        call.pre = self.numbers(kernel.prepare(self.par.reshape(1, -1)))
        call.work = self.numbers(np.zeros(max(1, kernel.work)))
        for i, (name, shape) in enumerate(kernel.signature.outputs):
            call.out[i] = outputs[name] if name in outputs else self.numbers(np.zeros(shape))
        self.kernels[slot] = kernel
        if not self.native.sym_bind(self.scene, self.ffi.addressof(self.scene, slot)):
            raise CompileError(f"the stepping loop knows not every input of '{kernel.signature.name}'")

    def _attach(self, function: Any) -> None:
        """A Python function as the inputs; what it raises is kept and ends the run."""
        nq, nv, nu = self.model.nq, self.model.nv, self.model.nu

        def call(_data: Any, t: float, q: Any, v: Any, u: Any) -> int:
            try:
                found = np.asarray(function(t, self._view(q, nq).copy(), self._view(v, nv).copy()), dtype=np.float64)
                if found.shape != (nu,):
                    raise ValueError(f"the input function returned shape {found.shape}, not ({nu},)")
                self._view(u, nu)[:] = found
            except BaseException as error:  # It may not pass through C; the loop raises it again.
                self.failure = error
                return 1
            return 0

        kind = "int32_t(void *, double, const double *, const double *, double *)"
        handle = self.ffi.callback(kind, call)
        self._keep.append(handle)
        self.scene.callback = handle

    def _view(self, pointer: Any, size: int) -> Array:
        return np.frombuffer(self.ffi.buffer(pointer, 8 * size), dtype=np.float64)

    def _fill_method(self) -> None:
        run, tableau = self.run, self.method.tableau
        run.method = KIND_CODES[self.method.kind]
        into = run.tableau
        into.stages, into.dense_stages, into.last = tableau.stages, len(tableau.b), tableau.last
        into.error_order, into.errors, into.degree = tableau.error_order, len(tableau.errors), tableau.dense.shape[1]
        into.a, into.b, into.c = map(self.numbers, (tableau.a, tableau.b, tableau.c))
        into.dense = self.numbers(tableau.dense)
        into.gamma, into.coupling, into.d = tableau.gamma, self.numbers(tableau.coupling), self.numbers(tableau.d)
        run.rho, run.tolerance = 0.8, 1e-12
        zero = np.zeros(tableau.stages)
        errors = [*tableau.errors, zero, zero]
        into.e, into.e2 = self.numbers(errors[0]), self.numbers(errors[1])

    def start(self, q: Array, v: Array, capacity: int) -> int:
        """Place the run at its first state, with room for so many records; returns a status."""
        run, model = self.run, self.model
        run.q, run.v = self.numbers(q), self.numbers(v)
        run.y = self.numbers(np.zeros(self.native.sym_work_size(run)))
        run.pivots = self.own("int32_t[]", [0] * (2 * (model.nv + model.nc)))
        run.event = self.numbers(np.zeros(3 * max(1, len(self.events))))
        run.capacity, run.event_capacity = capacity, max(64, 2 * len(self.events))
        self._records = self._room(
            capacity, ("record_t", 1), ("record_q", model.nq), ("record_v", model.nv), ("record_u", model.nu)
        )
        self._found = self._room(run.event_capacity, ("found_t", 1), ("found_q", model.nq), ("found_v", model.nv))
        self._which = np.zeros(run.event_capacity, dtype=np.int32)
        run.found_which = self.ffi.cast("int32_t *", self.ffi.from_buffer(self._which))
        return int(self.native.sym_start(run))

    def _room(self, rows: int, *columns: tuple[str, int]) -> list[Array]:
        arrays = []
        for name, width in columns:
            array = np.zeros((rows, max(1, width)))
            setattr(self.run, name, self.ffi.cast("double *", self.ffi.from_buffer(array)))
            arrays.append(array[:, :width])
        return arrays

    def advance(self, steps: int) -> int:
        """Make at most so many steps; returns a status. Other threads run meanwhile."""
        return int(self.native.sym_advance(self.run, steps))

    def take_records(self) -> list[Array]:
        """The records so far, t (n), q, v, u; the room is free again."""
        n = int(self.run.n_records)
        self.run.n_records = 0
        t, q, v, u = (array[:n].copy() for array in self._records)
        return [t[:, 0], q, v, u]

    def take_events(self) -> list[tuple[int, float, Array, Array]]:
        """The events found so far: which, when, q, v."""
        n = int(self.run.n_found)
        self.run.n_found = 0
        t, q, v = self._found
        return [(int(self._which[i]), float(t[i, 0]), q[i].copy(), v[i].copy()) for i in range(n)]

    def set_gains(self, gains: Array) -> None:
        """Baumgarte's gains (2 nc)."""
        self._view(self.scene.gains, len(gains))[:] = gains

    def inputs_at(self, t: float, q: Array, v: Array) -> Array:
        """The inputs of a state (nu); what they were before where a function of the caller's fails."""
        self.run.q, self.run.v = self.numbers(q), self.numbers(v)
        self.place(t, np.concatenate([q, v]))
        return self.inputs_now

    def place(self, t: float, y: Array) -> int:
        """Make y = (q, v) the run's state, with quaternions of unit length, and evaluate its inputs; a status."""
        return int(self.native.sym_flat_place(self.run, t, self._pointer(y)))

    def slope(self, t: float, y: Array, rate: Array) -> int:
        """The rate y' = (N v, v') of a state y = (q, v), into `rate`; returns a status."""
        return int(self.native.sym_flat_slope(self.run, t, self._pointer(y), self._pointer(rate)))

    def configuration_rate(self, q: Array, w: Array) -> Array:
        """The rate N w (nq) for speeds w (nv) at the configuration that was placed last; q: its numbers."""
        rate = np.zeros(self.model.nq)
        self.native.sym_flat_rate(self.run, self._pointer(q), self._pointer(w), self._pointer(rate))
        return rate

    def event_values(self, t: float, y: Array, values: Array) -> int:
        """The values of the events at a state y = (q, v), into `values`; returns a status."""
        return int(self.native.sym_flat_events(self.run, t, self._pointer(y), self._pointer(values)))

    def _pointer(self, array: Array) -> Any:
        """C's view of an array of doubles."""
        return self.ffi.cast("double *", array.ctypes.data)

    @property
    def inputs_now(self) -> Array:
        """The inputs last evaluated (nu)."""
        return self._view(self.scene.u, self.model.nu).copy()

    @property
    def state(self) -> tuple[float, Array, Array]:
        """The present t, q, v."""
        q, v = self._view(self.run.q, self.model.nq), self._view(self.run.v, self.model.nv)
        return float(self.run.t), q.copy(), v.copy()
