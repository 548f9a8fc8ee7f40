"""The pipeline on one page.

| stage | from | to |
|---|---|---|
| tree_with_events | System | SpanningTree, or all errors: numbered links, named frames, indices of q, v, u, par |
| model_record | SpanningTree | ModelRecord: names, sizes, defaults, limits |
| form_program | SpanningTree, requests | Program: named functions over one expression graph (Jourdain) |
| run_passes | Program | Program: staged, verified |
| model_source | Program, ModelRecord | C text |
| build_library | C text | shared library, cached by content; recalled without the text where it is known |
| Model | libraries, or programs | callable functions |

`Compilation` holds what each stage makes, formed once and when it is first asked for. The stages in between lie in
`symofros/generator/`: programs.py forms and optimises, units.py writes and compiles.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any

from symofros.base.arguments import check_argument
from symofros.base.options import Options
from symofros.description.system import System
from symofros.errors import CompileError, CompilerMissingWarning, DescriptionError, InconsistentModelWarning, Problem
from symofros.expr.program import Program
from symofros.generator.beams import beams_at, held_beams, may_be_held
from symofros.generator.codegen.cuda import device_code
from symofros.generator.codegen.model import model_source
from symofros.generator.codegen.tape import machine_text
from symofros.generator.instants import MechanismInstants, has_instants
from symofros.generator.passes.count import Operations, count_program
from symofros.generator.programs import ProgramBuilder, requested
from symofros.generator.record import GENERATOR as GENERATOR
from symofros.generator.record import model_record
from symofros.generator.units import UnitCompiler
from symofros.mechanics.dynamics.functions import Request
from symofros.mechanics.topology.beams import (
    massless_shear,
    omitted_rotary_inertia,
    omitted_shear,
    omitted_warping,
    polar_mismatch,
)
from symofros.mechanics.topology.events import tree_with_events
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.remarks import remarks
from symofros.mechanics.topology.run_time import RunTimeCheck
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.background import BackgroundCompilation
from symofros.runtime.beams import ElasticBeam
from symofros.runtime.build.prebuilt import prebuilt_library
from symofros.runtime.build.toolchain import NO_COMPILER, Toolchain, find_toolchain
from symofros.runtime.calls.kernel import Array, LaneOptions, Precision, Unit
from symofros.runtime.cuda.device_code import DeviceCode
from symofros.runtime.functions import Key
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord
from symofros.runtime.stateful import stated


def compile_system(system: System, options: Options | None = None) -> Model:
    """Derive a system's equations of motion, generate C, compile it, load it.

    Args:
        system: System as the user stated it.
        options: Options: what to generate and how; the defaults serve most.

    Raises:
        DescriptionError: The system can't be a mechanism; every problem is listed.
        UnknownNameError: `options` names a function or frame that does not exist.
        CompileError: The C compiler failed on functions that `options` names, or there is none of its name; that of
            others is raised when they are first called.
    """
    return stated(Compilation(system, options).model())


def _compile_carried(system: System, options: Options) -> Model:
    """The model with its states of forces, where it has some, among its speeds."""
    return Compilation(system, options).model()


def compile_library(
    system: System, options: Options | None = None, precision: Precision = "double"
) -> tuple[Path, str]:
    """The shared library of a system, for programs that call C themselves.

    Args:
        system: System as the user stated it.
        options: Options: what to generate; backend "c".
        precision: Precision of the lanes of functions by vectors (`sym_lanes`); "single": of batches by rows, too.

    Returns:
        Path of the library in the cache, and the name of its exported function (see symofros_model.h).

    Raises:
        DescriptionError: The system can't be a mechanism.
        CompileError: There is no C compiler, or it failed.
    """
    check_argument("compile_library: precision", precision, Precision)
    return Compilation(system, options).library(precision)


def program_of(system: System, functions: Iterable[str], frames: Iterable[str] = ()) -> Program:
    """The graph of some functions of a system, for tools that look inside: counts, mutations, other evaluators.

    Args:
        system: System as the user stated it.
        functions: Names of model and frame functions.
        frames: Frames of the frame functions.

    Raises:
        DescriptionError: The system can't be a mechanism.
        UnknownNameError: No such function or frame.
    """
    check_argument("program_of: functions", functions, Iterable[str])
    check_argument("program_of: frames", frames, Iterable[str])
    return Compilation(system, Options(tuple(functions), tuple(frames))).program


class Compilation:
    """One system under one set of options; each stage is formed once, when it is first asked for.

    Args:
        system: System as the user stated it.
        options: Options: what to generate and how; the defaults serve most.
    """

    def __init__(self, system: System, options: Options | None = None) -> None:
        if not isinstance(system, System):
            remedy = "build a sf.System"
            if isinstance(system, str | Path):
                remedy = f"sf.compile(sf.load({str(system)!r:.60}))"
            elif isinstance(system, Model):
                remedy = "give the sf.System that the model was compiled from"
            stated = f"{type(system).__name__} {system!r:.60}"
            raise DescriptionError("there is no system to compile", stated, "a system is a sf.System", remedy)
        check_argument("options", options, Options | None)
        self.system, self._stated = system, options or Options()
        # Of the stages, none depends on when C is compiled.
        self.options = replace(self._stated, background=False)
        self._further: tuple[Request, ...] = ()

    @cached_property
    def tree(self) -> SpanningTree:
        """The system, checked and numbered."""
        return tree_with_events(self.system)

    @property
    def requests(self) -> tuple[Request, ...]:
        """The functions that are generated at once."""
        return requested(self.tree, self.options) + self._further

    def request(self, functions: Iterable[str], frames: Iterable[str] = ()) -> None:
        """Generate further functions at once.

        Args:
            functions: Names of model and frame functions.
            frames: Frames of the frame functions.

        Raises:
            UnknownNameError: No such function or frame.
        """
        self._further += requested(self.tree, Options(tuple(functions), tuple(frames)))

    @cached_property
    def record(self) -> ModelRecord:
        """The record of the model: everything except its functions."""
        return model_record(self.tree, self.options)

    @cached_property
    def programs(self) -> ProgramBuilder:
        """The builder of programs for the tree."""
        return ProgramBuilder(self.tree, self.options)

    @property
    def has_instants(self) -> bool:
        """Whether formulas of time bend, jump or change fast at instants, which steps of a run end at."""
        return has_instants(self.tree)

    def beams(self, par: Array) -> tuple[ElasticBeam, ...]:
        """The elastic beams at run-time parameters (npar)."""
        return self._beams_at(par)

    @cached_property
    def _beams_at(self) -> Callable[[Array], tuple[ElasticBeam, ...]]:
        return beams_at(self.tree)

    def parameter_problems(self, par: Array) -> list[Problem]:
        """Problems of the first invalid set of run-time parameters among some (m, npar); [] if all are valid."""
        return self._parameter_check.problems(par)

    @cached_property
    def _parameter_check(self) -> RunTimeCheck:
        return RunTimeCheck(self.system, self.record.par_names)

    @property
    def program(self) -> Program:
        """The requested functions, optimised."""
        return self.programs.program(self.requests)

    @property
    def operations(self) -> dict[Key, Operations]:
        """Operations of each requested function, keyed by (name, frame), and of the stage "init"."""
        return count_program(self.program)

    def device_code(self, precision: Precision, c_name: str) -> DeviceCode:
        """The requested functions as kernels for graphics processors; see `source`."""
        return device_code(self.program, self.record, GENERATOR, precision, c_name)

    def source(self, c_name: str | None = None, lanes: LaneOptions | None = None) -> str:
        """C text of the requested functions.

        Args:
            c_name: Prefix of C symbols; made of the model's name by default.
            lanes: Options of batches by vectors; None: batches are loops over states.
        """
        return model_source(self.program, self.record, GENERATOR, lanes, c_name)

    def formulas_source(self, formulas: Sequence[Any], c_name: str, reactions: bool = False) -> str:
        """C text of one function, "formulas", of (q, v, u, t): the values of formulas over the model's names.

        Those that use multipliers, wrenches of constraints or reactions of joints, where they may, are of a and lam.
        """
        return self._units(None).formulas_source(formulas, c_name, reactions)

    def model(self) -> Model:
        """The functions that the options name, callable; where they name none, each is generated when first called."""
        chosen = self.requests  # A description that can't be a mechanism is refused here, not at the first call.
        noted = (text for text in remarks(self.system) if text not in self.system.notes)
        for text in (*inconsistencies(self.system), *noted, *self._held_beams()):
            warnings.warn(text, InconsistentModelWarning, stacklevel=3)
        toolchain, on_tape = _choose_toolchain(self.options)
        background = None
        if self._stated.background and toolchain is not None:
            background = BackgroundCompilation(partial(_compile_carried, self.system, self.options))
        units = self._units(toolchain, on_tape, background)
        if self.options.functions is None:
            return self._model(units, units.functions, background=background)
        return self._model(units, None, units.functions(chosen), background=background)

    def _held_beams(self) -> Iterator[str]:
        """Messages about beams that a loop holds along an axis in which they do not stretch."""
        if may_be_held(self.tree):
            wanted = requested(self.tree, Options(("constraint", "constraint_jacobian")))
            units = self._units(None)
            yield from held_beams(self.tree, self._model(units, None, units.functions(wanted)))

    def model_by_vectors(self, functions: Collection[str]) -> Model:
        """Some of the requested functions, which C evaluates for several states at a time, in one library."""
        units = self._units(find_toolchain(self.options.compiler))
        return self._model(units, None, units.by_vectors(self.requests, functions), tell=False)

    def interpreted_model(self) -> Model:
        """The requested functions on the NumPy interpreter, by the program that C is written of."""
        units = self._units(None)
        return self._model(units, None, units.functions(self.requests))

    def _units(
        self, toolchain: Toolchain | None, on_tape: bool = False, background: BackgroundCompilation | None = None
    ) -> UnitCompiler:
        return UnitCompiler(self.programs, self.record, self.options, toolchain, on_tape, background)

    def _model(
        self,
        units: UnitCompiler,
        on_demand: Callable[[Sequence[Key], Callable[[], None] | None], Unit] | None,
        *made: Unit,
        tell: bool = True,
        background: BackgroundCompilation | None = None,
    ) -> Model:
        return Model(
            self.record,
            on_demand,
            made,
            formulas=units.formulas,
            beams=self._beams_at,
            parameter_check=self._parameter_check.problems,
            origin=partial(_compile_carried, self.system, self._stated),
            device_code=units.device_code,
            instants=MechanismInstants(self.tree),
            routes=units.routes if tell else None,
            background=background,
        )

    def library(self, precision: Precision = "double") -> tuple[Path, str]:
        """Path and exported function of the shared library of the requested functions: see `compile_library`."""
        toolchain = find_toolchain(self.options.compiler)
        if toolchain is None:
            raise CompileError(NO_COMPILER)
        units = self._units(toolchain)
        lanes = LaneOptions(precision=precision) if self.options.batch == "vector" else None
        return units.library(self.requests, lanes), units.symbol


def inconsistencies(system: System) -> Iterator[str]:
    """Warnings about beams: moments of no section, rotary inertia and shear that do not count, softening by spin."""
    beams = system.beams
    if not beams:
        return
    numbers = Numbers(system)
    for body in beams:
        for label, mode, share in omitted_rotary_inertia(body, numbers):
            yield (
                f"beam '{body.name}': {label} is stated and does not count, as rotary_inertia is false: it would lower"
                f" the frequency of bending mode {mode} by {share:.1%}. Set rotary_inertia: true, or state no {label}."
            )
        mismatch = polar_mismatch(body, numbers)
        if mismatch is not None:
            yield (
                f"beam '{body.name}': rhoJ = {mismatch[0]:.4g}, but rhoI_y + rhoI_z = {mismatch[1]:.4g} kg m: the polar"
                " moment of a section is their sum. Mend the one that is wrong, such as one in another unit."
            )
        for plane, mode, share, more in omitted_shear(body, numbers):
            yield (
                f"beam '{body.name}': its sections do not shear in bend_{plane}: of the depth that its inertia shows,"
                f" that would lower the frequency of mode {mode} there by about {share:.1%}, and add {more:.1%} to the"
                f" deflection under a load at the tip. State theory: strain, shear_{plane}: 1 or more, and GA_{plane}."
            )
        warping = omitted_warping(body, numbers)
        if warping is not None:
            yield (
                f"beam '{body.name}': it bends {warping[0]:.0f} times as stiffly as it twists, as sections of open thin"
                " walls do, and warping has no part in its equations: if they warp (an I or a channel, not an L, a T or"
                f" a cross), a root that holds warping lowers the twist of the tip by about {warping[1]:.1%}, and"
                " raises loads that buckle it sideways. State GJ as torque times length over twist, as it is held."
            )
        for plane, across in massless_shear(body):
            yield (
                f"beam '{body.name}': functions of bend_{plane} and shear_{plane} together move no mass, as a shear can"
                " undo the slope of bending: the mass matrix is singular, and there are equilibria, but no motion and"
                f" no modes. Set rotary_inertia: true, with rhoI_{across}, or shear_{plane}: 1."
            )
        if not body.foreshortening and body.retain == "first_order" and body.modes:
            yield (
                f"beam '{body.name}': first order without foreshortening keeps the softening of a spinning beam and"
                " drops its stiffening: it diverges at its first natural frequency. For studies only; otherwise turn"
                " foreshortening on, or use retain: zeroth_order."
            )


def _choose_toolchain(options: Options) -> tuple[Toolchain | None, bool]:
    """The compiler, None where there is none or an interpreter is asked for; and whether that is the tape machine."""
    if options.backend != "c":
        return None, options.backend == "tape"
    toolchain = find_toolchain(options.compiler)
    if toolchain is None:
        on_tape = prebuilt_library(machine_text()) is not None
        slower = "in C, several" if on_tape else "by NumPy, some thousand"
        warnings.warn(
            f"no C compiler found: models are interpreted {slower} times slower than compiled ones."
            " Install gcc or clang, or `pip install ziglang`.",
            CompilerMissingWarning,
            stacklevel=4,
        )
        return None, on_tape
    if toolchain.is_fallback:
        _warn_fallback()
    return toolchain, False


@cache
def _warn_fallback() -> None:
    """Warn once a process that the slower-compiling fallback is in use."""
    warnings.warn(
        "no system C compiler found: using the ziglang package, which compiles more slowly. Install gcc or clang.",
        CompilerMissingWarning,
        stacklevel=5,
    )
