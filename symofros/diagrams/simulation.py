"""sf.Simulation: a diagram made ready once, then run, compiled or interpreted."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arguments import checked
from symofros.base.options import Options
from symofros.diagrams.batch import DiagramRuns, run_batch
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.linear import DiagramStateSpace, linearised
from symofros.diagrams.observer import Observer
from symofros.diagrams.program.compiled import CompiledDiagram, Resolved, compile_diagram, rates_of, resolve
from symofros.diagrams.rates import schedule
from symofros.diagrams.result import DiagramRun
from symofros.diagrams.run.block_functions import Blocks
from symofros.diagrams.run.examination.deep_contacts import contact_notes
from symofros.diagrams.run.examination.faults import signal_notes
from symofros.diagrams.run.examination.interpreted import notes_on_steps
from symofros.diagrams.run.examination.joint_limits import joint_limit_notes
from symofros.diagrams.run.examination.prescribed import judge_prescribed
from symofros.diagrams.run.interpret import BeamWatch, Course, InterpretedRun, run_interpreted
from symofros.diagrams.run.loop import RECORD
from symofros.diagrams.run.members import representative
from symofros.diagrams.run.python_blocks import begun
from symofros.diagrams.run.simulate import run_compiled
from symofros.diagrams.run.values import parameter_values, record_interval
from symofros.diagrams.stepper import DiagramStepper
from symofros.errors import SymofrosError
from symofros.runtime.beams import BEAM_LIMIT
from symofros.runtime.build import find_toolchain
from symofros.simulation.progress import bar
from symofros.simulation.stepping.methods import METHODS


class Simulation:
    """A diagram, checked at once, or with what is given for its inlets; compiled when it is first run.

    Args:
        diagram: Diagram as its author stated it.
        options: Options of the compiler.

    Raises:
        DescriptionError: With what is wrong with the diagram.
    """

    @checked
    def __init__(self, diagram: Diagram, options: Options | None = None) -> None:
        self.diagram = diagram
        self.options = options or Options()
        if not diagram.inlets:
            self.resolved  # noqa: B018 - checks it

    def __getstate__(self) -> dict[str, Any]:
        """Copy and pickle by the diagram: what it becomes is made again where it is asked for."""
        return {"diagram": self.diagram, "options": self.options}

    @cached_property
    def resolved(self) -> Resolved:
        """The diagram, checked; of one with inlets, with these open."""
        return resolve(self.diagram)

    @cached_property
    def compiled(self) -> CompiledDiagram:
        """The diagram as C functions."""
        return compile_diagram(self.resolved, self.options)

    @checked
    def run(
        self, t_end: float | None = None, *, inputs: Mapping[str, Any] | None = None, **settings: Any
    ) -> DiagramRun:
        """Run it in C.

        Args:
            t_end: End time [s]; the diagram's own where it states one.
            inputs: Inlet -> numbers, which hold, a Signal, or formulas of t; all inlets of the diagram are given.
            settings: Fields of `SimulationOptions` in place of the diagram's own; `parameters`, `starts`,
                `threads`, `progress` and `observer` as of `run_compiled`.

        Raises:
            SymofrosError: As `run_compiled`; or nobody says where to end.
        """
        chosen = self.diagram.simulation.keywords_with(settings)
        return run_compiled(self.compiled_with(inputs), _end(self.diagram, t_end), **chosen)

    @checked
    def run_batch(
        self,
        t_end: float | None = None,
        *,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        inputs: Mapping[str, Any] | None = None,
        **settings: Any,
    ) -> DiagramRuns:
        """Run it many times in C, several runs at once on threads.

        Each run is that of `run` with the same values, to the last bit, whatever the number of threads; it has its own
        outcome, and one that ends before leaves the others alone.

        Args:
            t_end: End time [s]; the diagram's own where it states one.
            parameters: Run-time parameter -> its values (..., *shape), the batch dimensions first.
            starts: State -> its first values (..., *shape), as of `run_compiled`.
            inputs: Inlet -> numbers (..., *shape); a Signal, whose values are (n, size), or (..., n, size) where they
                differ; or formulas of t, of all runs.
            settings: Fields of `SimulationOptions` in place of the diagram's own, and `threads`. All records are held.

        Returns:
            The DiagramRuns, whose batch dimensions are those of all values broadcast together.

        Raises:
            ShapeError: A value does not fit, or batch dimensions do not broadcast.
            DescriptionError: Nothing but what is given would say the shape of an inlet.
            SymofrosError: As `run_compiled`; or a block is called outside of C, as blocks of Python's are.
        """
        chosen = self.diagram.simulation.keywords_with(settings)
        one = representative(inputs)
        if one and inputs and any(isinstance(one[name], float) and not np.isscalar(x) for name, x in inputs.items()):
            self.resolved  # noqa: B018 - numbers of many runs do not say the shape of an inlet
        return run_batch(
            self.compiled_with(one),
            _end(self.diagram, t_end),
            parameters=parameters,
            starts=starts,
            inputs=inputs,
            **chosen,
        )

    @checked
    def state_space(
        self,
        *,
        t: float = 0.0,
        inputs: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        outputs: Sequence[str] | None = None,
    ) -> DiagramStateSpace:
        """Linearise it about a state, from its inlets to its outlets, by exact derivatives.

        Continuous blocks and mechanisms give x' = A x + B u. With sampled blocks it is x[k + 1] = A x[k] + B u[k] over
        the least common multiple of their periods, exact, about an equilibrium.

        Args:
            t: Time [s].
            inputs: Inlet -> its value at this state; by default what it starts with.
            parameters: Run-time parameters by name, as of `run`.
            starts: The state, as `run` takes first states; by default the diagram's first.
            outputs: Signals "block.port", or outlets, that y stacks, in order; by default the outlets.

        Raises:
            UnknownNameError: There is no such inlet, parameter or state.
            AssemblyError: The state does not meet the constraints.
            SymofrosError: A block switches at this state, or rounds; or samples meet a motion that is no equilibrium.
        """
        return linearised(self.compiled, t=t, inputs=inputs, parameters=parameters, starts=starts, outputs=outputs)

    def compiled_with(self, inputs: Mapping[str, Any] | None) -> CompiledDiagram:
        """The diagram as C functions, with what is given for its inlets, as of `run`."""
        given = self._given(inputs)
        return compile_diagram(given, self.options) if self.diagram.inlets else self.compiled

    def _given(self, inputs: Mapping[str, Any] | None) -> Resolved:
        """The diagram with what is given for its inlets."""
        if not self.diagram.inlets and not inputs:
            return self.resolved
        return resolve(self.diagram, inputs or {})

    @checked
    def stepper(self, *, inputs: Mapping[str, Any] | None = None, **settings: Any) -> DiagramStepper:
        """The diagram, stepped by hand from its first state.

        Args:
            inputs: What is given for inlets, as of `run`.
            settings: Fields of `SimulationOptions` in place of the diagram's own. `output` is the time of one step, by
                default the longest of which all sample times of the diagram are multiples; without samples `dt`.

        Raises:
            SymofrosError: The options contradict each other or have no meaning here, or the method is implicit.
            AssemblyError: The first state does not meet the constraints.
        """
        chosen = self.diagram.simulation.keywords_with(settings)
        left = {"record", "realtime", "threads"} - settings.keys()
        of_steps = {name: value for name, value in chosen.items() if name not in left}
        return DiagramStepper(self.compiled_with(inputs), **of_steps)

    @checked
    def interpret(
        self,
        t_end: float,
        *,
        inputs: Mapping[str, Any] | None = None,
        t0: float = 0.0,
        method: str = "rk4",
        dt: float = 1e-3,
        record: float | None = None,
        parameters: Mapping[str, Any] | None = None,
        gains: tuple[float, float] | None = None,
        beam_limit: float = BEAM_LIMIT,
        compiled: bool = True,
        progress: bool = False,
        observer: Observer | None = None,
    ) -> InterpretedRun:
        """Run it block by block from Python: the reference of `run`, and some hundred times slower.

        Its steps do not end where formulas of t jump, such as a Step that moves a filter: there it errs by a share of a
        step, where `run` does not.

        Args:
            t_end: End time [s].
            inputs: Inlet -> numbers, a Signal, or formulas of t, as of `run`.
            t0: Start time [s].
            method: rk4 or euler.
            dt: Step [s].
            record: Interval of recording [s].
            parameters: Run-time parameters by name.
            gains: Baumgarte's (alpha, beta) [1/s]; None keeps constraints by projection.
            beam_limit: Estimated error of the beams' theory beyond which the run ends.
            compiled: Whether each block is compiled by itself; else NumPy interprets its formulas.
            progress: Show a progress bar.
            observer: Receiver of the records while the run goes on, which may stop it by time.

        Raises:
            SymofrosError: The method is implicit or adaptive, or the diagram has events of mechanisms.
        """
        resolved = self._given(inputs)
        if not (math.isfinite(dt) and dt > 0.0):
            what, rule = "diagram: the step is not positive", "dt > 0, and finite"
            raise SymofrosError(what, f"dt = {dt}", rule, "1e-3 s suits most arms")
        if method not in METHODS or METHODS[method].kind != "explicit" or METHODS[method].adaptive:
            raise SymofrosError(
                f"diagram: method '{method}' interpreted",
                "not of fixed explicit steps",
                "an interpreted run steps by rk4 or euler",
                "use run",
            )
        if any(piece.switching for piece in resolved.pieces.values()):
            what = f"diagram '{resolved.wired.name}': events of mechanisms"
            rule = "it does not locate events of mechanisms, nor modes of friction that sticks, or of rigid contacts"
            raise SymofrosError(what, "an interpreted run", rule, "use run")
        par = parameter_values(resolved, parameters or {})
        toolchain = find_toolchain(self.options.compiler) if compiled else None
        interval = record_interval(record, t0, t_end, dt)
        plan = schedule([*rates_of(resolved.pieces), (RECORD, interval, 0.0)], resolved.wired.name)
        instants = [(t, due - {RECORD}, RECORD in due) for t, due in plan.between(t0, t_end)]
        course = Course(instants, t_end, dt, plan.spacing, METHODS[method].tableau, gains is None)
        blocks = Blocks(resolved, par, gains or (0.0, 0.0), toolchain)
        closing = () if gains else blocks.close_loops()
        watch = BeamWatch(resolved, par, beam_limit)
        with begun(resolved.wired) as called, bar(progress, t0, t_end) as show:
            run = run_interpreted(blocks, called, course, watch, show, observer)
        run = replace(run, outcome=judge_prescribed(run.outcome, resolved, run.t, run.values.__getitem__))
        notes = joint_limit_notes(resolved, run.t, run.q, run.v)
        notes += contact_notes(resolved, par, (run.t, run.q, run.v), run.values.__getitem__)
        if run.outcome.ok:
            notes += notes_on_steps(run, blocks, course, called, METHODS[method])
            outputs = resolved.order
            notes += signal_notes(run.t, lambda rows: ((source, run.values[source][rows]) for source in outputs))
        return replace(run, outcome=replace(run.outcome, notes=(*closing, *resolved.notes, *run.outcome.notes, *notes)))


def _end(diagram: Diagram, t_end: float | None) -> float:
    end = t_end if t_end is not None else diagram.simulation.t_end
    if end is None:
        raise SymofrosError(
            f"diagram '{diagram.name}': no end of time",
            "t_end is not stated",
            "a run ends somewhere",
            "give t_end, or state it under simulation",
        )
    return end
