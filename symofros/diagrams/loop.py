"""The loop of native/ in Python's hands: a compiled diagram bound to memory, advanced in spells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from symofros.diagrams.layout import Layout, Place
from symofros.diagrams.rates import Schedule
from symofros.errors import CompileError
from symofros.native import native_text
from symofros.runtime.kernel import Array
from symofros.runtime.library import CompiledKernel
from symofros.simulation.stepper import Stepper, bound, native_headers, native_source

# What a schedule calls the recording of an instant.
RECORD = "(record)"
_HEADER, _PROGRAM_HEADER = "symofros_diagram.h", "symofros_program.h"
_PARTS, _PROGRAM_PARTS = ("gang_api.c", "diagram.c", "gang.c"), ("diagram.c", "program.c")
_PORTION = 4096


def _native(name: str) -> str:
    return native_text(f"diagrams/{name}")


def loop_headers() -> dict[str, str]:
    """File name -> text of the headers of loop and programs, besides those of the stepper."""
    return {name: _native(name) for name in (_HEADER, _PROGRAM_HEADER)}


def program_source() -> str:
    """Stepper, loop and programs as one C file, without threads: C99, and POSIX or Windows for the clock."""
    own = (f'#include "{_PROGRAM_HEADER}"', "#include <stdio.h>", _native("alone.c"), *map(_native, _PROGRAM_PARTS))
    return "\n".join([native_source(), *own])


@cache
def library() -> tuple[Any, Any]:
    """The cffi interface and the loaded library, compiled at first use and cached.

    Raises:
        CompileError: There is no C compiler.
    """
    source = "\n".join([native_source(), f'#include "{_HEADER}"', *map(_native, _PARTS)])
    return bound(source, native_headers() | {_HEADER: _native(_HEADER)}, "-pthread")


class Stage:
    """A function that is evaluated at an instant, and the block of Python's that hears it."""

    def __init__(self, kernel: CompiledKernel, opaque: int = -1) -> None:
        self.kernel, self.opaque = kernel, opaque


