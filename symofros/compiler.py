"""The pipeline on one page.

| stage | from | to |
|---|---|---|
| graph.check | System | the same, or every error found |
| build_tree | System | SpanningTree: numbered links, named frames, indices of q, v, u, par |
| write_program | SpanningTree, requests | Program: named functions over one expression graph (Jourdain) |
| run_passes | Program | Program: staged, verified |
| model_source | Program | C text |
| build_library | C text | shared library, cached by content; recalled without the text where it is known |
| Model | libraries, or programs | callable functions |
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from symofros.description.beam import Beam
from symofros.description.constraints import AXES, Closure
from symofros.description.system import System
from symofros.description.values import as_value
from symofros.errors import (
    CompileError,
    CompilerMissingWarning,
    DescriptionError,
    InconsistentModelWarning,
    Problem,
    UnknownNameError,
    did_you_mean,
)
from symofros.expr.expression import evaluate
from symofros.expr.program import Program
from symofros.generator.codegen.dispatch import dispatch_source
from symofros.generator.codegen.effort import cheapest
from symofros.generator.codegen.interpreted import InterpretedUnit
from symofros.generator.codegen.model import model_source
from symofros.generator.codegen.names import identifier
from symofros.generator.passes import run_passes
from symofros.mechanics.beams.deformation import small_coordinates
from symofros.mechanics.dynamics.formulas import formula_program
from symofros.mechanics.dynamics.functions import Request, methods, write_program
from symofros.mechanics.dynamics.wrenches import acts_on_bodies
from symofros.mechanics.kinematics.joint import neutral_coordinates
from symofros.mechanics.topology.coordinates import angles, joint_sizes
from symofros.mechanics.topology.graph import check
from symofros.mechanics.topology.tree import SpanningTree, build_tree, frame_of
from symofros.native import native_text
from symofros.options import FRAME_FUNCTIONS, MODEL_FUNCTIONS, Options
from symofros.runtime.build import build_library, recall_library
from symofros.runtime.functions import Rate
from symofros.runtime.kernel import Lanes, Precision, Unit
from symofros.runtime.library import CompiledKernel, CompiledUnit
from symofros.runtime.model import Key, Model
from symofros.runtime.record import ClosureRecord, ModelRecord, Segment
from symofros.runtime.toolchain import NO_COMPILER, Toolchain, find_toolchain
from symofros.runtime.tuning import Build, builds, fastest

GENERATOR = "symofros 0.1.0"
_EAGER = (Request("dynamics"),)
_FORWARD = (Request("forward_dynamics"),)


def compile_system(system: System, options: Options | None = None) -> Model:
    """Derive a system's equations of motion, generate C, compile it, load it.

    Args:
        system: What the user stated.
        options: What to generate and how; the defaults serve most.

    Raises:
        DescriptionError: The system can't be a mechanism; every problem is listed.
        UnknownNameError: `options` names a function or frame that does not exist.
        CompileError: The C compiler failed.
    """
    options = options or Options()
    tree = plan(system)
    requests = requested(tree, options)
    _warn_inconsistent(system)
    record = describe(tree, options)
    builder = _Builder(tree, record, options)
    first = builder.functions(tuple(requests))
    return Model(record, builder.functions if options.functions is None else None, (first,), formulas=builder.formulas)


def plan(system: System) -> SpanningTree:
    """Check a system and number it.

    Raises:
        DescriptionError: With every problem found.
    """
    check(system)
    return build_tree(system)


def compile_library(
    system: System, options: Options | None = None, precision: Precision = "double"
) -> tuple[Path, str]:
    """The shared library of a system, for programs that call C themselves.

    Args:
        system: What the user stated.
        options: What to generate; backend "c".
        precision: Of the lanes of functions by vectors (`sym_lanes`); "single": of batches by rows, too.

    Returns:
        Path of the library in the cache, and the name of its exported function (see symofros_model.h).

    Raises:
        DescriptionError: The system can't be a mechanism.
        CompileError: There is no C compiler, or it failed.
    """
    options = options or Options()
    toolchain = find_toolchain(options.compiler)
    if toolchain is None:
        raise CompileError(NO_COMPILER)
    tree = plan(system)
    record = describe(tree, options)
    program, _ = generate(tree, requested(tree, options), record, options.constraints, options.forward_dynamics)
    symbol = f"{identifier(record.name)}_model"
    lanes = Lanes(precision=precision) if options.batch == "vector" else None

    def made(build: Build) -> Path:
        source = model_source(program, record, GENERATOR, lanes, packs=build.packs)
        how = build.toolchain, build.flags, _dispatch(options, symbol), symbol
        return build_library(source, native_text("model/symofros_model.h"), *how)

    return _chosen(made, options, toolchain, lanes, symbol, record.hash), symbol


def _chosen(
    made: Callable[[Build], Path], options: Options, toolchain: Toolchain, vectors: Lanes | None, symbol: str, of: str
) -> Path:
    """The library as the options have it, or the fastest of several."""
    if not options.tune:
        return made(Build(toolchain, options.flags, options.packs))
    first, *others = builds(options, toolchain, vectors is not None)
    libraries = [made(first)]
    for build in others:
        with suppress(CompileError):  # It was only worth a try.
            libraries.append(made(build))
    return fastest(libraries, lambda path: CompiledUnit(path, symbol, native_text("model/symofros_model.h"), of))


def _dispatch(options: Options, symbol: str) -> str:
    """What chooses among kinds of processors, where there are several."""
    return dispatch_source(symbol) if options.processors == "any" else ""


def program_of(system: System, functions: Iterable[str], frames: Iterable[str] = ()) -> Program:
    """The graph of some functions of a system, for tools that look inside: counts, mutations, other evaluators.

    Args:
        system: What the user stated.
        functions: Names of model and frame functions.
        frames: What the frame functions are about.

    Raises:
        DescriptionError: The system can't be a mechanism.
        UnknownNameError: No such function or frame.
    """
    tree = plan(system)
    options = Options(tuple(functions), tuple(frames))
    return _written(tree, requested(tree, options), options.constraints, options.forward_dynamics)


def generate(
    tree: SpanningTree,
    requests: Iterable[Key],
    record: ModelRecord,
    form: str = "multipliers",
    method: str = "auto",
    c_name: str | None = None,
) -> tuple[Program, Callable[[], str]]:
    """Requests -> optimised Program, and its C text on demand.

    form and method are as in `Options.constraints` and `Options.forward_dynamics`; c_name is what the C symbols begin
    with, made of the model's name by default.
    """
    program = _written(tree, [Request(*key) for key in requests], form, method)
    return program, lambda: model_source(program, record, GENERATOR, c_name=c_name)


def _written(tree: SpanningTree, requests: Sequence[Request], form: str, method: str) -> Program:
    """The optimised program, its forward dynamics by the cheaper method where that is left to us."""
    if method == "auto" and any(request.name == "forward_dynamics" for request in requests):
        programs = _forward_programs(tree)
        method = cheapest(programs) if programs else "factors"
        if programs and tuple(requests) == _FORWARD:
            return programs[method]
    return run_passes(write_program(tree, requests, form, method))


def forward_method(tree: SpanningTree) -> str:
    """The cheaper way to a mechanism's forward dynamics."""
    programs = _forward_programs(tree)
    return cheapest(programs) if programs else "factors"


