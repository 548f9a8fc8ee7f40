"""Our side: generated C, state by state as a control loop calls it, and by its batches."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

import symofros as sf
from symofros.tools import Precision, count_program, find_toolchain, fixed_step_loop

from ...mechanics.geometry import Array
from ..record import Cost
from ..task import START, STEP, Loop, Task
from .arrays import Arrays, Turns, loops
from .blocks import Blocks
from .programs import BuildError, Compiler, build, copies, source


class Library:
    """The library of one model, its parameters at their defaults.

    Args:
        path: File of the library.
        symbol: Name of what it exports.

    Attributes:
        model: Its `sym_model`.
        pre: What its functions take of the parameters (npre,).
    """

    def __init__(self, path: Path, symbol: str) -> None:
        ffi, _ = loops()
        self._library = ctypes.CDLL(str(path))  # Stays loaded as long as this.
        address = ctypes.cast(self._library[symbol], ctypes.c_void_p).value
        self.model: Any = ffi.cast("const sym_model *(*)(void)", address)()
        pre = np.zeros(self.model.npre + 1)
        self.model.init(self.model.par_default, ffi.from_buffer("double[]", pre))
        self.pre = pre[: self.model.npre]

    @property
    def names(self) -> list[str]:
        """Names of its functions, in their order."""
        functions = self.model.functions[0 : self.model.n_functions]
        return [loops()[0].string(entry.name).decode() for entry in functions]

    def arrays(self, given: Mapping[str, Array], number: int = 0) -> Arrays:
        """Inputs and outputs of a function: inputs that are not given are zero."""
        entry = self.model.functions[number]
        inputs = [
            given.get(loops()[0].string(item.name).decode(), np.zeros(item.rows * item.cols))
            for item in getattr(entry, "in")[0 : entry.n_in]  # A keyword of Python.
        ]
        sizes = [item.rows * item.cols for item in entry.out[0 : entry.n_out]]
        return Arrays(inputs, sizes, (int(entry.work), 0))


NAME = "symofros"
BATCH = "symofros, batch"
COLUMNS = "symofros, batch by columns"
SINGLE = "symofros, batch of floats by columns"
# States in a call of a batch: their results stay in the second cache, beside the code, as those of engines stay in the
# first; whole vectors of either precision.
BLOCK, _MIN_BLOCK, _KEPT = 64, 16, 3 << 17
# How many of a function's outputs engines have, too: Q, multipliers and derivatives by u are ours alone.
_SHARED = {
    "dynamics": 2,
    "forward_dynamics": 1,
    "forward_dynamics_derivatives": 2,
    "inverse_dynamics_vjp": 2,
    "forward_dynamics_vjp": 2,
}
# More than any race steps through [s].
_ENDLESS = 1e6
# Speeds up to which derivatives of forward dynamics are timed by vectors: beyond, their code takes minutes to compile,
# and of long chains a solver finishes them.
MAX_BY_VECTORS = 10


def our_loops(task: Task, functions: Sequence[str]) -> Iterator[Loop]:
    """Loops over our functions: state by state and, where there is code for it, by vectors, or of floats.

    Raises:
        SymofrosError: The model can't be compiled.
    """
    for name in functions:
        if name == "step":
            yield _steps(task)
            continue
        yield _by_state(task, name)
        if _by_vectors(task, name):
            yield _by_rows(task, name)
            yield _by_columns(task, name, COLUMNS, "double")
            yield _by_columns(task, name, SINGLE, "single")


def _by_vectors(task: Task, name: str) -> bool:
    """Whether a function is timed by vectors: where a solver finishes it state by state, there is no such code."""
    is_long = name == "forward_dynamics_derivatives" and task.assembly.nv > MAX_BY_VECTORS
    return not (task.system.constraints or is_long)


def _frames(task: Task, name: str) -> tuple[str, ...]:
    return (task.frame,) if name.startswith("frame") else ()


class _Generated:
    """A function in its library, at the states of a task."""

    def __init__(
        self, task: Task, name: str, batch: Literal["vector", "loop"], precision: Precision = "double"
    ) -> None:
        options = sf.Options((name,), _frames(task, name), batch=batch)
        sf.compile_library(task.system, options, precision)
        start = time.thread_time()  # Now that the library is in the cache, what is left is to make its text.
        self.path, symbol = sf.compile_library(task.system, options, precision)
        self.seconds = time.thread_time() - start
        self._libraries = [Library(copy, symbol) for copy in copies(self.path)]
        self.functions: list[Any] = [each.model.functions + 0 for each in self._libraries]
        self.lanes: list[Any] = [each.model.lanes for each in self._libraries]
        states = task.states
        given = {"pre": self._libraries[0].pre, "q": states.q, "v": states.v, "a": states.a, "u": states.u}
        given |= {"tau_bar": states.applied, "a_bar": states.a}  # Cotangents: any numbers, CasADi's as well.
        self.arrays = self._libraries[0].arrays(given)
        fitting = _KEPT // (8 * max(1, sum(self.arrays.sizes))) // _MIN_BLOCK * _MIN_BLOCK
        self.block = min(BLOCK, len(task.states), max(_MIN_BLOCK, fitting))


def _by_state(task: Task, name: str) -> Loop:
    made, native = _Generated(task, name, "loop"), loops()[1]
    filled = made.arrays.overwritten()
    run = Turns([partial(native.loop_eval, function, filled) for function in made.functions])

    def results() -> Array:
        return made.arrays.results(lambda kept: native.loop_eval(made.functions[0], kept, 1), _SHARED.get(name))

    return Loop(name, NAME, run, results, _cost(task, name, made))


def _by_columns(task: Task, name: str, variant: str, precision: Precision) -> Loop:
    made, native = _Generated(task, name, "vector", precision), loops()[1]
    dtype = np.float32 if precision == "single" else np.float64
    blocks = Blocks(made.arrays.inputs, made.arrays.sizes, made.arrays.scratch[0], made.block, dtype)
    filled = blocks.overwritten()

    def results() -> Array:
        return blocks.results(lambda kept: native.loop_lanes(made.lanes[0], kept, 1), _SHARED.get(name))

    return Loop(name, variant, Turns([partial(native.loop_lanes, lanes, filled) for lanes in made.lanes]), results)


def _by_rows(task: Task, name: str) -> Loop:
    made, native = _Generated(task, name, "vector"), loops()[1]
    block = made.block
    filled = made.arrays.overwritten(block)

    def call(function: Any, rounds: int) -> None:
        native.loop_batch(function, filled, rounds, block)

    def results() -> Array:
        return made.arrays.results(lambda kept: native.loop_batch(made.functions[0], kept, 1, block), _SHARED.get(name))

    return Loop(name, BATCH, Turns([partial(call, function) for function in made.functions]), results)


def _cost(task: Task, name: str, made: _Generated) -> Cost:
    program = sf.program_of(task.system, (name,), _frames(task, name))
    counted = next(count for (stated, _), count in count_program(program).items() if stated == name)
    toolchain = find_toolchain()
    if toolchain is None:
        raise BuildError("no C compiler was found: install gcc or clang")
    # Compiled once more, by the compiler and the flags that it is used with, for the time and the sizes.
    text = made.path.with_suffix(".c").read_text(encoding="utf-8")
    sources = {"model.c": text, "symofros_model.h": source("symofros_model.h")}
    compiler = Compiler(toolchain.command[0], "", toolchain.identity)
    built = build(compiler, sources, (*toolchain.command[1:], *toolchain.default_flags, "-std=gnu99"))
    return Cost(
        made.seconds, built.seconds, len(text), built.text, built.constants, asdict(counted), made.arrays.memory
    )


def _steps(task: Task) -> Loop:
    """Our loop of RK4 in C, as many steps as there are states; a race goes on from where the last round ended."""
    model = sf.compile(task.system)
    q, v, steps = task.states.q[START], task.states.v[START], len(task.states)
    stepper = fixed_step_loop(model, "rk4", STEP, steps, _ENDLESS)

    def run(rounds: int) -> None:
        for _ in range(rounds):
            stepper.advance(steps)
            stepper.run.n_records = 0

    def results() -> Array:
        stepper.run.t = 0.0
        stepper.start(q, v, 8)
        run(1)
        _, q_end, v_end = stepper.state
        return np.concatenate([q_end, v_end])[None]

    return Loop("step", NAME, run, results)
