"""Functions that are interpreted in C: tapes, the sym_model that the tape machine makes of them, and its library."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain
from typing import Any

import numpy as np

from symofros.errors import CompileError
from symofros.runtime.build.prebuilt import machine_library
from symofros.runtime.build.toolchain import DEFAULT_FLAGS
from symofros.runtime.calls.declarations import interface, model_abi
from symofros.runtime.calls.library import ModelUnit
from symofros.runtime.record import ModelRecord

# Each operation rounds once, whatever the processor could do at once.
_FLAGS = (*DEFAULT_FLAGS, "-O3", "-ffp-contract=off")
# Of slots; a model that is collected meanwhile gives its own back in the same thread.
_LOCK = threading.RLock()


@dataclass(frozen=True)
class Tape:
    """Some outputs as instructions (native/tape/symofros_tape.h).

    Attributes:
        code: Operation, and the words behind it.
        numbers: Values of the first registers.
        registers: Number of registers.
        inputs: Number of inputs.
        sizes: Doubles of each output.
    """

    code: tuple[tuple[str, Sequence[int]], ...]
    numbers: tuple[float, ...]
    registers: int
    inputs: int
    sizes: tuple[int, ...]


@dataclass(frozen=True)
class Routine:
    """How a routine of native/model finishes a function, with its arguments as the routine has them."""

    name: str
    parts: tuple[Tape, ...]
    nq: int
    nv: int
    nc: int
    extra: int
    columns: tuple[int, ...]
    measures: tuple[tuple[int, ...], ...]
    work: int


@dataclass(frozen=True)
class TapeFunction:
    """A function of a model.

    Attributes:
        name: Name.
        frame: The frame it is about, or "".
        inputs: Name and shape of each input but "pre".
        outputs: Name and shape of each output.
        tape: Its outputs, or the terms of its routine.
        routine: Routine that finishes it, if one does.
    """

    name: str
    frame: str
    inputs: tuple[tuple[str, tuple[int, ...]], ...]
    outputs: tuple[tuple[str, tuple[int, ...]], ...]
    tape: Tape
    routine: Routine | None


@cache
def tape_machine(source: str) -> Any:
    """The library that interprets tapes, loaded.

    Raises:
        CompileError: There is no C compiler, and no library came with the package.
    """
    return interface().dlopen(str(machine_library(source, _FLAGS)))


class TapeUnit(ModelUnit):
    """Functions as tapes, behind the interface of a compiled library.

    Args:
        machine: The library that interprets them.
        init: The parameters' part.
        functions: The functions.
        record: Names, sizes and hash of the model.

    Raises:
        CompileError: The machine holds as many functions as it can.
    """

    def __init__(self, machine: Any, init: Tape, functions: Sequence[TapeFunction], record: ModelRecord) -> None:
        self._library, self._kept = machine, list[Any]()
        self._slots = list[int]()
        self._release = weakref.finalize(self, _release, self._library, self._slots)
        ffi = self.ffi = interface()
        made = self._own("sym_function[]", len(functions))
        for row, function in zip(made, functions, strict=True):
            self._fill(row, function)
        model = self._own("sym_model *")
        model.abi, model.size = model_abi(), ffi.sizeof("sym_model")
        model.name, model.hash, model.generator = map(self._text, (record.name, record.hash, "tape"))
        for name in ("q", "v", "u", "par"):
            names = getattr(record, f"{name}_names")
            setattr(model, f"n{name}", len(names))
            setattr(model, f"{name}_names", self._own("const char *[]", list(map(self._text, names)) or [ffi.NULL]))
        model.nc, model.npre = record.nc, init.sizes[0]
        model.par_default = self._own("double[]", list(record.par_default) or 1)
        model.q_neutral = self._own("double[]", list(record.q_neutral) or 1)
        model.n_functions, model.functions = len(functions), made
        self._library.sym_tape_bind_parameters(self._place(self._plain(init)), model)
        super().__init__(model)

    @property
    def _sizes(self) -> Mapping[str, int]:
        sizes: Mapping[str, int] = self.ffi.typeof("enum sym_tape_sizes").relements
        return sizes

    def _own(self, kind: str, value: Any = None) -> Any:
        """Memory of C that lives as long as this unit."""
        self._kept.append(self.ffi.new(kind, value))
        return self._kept[-1]

    def _text(self, text: str) -> Any:
        return self._own("char[]", text.encode())

    def _fill(self, row: Any, function: TapeFunction) -> None:
        """The row of a function in the model's table."""
        inputs = [("pre", (1,)), *function.inputs]
        row.name = self._text(function.name)
        row.frame = self._text(function.frame) if function.frame else self.ffi.NULL
        row.n_in, row.n_out = len(inputs), len(function.outputs)
        setattr(row, "in", self._arrays(inputs))  # A keyword of Python.
        row.out = self._arrays(function.outputs)
        width = self._sizes["SYM_TAPE_WIDTH"]
        routine = function.routine
        row.work = function.tape.registers * width if routine is None else routine.work
        tape = self._plain(function.tape) if routine is None else self._finished(function, routine)
        self._library.sym_tape_bind(self._place(tape), self.ffi.addressof(row))

    def _arrays(self, arrays: Sequence[tuple[str, tuple[int, ...]]]) -> Any:
        assert len(arrays) <= self._sizes["SYM_TAPE_ARRAYS"]
        rows = [(self._text(name), len(shape), *(*shape, 1, 1)[:2]) for name, shape in arrays]
        return self._own("sym_array[]", rows or 1)

    def _plain(self, tape: Tape) -> Any:
        """The tape in C."""
        codes, names = self.ffi.typeof("enum sym_tape_operation").relements, _PREFIX
        words = chain.from_iterable((codes[names + name], *rest) for name, rest in tape.code)
        code = np.fromiter(chain(words, (codes[f"{names}END"],)), dtype=np.uint32)
        self._kept.append(code)
        made = self._own("sym_tape *")
        made.code = self.ffi.cast("uint32_t *", self.ffi.from_buffer(code))
        made.numbers = self._own("double[]", list(tape.numbers) or 1)
        made.sizes = self._own("int32_t[]", list(tape.sizes) or 1)
        made.n_numbers, made.n_registers = len(tape.numbers), tape.registers
        made.n_in, made.n_out = tape.inputs, len(tape.sizes)
        return made

    def _finished(self, function: TapeFunction, routine: Routine) -> Any:
        """A function that a routine finishes, in C."""
        made = self._own("sym_tape *")
        made.routine = self.ffi.typeof("enum sym_tape_routine").relements[_PREFIX + routine.name.upper()]
        made.sizes = self._own("int32_t[]", [int(np.prod(shape)) for _, shape in function.outputs])
        made.n_in, made.n_out = function.tape.inputs, len(function.outputs)
        made.terms = self._place(self._plain(function.tape))
        made.parts = [self._place(self._plain(part)) for part in routine.parts]
        made.nq, made.nv, made.nc, made.extra = routine.nq, routine.nv, routine.nc, routine.extra
        made.columns = self._own("int32_t[]", list(routine.columns) or 1)
        for name, table in zip(("group", "unit", "speed"), routine.measures, strict=True):
            setattr(made, name, self._own("short[]", list(table) or 1))
        return made

    def _place(self, tape: Any) -> int:
        """The slot of a tape, until this unit is gone."""
        slot = self._free_slot(tape)
        if slot < 0:
            gc.collect()  # Models that are gone may wait for it: their functions refer to each other.
            slot = self._free_slot(tape)
        if slot < 0:
            most = self._sizes["SYM_TAPE_SLOTS"]
            raise CompileError(
                "there is no room for another function on tape",
                f"{most} functions and parts of functions are held",
                f"a process holds at most {most} at a time",
                "let go of models that are not used any more, or compile with backend='c'",
            )
        self._slots.append(slot)
        return slot

    def _free_slot(self, tape: Any) -> int:
        with _LOCK:
            return int(self._library.sym_tape_place(tape))


_PREFIX = "SYM_TAPE_"


def _release(library: Any, slots: Sequence[int]) -> None:
    with _LOCK:
        for slot in slots:
            library.sym_tape_release(slot)
