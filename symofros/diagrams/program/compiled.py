"""Diagram -> C: a model for each part, functions for instants, both called by one loop."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.names import identifier
from symofros.base.options import Options
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.inlets import with_inlets
from symofros.diagrams.order import groups_in_motion, order_of
from symofros.diagrams.program.fused_functions import Fuser
from symofros.diagrams.program.layout import Layout, Part, lay_out
from symofros.diagrams.program.lowered_block import Piece, piece_of, watched
from symofros.diagrams.program.part_switching import CrossingEvent, PartSwitching, part_switching
from symofros.diagrams.program.point import reads
from symofros.diagrams.rates import Schedule, schedule
from symofros.diagrams.wiring import Source, Wired, located, surroundings, wire
from symofros.errors import CompileError, DescriptionError, Problem
from symofros.expr import Program
from symofros.generator import FormulaInstants, InterpretedUnit, model_source, run_passes, tape_unit
from symofros.native import native_text
from symofros.runtime.beams import ElasticBeam
from symofros.runtime.build import NO_COMPILER, Toolchain, build_library, find_toolchain
from symofros.runtime.calls import CompiledUnit, Kernel, Unit
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord
from symofros.simulation.actions import Actions

GENERATOR = "symofros diagram"


@dataclass(frozen=True)
class Resolved:
    """A diagram read as a whole, before any code is made of it.

    Attributes:
        wired: Blocks and wires.
        pieces: Blocks, lowered to expressions.
        order: All outputs, each after what it depends on.
        layout: Layout of states and signals in memory.
        schedule: Schedule of the blocks that are due at each instant.
        diagram: What was read, as it was then.
        inputs: What was given for its inlets.
    """

    wired: Wired
    pieces: Mapping[str, Piece]
    order: Sequence[Source]
    layout: Layout
    schedule: Schedule
    diagram: Diagram
    inputs: Mapping[str, Any] | None

    @property
    def crossings(self) -> tuple[CrossingEvent, ...]:
        """Crossings of all blocks, which stop the motion."""
        return tuple(
            CrossingEvent(name, self.pieces[block].crossings[which].direction, name=name)
            for block, which in watched(self.pieces)
            for name in (f"{block}.{which}",)
        )

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """What blocks take for granted and the diagram does not have."""
        return tuple(
            f"block '{name}': {note}"
            for name, piece in self.pieces.items()
            for note in piece.block.notes(surroundings(self.wired, name))
        )

    def switching(self, part: Part) -> PartSwitching | None:
        """The events of a part's mechanisms, as one table; None where they have none."""
        return part_switching(self.pieces, self.layout, part, self.crossings)


def rates_of(pieces: Mapping[str, Piece]) -> list[tuple[str, float, float]]:
    """(block, period [s], offset [s]) of each sampled block."""
    return [
        (name, piece.block.period, piece.block.offset)
        for name, piece in pieces.items()
        if piece.block.period is not None
    ]


def resolve(diagram: Diagram, inputs: Mapping[str, Any] | None = None) -> Resolved:
    """Check a diagram, write its blocks out, order them, and place their states.

    Args:
        diagram: Diagram as its author stated it.
        inputs: Inlet -> numbers, a Signal, or formulas of t; None: inlets stay open, as an export has them.

    Raises:
        DescriptionError: With what is wrong: names, shapes, units, sample times, algebraic loops.
    """
    names = ("models", "blocks", "wires", "inlets", "outlets", "inlet_ports", "parts", "origin")
    present: dict[str, Any] = {name: dict(getattr(diagram, name)) for name in names}
    diagram = replace(diagram, **present)
    wired = wire(with_inlets(diagram, inputs))
    pieces: dict[str, Piece] = {}
    problems: list[Problem] = []
    for name in wired.blocks:
        try:
            pieces[name] = lowered(wired, name)
        except DescriptionError as error:
            problems += error.problems
    if problems:
        raise DescriptionError(problems)
    order = order_of(wired, {name: piece.needs for name, piece in pieces.items()})
    layout = lay_out(wired, pieces, groups_in_motion(wired, pieces))
    return Resolved(wired, pieces, order, layout, schedule(rates_of(pieces), wired.name), diagram, inputs)


def lowered(wired: Wired, name: str) -> Piece:
    """A block's formulas.

    Raises:
        DescriptionError: Its fields do not fit each other, or what is connected.
    """
    origin = wired.origin.get(("block", name), "")
    try:
        return piece_of(wired, name)
    except DescriptionError as error:
        raise DescriptionError(located(error.problems, origin)) from None
    except (ValueError, IndexError, TypeError) as error:
        shapes = ", ".join(f"{port.name} {port.shape}" for port in wired.ports[name].inputs)
        raise DescriptionError(
            f"block '{name}': its fields do not fit its inputs",
            f"{error}"[:200],
            f"inputs here: {shapes or 'none'}",
            "mend the shapes of its fields",
            origin,
        ) from None