def _forward_programs(tree: SpanningTree) -> dict[str, Program]:
    """By each way that there is; none where there is no choice."""
    ways = methods(tree)
    return {way: run_passes(write_program(tree, _FORWARD, method=way)) for way in ways} if len(ways) > 1 else {}


def _warn_inconsistent(system: System) -> None:
    """Beams that soften when they spin, because they lack what would stiffen them."""
    for body in system.bodies:
        if isinstance(body, Beam) and not body.foreshortening and body.retain == "first_order" and body.modes:
            warnings.warn(
                f"beam '{body.name}': first order without foreshortening keeps the softening of a spinning beam and"
                " drops its stiffening: it diverges at its first natural frequency. For studies only; otherwise turn"
                " foreshortening on, or use retain: zeroth_order.",
                InconsistentModelWarning,
                stacklevel=3,
            )


class _Builder:
    """What turns requests and formulas into callable functions."""

    def __init__(self, tree: SpanningTree, record: ModelRecord, options: Options) -> None:
        self._tree, self._record, self._options = tree, record, options
        self._toolchain = _choose_toolchain(options)
        self._stated = repr((tree.system, options))  # Dataclasses print every field.

    def functions(self, requests: tuple[Key, ...]) -> Unit:
        """Functions of the model."""
        stated = [Request(*key) for key in requests]
        how = self._options.constraints, self._options.forward_dynamics
        return self._unit(requests, lambda: _written(self._tree, stated, *how))

    def formulas(self, formulas: tuple[Any, ...], derivatives: bool) -> Unit:
        """Numbers, formula texts or SymPy expressions over the model's names."""
        stated = [item if isinstance(item, Rate) else Rate(item, 0) for item in formulas]
        what = f"system '{self._tree.system.name}': formula"
        values = [(as_value(item.formula, what), item.order) for item in stated]
        return self._unit((values, derivatives), lambda: run_passes(formula_program(self._tree, values, derivatives)))

    def _unit(self, what: object, write: Callable[[], Program]) -> Unit:
        """What was asked for, written unless a library of it is known."""
        program = cache(write)
        if self._toolchain is None:
            return InterpretedUnit(program())
        in_lanes = self._in_lanes(what, program) if self._options.batch == "vector" else None
        return self._compiled((what, "one by one"), program, self._toolchain, None, in_lanes)

    def _compiled(
        self,
        what: object,
        program: Callable[[], Program],
        toolchain: Toolchain,
        vectors: Lanes | None,
        in_lanes: Callable[[Key, Lanes], CompiledKernel | None] | None = None,
    ) -> CompiledUnit:
        header = native_text("model/symofros_model.h")
        symbol = f"{identifier(self._record.name)}_model"

        def made(build: Build) -> Path:
            return recall_library(
                f"{self._stated}{what!r}{build.packs}",
                lambda: model_source(program(), self._record, GENERATOR, vectors, packs=build.packs),
                header,
                build.toolchain,
                build.flags,
                _dispatch(self._options, symbol),
                symbol,
            )

        path = _chosen(made, self._options, toolchain, vectors, symbol, self._record.hash)
        return CompiledUnit(path, symbol, header, self._record.hash, in_lanes)

    def _in_lanes(self, what: object, program: Callable[[], Program]) -> Callable[[Key, Lanes], CompiledKernel | None]:
        """Function, and how to use vectors -> the same by vectors, compiled when asked for.

        None for a function that a solver finishes.
        """

        def compiled(key: Key, lanes: Lanes) -> CompiledKernel | None:
            function = next(f for f in program().functions if (f.name, f.frame) == key)
            if function.solver is not None or self._toolchain is None:
                return None
            one = replace(program(), functions=(function,))
            return self._compiled((what, lanes, key), lambda: one, self._toolchain, lanes).compiled[key]

        return compiled


