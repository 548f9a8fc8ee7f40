"""Requests and formulas -> units of callable functions: recalled from the cache, or written and compiled."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.names import identifier
from symofros.base.options import Options
from symofros.base.routes import Choice, choose
from symofros.errors import CompileError
from symofros.expr.program import Function, Program
from symofros.generator.codegen.cuda import device_code
from symofros.generator.codegen.interpreted import InterpretedUnit
from symofros.generator.codegen.model import Packs, model_source, model_text
from symofros.generator.codegen.tape import tape_unit
from symofros.generator.passes import run_passes
from symofros.generator.programs import ProgramBuilder
from symofros.generator.record import GENERATOR
from symofros.mechanics.dynamics.formulas import formula_program
from symofros.mechanics.dynamics.functions import Request
from symofros.mechanics.topology.user_formulas import stated_formulas
from symofros.native import native_text
from symofros.runtime.background import BackgroundCompilation
from symofros.runtime.build.build import build_library, known_library, recall_library
from symofros.runtime.build.progress import Progress
from symofros.runtime.build.toolchain import NO_COMPILER, Toolchain
from symofros.runtime.calls.kernel import SHARED_PARAMETERS, LaneOptions, Precision, Unit
from symofros.runtime.calls.library import CompiledKernel, CompiledUnit
from symofros.runtime.cuda.device_code import DeviceCode
from symofros.runtime.functions import Key, Rate
from symofros.runtime.record import ModelRecord

# Part of a request: code for one state at a time.
_SINGLE = "one by one"


class _SolverError(Exception):
    """A function that a solver finishes has no code by vectors."""


class UnitCompiler:
    """Units of one model.

    Args:
        programs: Builder of the programs.
        record: Names, sizes and hash of the model.
        options: Options of compilation.
        toolchain: C compiler; None where units are interpreted.
        on_tape: Whether they are so by the tape machine, not by NumPy.
        background: Compiles functions that are not in the cache, which are on tape meanwhile.
    """

    def __init__(
        self,
        programs: ProgramBuilder,
        record: ModelRecord,
        options: Options,
        toolchain: Toolchain | None,
        on_tape: bool = False,
        background: BackgroundCompilation | None = None,
    ) -> None:
        self._programs, self._record, self._options, self._toolchain = programs, record, options, toolchain
        self._on_tape, self._background = on_tape, background
        # Dataclasses print every field, so that this states all that a text depends on besides the request.
        self._recipe = repr((programs.tree.system, options, np.__version__))
        self._choices_of: dict[tuple[Request, ...], dict[Key, tuple[Choice, ...]]] = {}
        # Units may be asked for by several threads: C compilers run beside each other, graphs are formed in turn.
        self._generating = threading.Lock()

    def functions(self, keys: Sequence[Key], meanwhile: Callable[[], None] | None = None) -> Unit:
        """A unit of the model's functions.

        Args:
            keys: The functions.
            meanwhile: Hook called as a C compiler starts: begins, in parallel, what else the first call needs.
        """
        requests = tuple(Request(*key) for key in keys)
        names = ", ".join(f"{name}({frame})" if frame else name for name, frame in keys)
        if self._background is not None and not self._is_known(requests):
            self._background.start(keys)
            with self._generating:
                return tape_unit(self._programs.program(requests), self._record)
        return self._unit(requests, names, lambda: self._programs.program(requests), meanwhile)

    def by_vectors(self, keys: Sequence[Key], functions: Collection[str]) -> Unit:
        """A unit of some functions of a program that evaluates several states at a time.

        Raises:
            CompileError: There is no C compiler, or it failed.
        """
        if self._toolchain is None:
            raise CompileError(NO_COMPILER)
        requests, chosen = tuple(Request(*key) for key in keys), tuple(functions)

        def program() -> Program:
            whole = self._programs.program(requests)
            return replace(whole, functions=tuple(f for f in whole.functions if f.name in chosen))

        names, lanes = f"{', '.join(chosen)} by vectors", SHARED_PARAMETERS
        return self._compile((requests, lanes, chosen), names, program, self._toolchain, lanes)

    def formulas(self, formulas: Sequence[Any], derivatives: bool, reactions: bool) -> Unit:
        """A unit of one function, "formulas": numbers, texts or SymPy expressions over the model's names."""
        values = self._stated(formulas, reactions)
        return self._unit((values, derivatives), "formulas", lambda: self._of_stated(values, derivatives))

    def formulas_source(self, formulas: Sequence[Any], c_name: str, reactions: bool) -> str:
        """C text of one function, "formulas", of (q, v, u, t): the values of formulas over the model's names."""
        program = self._of_stated(self._stated(formulas, reactions), False)
        return model_source(program, self._record, GENERATOR, None, c_name)

    def _stated(self, formulas: Sequence[Any], reactions: bool) -> list[tuple[Any, int]]:
        """Values of formulas, and how often each is differentiated by t."""
        rates = [item if isinstance(item, Rate) else Rate(item, 0) for item in formulas]
        stated = stated_formulas(self._programs.tree, [rate.formula for rate in rates], reactions)
        return [(value, rate.order) for value, rate in zip(stated, rates, strict=True)]

    def _of_stated(self, values: Sequence[tuple[Any, int]], derivatives: bool) -> Program:
        return run_passes(formula_program(self._programs.equations(), values, derivatives))

    def library(self, requests: Sequence[Request], lanes: LaneOptions | None) -> Path:
        """The shared library of some functions, each with code by vectors beside it if there are lanes.

        Raises:
            CompileError: The C compiler failed.
        """
        assert self._toolchain is not None, "an interpreted model has no library"
        program = self._programs.program(requests)
        source = model_source(program, self._record, GENERATOR, lanes, packs=self._packs)
        return build_library(source, _header(), self._toolchain, self._options.flags)

    def device_code(self, key: Key, precision: Precision) -> DeviceCode:
        """The kernels of a function, for graphics processors; none where a solver finishes it."""
        with self._generating:
            program = self._programs.program((Request(*key),))
            return device_code(program, self._record, GENERATOR, precision)

    def routes(self, keys: Sequence[Key]) -> Mapping[Key, tuple[Choice, ...]]:
        """The methods of the functions of one unit, found as its text is written."""
        requests = tuple(Request(*key) for key in keys)
        with self._generating:
            if requests not in self._choices_of:
                program = self._programs.program(requests)
                choices = {(function.name, function.frame): function.choices for function in program.functions}
                if self._toolchain is not None:
                    choices = model_text(program, self._record, GENERATOR, packs=self._packs).choices
                    for f in program.functions:
                        choices[f.name, f.frame] += (self._batches(f),)
                self._choices_of[requests] = choices
            return self._choices_of[requests]

    def _batches(self, function: Function) -> Choice:
        """The choice of how large batches of a function are evaluated, with its reason."""
        asked = "state by state" if self._options.batch == "loop" else ""
        return choose("large batches", {"by_routine": function.solver is not None}, asked)

    @property
    def symbol(self) -> str:
        """Name of the exported function of the model's libraries."""
        return f"{identifier(self._record.name)}_model"

    @property
    def _packs(self) -> Packs:
        return "where they pay" if self._options.packs else "none"

    def _unit(
        self, request: object, names: str, form: Callable[[], Program], meanwhile: Callable[[], None] | None = None
    ) -> Unit:
        """The unit of a request, of functions of some names; its program is formed only where no library is known."""
        program = cache(form)
        if self._toolchain is None:
            with self._generating:
                return tape_unit(program(), self._record) if self._on_tape else InterpretedUnit(program())
        in_lanes = self._in_lanes(request, program) if self._options.batch == "vector" else None
        return self._compile((request, _SINGLE), names, program, self._toolchain, None, in_lanes, meanwhile)

    def _recipe_of(self, request: object) -> str:
        return f"{self._recipe}{request!r}"

    def _is_known(self, requests: tuple[Request, ...]) -> bool:
        """Whether there is no compiler to wait for."""
        assert self._toolchain is not None
        recipe = self._recipe_of((requests, _SINGLE))
        return known_library(recipe, _header(), self._toolchain, self._options.flags) is not None

    def _compile(
        self,
        request: object,
        names: str,
        program: Callable[[], Program],
        toolchain: Toolchain,
        lanes: LaneOptions | None,
        in_lanes: Callable[[Key, LaneOptions], CompiledKernel | None] | None = None,
        meanwhile: Callable[[], None] | None = None,
    ) -> CompiledUnit:
        progress = Progress(self._record.name, names)

        def source() -> str:
            with self._generating:
                progress.begin("generating")
                # Of a unit on vectors, the code for one state is hardly called.
                packs: Packs = self._packs if lanes is None else "none"
                whole = None if lanes is None else replace(lanes, are_all=True)
                text = model_source(program(), self._record, GENERATOR, whole, packs=packs)
            progress.begin("compiling")
            if meanwhile is not None:
                meanwhile()
            return text

        with progress:
            recipe = self._recipe_of(request)
            path = recall_library(recipe, source, _header(), toolchain, self._options.flags)
        return CompiledUnit(path, self.symbol, self._record.hash, in_lanes)

    def _in_lanes(
        self, request: object, program: Callable[[], Program]
    ) -> Callable[[Key, LaneOptions], CompiledKernel | None]:
        """Compiles one function of a unit by vectors when asked for; None for a function that a solver finishes."""

        def compile_in_lanes(key: Key, lanes: LaneOptions) -> CompiledKernel | None:
            def alone() -> Program:
                function = next(f for f in program().functions if (f.name, f.frame) == key)
                if self._batches(function).method != "lanes":
                    raise _SolverError
                return replace(program(), functions=(function,))

            if self._toolchain is None:
                return None
            names = f"{key[0]} by vectors"
            try:  # The program is formed only where no library is known.
                return self._compile((request, lanes, key), names, alone, self._toolchain, lanes).compiled[key]
            except _SolverError:
                return None

        return compile_in_lanes


def _header() -> str:
    return native_text("model/symofros_model.h")