@dataclass
class CompiledDiagram:
    """A diagram as C functions.

    Attributes:
        resolved: Diagram that was compiled.
        parts: A model for each part.
        actions: The actions of each part's mechanisms; None where their events have none.
        instants: Functions "due_i", "crossed_i", "inputs_i_j".
        reads_accelerations: Whether functions of instants read accelerations and multipliers of that time.
        toolchain: Compiler and its identity; None where the functions are on tape.
        options: Options as of `compile_diagram`; functions that are asked for later are compiled by the same options.
        sources: C texts, for people.
    """

    resolved: Resolved
    parts: tuple[Model, ...]
    actions: tuple[Actions | None, ...]
    instants: Unit
    reads_accelerations: bool
    toolchain: Toolchain | None
    options: Options
    sources: tuple[str, ...] = ()
    _signals: dict[tuple[bool, tuple[Source, ...]], Kernel] = field(default_factory=dict)

    def __deepcopy__(self, memo: dict[int, Any]) -> CompiledDiagram:
        """Itself: nothing of it can be changed."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the diagram, so that another process compiles it, or finds it in the cache."""
        return _compiled, (self.resolved.diagram, self.resolved.inputs, self.options)

    def energies(self, name: str) -> Model:
        """A model of a mechanism that has its energies only."""
        return self.resolved.wired.models.energies(name, self.options)

    def impacts(self, name: str) -> Model:
        """A model of a mechanism that has what tells the impulses of impacts and their energies."""
        return self.resolved.wired.models.impacts(name, self.options)

    def signals(self, sources: Sequence[Source], by_numpy: bool = False) -> Kernel:
        """A function of q, v, u, t, a, lam that gives some outputs, compiled unless NumPy is to evaluate it."""
        key = by_numpy, tuple(sources)
        if key not in self._signals:
            program = run_passes(fuser(self.resolved).signals(sources))
            toolchain, options = (None, None) if by_numpy else (self.toolchain, self.options)
            unit, _ = unit_of(program, record_of(self.resolved, None), toolchain, options)
            self._signals[key] = unit.kernels["signals", ""]
        return self._signals[key]


def _compiled(diagram: Diagram, inputs: Mapping[str, Any] | None, options: Options) -> CompiledDiagram:
    return compile_diagram(resolve(diagram, inputs), options)


def fuser(resolved: Resolved) -> Fuser:
    """The Fuser that writes the functions of a resolved diagram."""
    return Fuser(resolved.wired, resolved.pieces, resolved.layout, resolved.order)


def compile_diagram(resolved: Resolved, options: Options | None = None) -> CompiledDiagram:
    """Turn a diagram into C functions, and compile them.

    Args:
        resolved: Diagram as `resolve` returns it.
        options: Options, of which `backend`, `compiler`, `flags` and `packs` count.

    Raises:
        DescriptionError: A part needs what is known at instants only.
        CompileError: The options ask for NumPy, or there is no compiler, or it failed.
    """
    options = options or Options()
    if options.backend == "interpreter":
        raise CompileError(
            f"diagram '{resolved.wired.name}': backend '{options.backend}'",
            "a loop of compiled functions",
            "the functions of a compiled diagram are C or tapes",
            "interpret it: Simulation.interpret(compiled=False)",
        )
    toolchain = find_toolchain(options.compiler) if options.backend == "c" else None
    if toolchain is None and options.backend == "c":
        raise CompileError(replace(NO_COMPILER, remedy=f"{NO_COMPILER.remedy}, or interpret the diagram"))
    write = fuser(resolved)
    parts, acting, texts = [], [], []
    for part in resolved.layout.parts:
        model, actions, text = _model(resolved, write, part, toolchain, options)
        parts.append(model)
        acting.append(actions)
        texts.append(text)
    program = run_passes(write.samples(resolved.schedule.sets))
    instants, text = unit_of(program, record_of(resolved, None), toolchain, options)
    return CompiledDiagram(
        resolved,
        tuple(parts),
        tuple(acting),
        instants,
        reads_accelerations(program),
        toolchain,
        options,
        (*texts, text),
    )


def reads_accelerations(program: Program) -> bool:
    """Whether functions read accelerations or multipliers, which the loop then finds at each instant."""
    edges = [edge for function in program.functions for edge in function.edges()]
    return reads(program.graph, edges, ("a", "lam"), program.pre)


class _Instants:
    """Instants at which formulas of time in a part's motion bend, jump or change fast: as of `Instants`."""

    def __init__(self, motion: Program) -> None:
        self._motion, self._edges = motion, [edge for function in motion.functions for edge in function.edges()]

    def __call__(
        self,
        formulas: Sequence[object],
        par: Array,
        t0: float,
        t_end: float,
        motion: object = None,
        *,
        kinks: bool = False,
    ) -> Array:
        return self._search(par, t0, t_end, kinks=kinks)

    def parameters(self, formulas: Sequence[object]) -> tuple[int, ...] | None:
        return self._search.parameters

    def bend(self, formulas: Sequence[object], par: Array, states: Mapping[str, Array]) -> bool:
        return FormulaInstants(self._motion, self._edges, of_states=True).bend(par, states)

    @cached_property
    def _search(self) -> FormulaInstants:
        return FormulaInstants(self._motion, self._edges)