def _choose_toolchain(options: Options) -> Toolchain | None:
    """The compiler; None where the interpreter is asked for, or is all there is."""
    if options.backend == "interpreter":
        return None
    toolchain = find_toolchain(options.compiler)
    if toolchain is None:
        warnings.warn(
            "no C compiler found: models run on the NumPy interpreter, some thousand times slower."
            " Install gcc or clang, or `pip install ziglang`.",
            CompilerMissingWarning,
            stacklevel=4,
        )
    elif toolchain.is_fallback:
        _warn_fallback()
    return toolchain


@cache
def _warn_fallback() -> None:
    """Once a process: that the slower-compiling fallback is in use."""
    warnings.warn(
        "no system C compiler found: using the ziglang package, which compiles more slowly. Install gcc or clang.",
        CompilerMissingWarning,
        stacklevel=5,
    )


def requested(tree: SpanningTree, options: Options) -> list[Request]:
    """The functions that options ask for at once.

    Raises:
        UnknownNameError: No such function or frame.
    """
    if options.functions is None:
        return list(_EAGER)
    known = MODEL_FUNCTIONS + FRAME_FUNCTIONS
    for name in options.functions:
        if name not in known:
            raise UnknownNameError(
                Problem(
                    f"options: no function '{name}'",
                    name,
                    "a function of the model",
                    did_you_mean(name, known),
                )
            )
    frames = [frame.name for frame in tree.frames]
    for name in options.frames or ():
        if not any(name in (frame.name, frame.qualified) for frame in tree.frames):
            raise UnknownNameError(
                Problem(
                    f"system '{tree.system.name}': no frame '{name}'",
                    name,
                    "frames are those of its bodies",
                    did_you_mean(name, frames),
                )
            )
    wanted = [tree.frame(name).name for name in options.frames] if options.frames is not None else frames
    requests = [Request(name) for name in options.functions if name in MODEL_FUNCTIONS]
    requests += [Request(name, frame) for name in options.functions if name in FRAME_FUNCTIONS for frame in wanted]
    if not requests:
        raise DescriptionError(
            Problem(
                "options: nothing to generate",
                "no functions",
                "functions name at least one, and frames of it",
                "name some, or leave functions out",
            )
        )
    return requests