class Loop:
    """One run of one diagram.

    Args:
        layout: Of its vectors.
        parts: A stepper for each part, started.
        schedule: Of its instants; RECORD among them.
        stages: For each set of the schedule what is evaluated.
        crossings: For each crossing what it changes.
        par: Run-time parameters.
        u0: First inputs.
        opaque: (block of Python's, time, what it hears) -> its outputs, one after the other.
        places: Where those outputs lie in u.
        heard: Length of what each hears.
        looks_back: Whether stages read accelerations and multipliers of the instant.
    """

    def __init__(
        self,
        layout: Layout,
        parts: Sequence[Stepper],
        schedule: Schedule,
        stages: Sequence[Sequence[Stage]],
        crossings: Sequence[Stage],
        par: Array,
        u0: Array,
        opaque: Callable[[int, float, Array], Array],
        places: Sequence[Sequence[Place]],
        heard: Sequence[int],
        looks_back: bool,
    ) -> None:
        self.ffi, self.native = library()
        self._keep: list[Any] = [parts]
        self._opaque, self._places, self._heard = opaque, places, heard
        self.failure: BaseException | None = None
        self.parts = parts
        self.d = self.ffi.new("sym_diagram *")
        d, ffi = self.d, self.ffi
        d.nq, d.nv, d.nu, d.nc = len(layout.q0), len(layout.v0), len(layout.u0), len(layout.condition_names)
        for name, values in (
            ("q", layout.q0),
            ("v", layout.v0),
            ("t", [0.0]),
            ("a", [0.0] * d.nv),
            ("lam", [0.0] * d.nc),
        ):
            setattr(d, name, self._numbers(values)[0])
        d.u, self._u = self._numbers(u0)
        self._join(layout, parts)
        d.looks_back = int(looks_back)
        self._sample(layout)
        d.n_engaging, d.engaging = len(layout.engaging), self._own("int32_t[]", layout.engaging)
        d.engaged = self._numbers(u0[layout.engaging])[0]
        self._plan(schedule, stages, par)
        d.n_crossings, d.crossings = len(crossings), self._stages(crossings, par)
        self._make_room()
        handle = ffi.callback("int32_t(void *, int32_t, double, const double *, double *)", self._call)
        self._keep.append(handle)
        d.opaque, d.data, d.gang = handle, ffi.NULL, ffi.NULL

    def _numbers(self, values: Any) -> tuple[Any, Array]:
        array = np.array(values, dtype=np.float64).reshape(-1)
        whole = array if array.size else np.zeros(1)
        self._keep.append(whole)
        return self.ffi.cast("double *", self.ffi.from_buffer(whole)), array

    def _own(self, kind: str, values: Sequence[Any]) -> Any:
        array = self.ffi.new(kind, list(values) or 1)
        self._keep.append(array)
        return array

    def _join(self, layout: Layout, parts: Sequence[Stepper]) -> None:
        """The parts read the inputs of the diagram, which hold between instants."""
        d, ffi = self.d, self.ffi
        runs = []
        inputs = int(ffi.cast("uintptr_t", d.u))
        for stepper in parts:
            stepper.scene.constant = stepper.ffi.cast("double *", inputs)
            runs.append(ffi.cast("sym_run *", int(stepper.ffi.cast("uintptr_t", stepper.run))))
        d.n_parts, d.parts = len(parts), self._own("sym_run *[]", runs)
        for name, places in (
            ("q_at", [part.q for part in layout.parts]),
            ("v_at", [part.v for part in layout.parts]),
            ("c_at", [part.conditions for part in layout.parts]),
        ):
            setattr(d, name, self._own("int32_t[]", [place.start for place in places]))

    def _sample(self, layout: Layout) -> None:
        rows = [
            (i, int(linear), len(t), self._numbers(t)[0], self._numbers(values)[0])
            for i, t, values, linear in layout.signals
        ]
        self.d.n_signals, self.d.signals = len(rows), self._own("sym_signal[]", rows)

    def _plan(self, schedule: Schedule, stages: Sequence[Sequence[Stage]], par: Array) -> None:
        d = self.d
        d.base_n, d.base_d = float(schedule.base.numerator), float(schedule.base.denominator)
        d.cycle, d.n_instants = schedule.cycle, len(schedule.instants)
        d.instant = self._own("int64_t[]", [k for k, _ in schedule.instants])
        d.set = self._own("int32_t[]", [which for _, which in schedule.instants])
        rows = [
            (len(of), int(RECORD in due), self._stages(of, par)) for due, of in zip(schedule.sets, stages, strict=True)
        ]
        d.sets = self._own("sym_instant[]", rows)

    def _stages(self, stages: Sequence[Stage], par: Array) -> Any:
        found = self._own("sym_stage[]", [{} for _ in stages])
        for i, stage in enumerate(stages):
            kernel, call = stage.kernel, found[i].call
            call.function = self.ffi.cast("sym_function *", kernel.address)
            call.pre = self._numbers(kernel.prepare(par.reshape(1, -1)))[0]
            call.work = self._numbers(np.zeros(max(1, kernel.work)))[0]
            for k, (_, shape) in enumerate(kernel.signature.outputs):
                call.out[k] = self._numbers(np.zeros(shape))[0]
            found[i].opaque = stage.opaque
            self._keep.append(kernel)
            if not self.native.sym_diagram_bind(self.d, self.ffi.addressof(found[i], "call")):
                raise CompileError(f"the loop knows not every input of '{kernel.signature.name}'")
        return found

    def _make_room(self) -> None:
        d = self.d
        d.capacity = d.found_capacity = _PORTION
        self._records = []
        for name, width in (("t", 1), ("q", d.nq), ("v", d.nv), ("u", d.nu)):
            pointer, array = self._numbers(np.zeros((_PORTION, max(1, width))))
            setattr(d, f"record_{name}", pointer)
            self._records.append(array.reshape(_PORTION, -1)[:, :width])
        d.found_t, self._found_t = self._numbers(np.zeros(_PORTION))
        self._which = np.zeros(_PORTION, dtype=np.int32)
        d.found_which = self.ffi.cast("int32_t *", self.ffi.from_buffer(self._which))

    def _call(self, _data: Any, which: int, t: float, heard: Any, _u: Any) -> int:
        """A block of Python's; what it raises is kept and ends the run."""
        try:
            places = self._places[which]
            size = int(self._heard[which])
            found = self._opaque(which, t, self._copy(heard, size))
            at = 0
            for place in places:
                self._u[place.slice] = found[at : at + place.size]
                at += place.size
        except BaseException as error:  # It may not pass through C.
            self.failure = error
            return 1
        return 0

    def _copy(self, pointer: Any, size: int) -> Array:
        return np.frombuffer(self.ffi.buffer(pointer, 8 * size), dtype=np.float64).copy() if size else np.zeros(0)

    def start(self, t0: float, t_end: float, realtime: float, threads: int, instants: int) -> None:
        """Place the run at its start."""
        d = self.d
        d.t0, d.t_end = t0, t_end
        d.pace = 1.0 / realtime if realtime else 0.0
        d.late_capacity = instants if realtime else 0
        d.late, self._late = self._numbers(np.zeros(max(1, d.late_capacity)))
        if threads > 1 and d.n_parts > 1 and not d.n_crossings:
            self.native.sym_diagram_hire(d, min(threads, d.n_parts))
        self.native.sym_diagram_start(d)

    def close(self) -> None:
        """Send the threads home."""
        self.native.sym_diagram_dismiss(self.d)

    def advance(self, instants: int) -> int:
        """At most so many instants further; returns a status."""
        return int(self.native.sym_diagram_advance(self.d, instants))

    def take(self) -> tuple[list[Array], list[tuple[float, int]]]:
        """What was recorded since, t (n), q, v, u, and the crossings met; the room is free again."""
        n, m = int(self.d.n_records), int(self.d.n_found)
        self.d.n_records = self.d.n_found = 0
        t, q, v, u = (array[:n].copy() for array in self._records)
        return [t[:, 0], q, v, u], [(float(self._found_t[i]), int(self._which[i])) for i in range(m)]

    @property
    def late(self) -> Array:
        """How late each instant began (n) [s], where pace was kept."""
        return self._late[: int(self.d.n_late)].copy()