def _model(
    resolved: Resolved, write: Fuser, part: Part, toolchain: Toolchain | None, options: Options
) -> tuple[Model, Actions | None, str]:
    """A part as a model, what its events do, and its C text."""
    record = record_of(resolved, part)
    motion = run_passes(write.motion(part))
    unit, text = unit_of(motion, record, toolchain, options)

    def formulas(*_: object) -> Unit:
        """The part's unit, which has the formulas whose zeros the stepper locates."""
        return unit

    beams, switching = partial(part_beams, resolved, part), resolved.switching(part)
    check = None if switching is None else partial(_problems, resolved, part)
    par = np.array(record.par_default)
    model = Model(record, None, (unit,), par, formulas, beams, parameter_check=check, instants=_Instants(motion))
    kernel = unit.kernels.get(("actions", ""))
    return model, None if switching is None or kernel is None else Actions(record, switching.stated, kernel), text


def _problems(resolved: Resolved, part: Part, par: Array) -> list[Problem]:
    """Faults of parameters (n, npar) of the mechanisms of a part, where events change some."""
    models, problems = resolved.wired.models, list[Problem]()
    for name in part.blocks:
        if name in resolved.layout.kept:
            model = resolved.wired.blocks[name].mechanism()
            problems += models.compilation(model).parameter_problems(resolved.layout.parameters_of(name, model, par))
    return problems


def part_beams(resolved: Resolved, part: Part, par: Array) -> tuple[ElasticBeam, ...]:
    """The elastic beams of a part's mechanisms at the diagram's parameters, each named after its block."""
    layout, models, beams = resolved.layout, resolved.wired.models, list[ElasticBeam]()
    for name in part.blocks:
        if name in layout.q:
            model = resolved.pieces[name].block.mechanism()
            q, v = layout.q[name].start - part.q.start, layout.v[name].start - part.v.start
            for beam in models.compilation(model).beams(layout.parameters_of(name, model, par)):
                beams.append(replace(beam, name=f"{name}.{beam.name}", q=beam.q + q, v=beam.v + v))
    return tuple(beams)


def unit_of(
    program: Program, record: ModelRecord, toolchain: Toolchain | None, options: Options | None = None
) -> tuple[Unit, str]:
    """The functions of a program, and their C text; without a compiler they are on tape if asked for, or NumPy's."""
    if toolchain is None:
        on_tape = options is not None and options.backend == "tape"
        return tape_unit(program, record) if on_tape else InterpretedUnit(program), ""
    header = native_text("model/symofros_model.h")
    text = model_source(program, record, GENERATOR, packs="where they pay" if options and options.packs else "none")
    path = build_library(text, header, toolchain, options.flags if options else None)
    return CompiledUnit(path, f"{identifier(record.name)}_model", record.hash), text


def record_of(resolved: Resolved, part: Part | None) -> ModelRecord:
    """Sizes and names of a part, or of the whole."""
    layout = resolved.layout
    of = part or layout.whole
    q, v, nq = of.q, of.v, of.nq
    segments = tuple(
        segment._replace(q=segment.q - q.start, v=segment.v - v.start)
        for segment in layout.segments
        if q.start <= segment.q < q.stop
    )
    names = tuple(layout.condition_names[of.conditions])
    switching = None if part is None else resolved.switching(part)
    stated = repr((resolved.wired.name, layout.q_names, layout.v_names, layout.u_names, layout.par_names))
    return ModelRecord(
        name=resolved.wired.name,
        hash=hashlib.sha256(stated.encode()).hexdigest()[:16],
        q_names=tuple(layout.q_names[q]),
        v_names=tuple(layout.v_names[v]),
        u_names=tuple(layout.u_names),
        par_names=tuple(layout.par_names),
        frame_names=() if switching is None else tuple(map(".".join, switching.frames)),
        frame_aliases={},
        u_default=tuple(layout.u0),
        par_default=tuple(layout.par),
        q_neutral=tuple(layout.q0[q]),
        q_lower=(-np.inf,) * nq,
        q_upper=(np.inf,) * nq,
        segments=segments,
        periodic=(False,) * nq,
        constraint_names=names,
        speed_conditions=tuple(name for name in names if name in layout.speed_conditions),
        measures=layout.measures_of(of),
        switches=() if switching is None else switching.switches,
        sticking=() if switching is None else switching.sticking,
        rigid_contacts=() if switching is None else switching.contacts,
    )


def bare_record(name: str) -> ModelRecord:
    """A model record for functions that belong to no mechanism: no coordinates, parameters or frames."""
    return ModelRecord(
        name=name,
        hash="",
        q_names=(),
        v_names=(),
        u_names=(),
        par_names=(),
        frame_names=(),
        frame_aliases={},
        u_default=(),
        par_default=(),
        q_neutral=(),
        q_lower=(),
        q_upper=(),
        segments=(),
        periodic=(),
    )