def describe(tree: SpanningTree, options: Options) -> ModelRecord:
    """What a model is besides its functions."""
    names = tree.coordinates
    lower: list[float] = []
    upper: list[float] = []
    neutral: list[float] = []
    periodic: list[bool] = []
    driven: list[float] = []
    for link in tree.links:
        limits, n = link.joint.limits, link.q[1]
        if link.joint.prescribed:
            nq, nv = joint_sizes(link.joint)
            driven += (*neutral_coordinates(link.joint, nq), *(0.0,) * (2 * nv))
            continue
        if link.tip_of is not None:
            sizes = small_coordinates(link.tip_of, evaluate(link.tip_of.length, tree.system.parameter_values()))
            lower += [-size for size in sizes]
            upper += sizes
            neutral += (0.0,) * n
            periodic += (False,) * n
            continue
        lower += [-float("inf") if limits is None or limits.lower is None else limits.lower] * n
        upper += [float("inf") if limits is None or limits.upper is None else limits.upper] * n
        neutral += neutral_coordinates(link.joint, n)
        periodic += angles(link.joint)
    return ModelRecord(
        name=tree.system.name,
        hash=_hash(tree.system, options),
        q_names=names.q,
        v_names=names.v,
        u_names=names.u,
        par_names=names.par,
        frame_names=tuple(frame.name for frame in tree.frames),
        frame_aliases={frame.qualified: frame.name for frame in tree.frames},
        u_default=(0.0,) * names.efforts + tuple(driven),
        par_default=names.par_default,
        q_neutral=tuple(neutral),
        q_lower=tuple(lower),
        q_upper=tuple(upper),
        segments=_segments(tree),
        periodic=tuple(periodic),
        constraint_names=tuple(name for item in tree.system.constraints for name in item.conditions),
        speed_conditions=tuple(name for item in tree.system.constraints for name in item.on_speeds),
        wrench_names=tuple(acts_on_bodies(tree.system.constraints)),
        closures=tuple(_closure(tree, item) for item in tree.system.constraints if isinstance(item, Closure)),
        driven=len(driven),
    )


def _closure(tree: SpanningTree, closure: Closure) -> ClosureRecord:
    first, second = (frame_of(tree, *anchor).name for anchor in (closure.first, closure.second))
    return ClosureRecord(closure.name, first, second, tuple(AXES.index(axis) for axis in closure.rotations))


def _segments(tree: SpanningTree) -> tuple[Segment, ...]:
    segments: list[Segment] = []
    for link in tree.links:
        if link.joint.prescribed:
            continue
        kind = link.joint.traits.manifold
        if kind == "linear" and segments and segments[-1].kind == "linear":
            segments[-1] = segments[-1]._replace(size=segments[-1].size + link.q[1])
        else:
            segments.append(Segment(kind, link.q[0], link.v[0], link.q[1]))
    return tuple(segments)


def _hash(system: System, options: Options) -> str:
    """Identity of a description under these options: dataclasses print every field, in order."""
    return hashlib.sha256(repr((system, options, GENERATOR)).encode()).hexdigest()[:16]
