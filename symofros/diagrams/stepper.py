"""Simulation.stepper: a diagram whose caller makes the steps, in a loop of its own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import ExitStack, closing
from dataclasses import replace
from threading import Lock
from typing import Any, NoReturn
from weakref import finalize

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import CompiledDiagram, rates_of
from symofros.diagrams.rates import schedule
from symofros.diagrams.result import DiagramRun
from symofros.diagrams.run.loop import RECORD
from symofros.diagrams.run.parts import start_parts
from symofros.diagrams.run.python_blocks import CalledBefore, NotKeptError, begun
from symofros.diagrams.run.recording import Records
from symofros.diagrams.run.simulate import PlannedRun, examined_run, placed_loop, run_from
from symofros.diagrams.run.starts import Start
from symofros.diagrams.run.values import diagram_options, parameter_values, record_interval
from symofros.errors import SymofrosError
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.stepped import MOST_STEPS, Stepped, no_steps
from symofros.simulation.stepping.loops import Recorded, drive
from symofros.simulation.stepping.status import Status

# Steps at a time for which the instants of formulas of time are found.
_AHEAD = 4096


class DiagramStepper(Stepped):
    """A diagram that is stepped by hand, as `Simulation.stepper` makes it.

    A step goes on to the next multiple of `period`: samples on the way are taken, those at its end as well. Signals and
    states are those that `run(output=period)` records there, to the last bit with methods of fixed steps.

    ::

        stepper = sf.Simulation(diagram).stepper()
        while stepper.t < 2.0 and stepper.step():
            print(stepper["arm.q"])
        print(stepper.outcome)

    Attributes:
        period: Time of one step [s].
    """

    @checked
    def __init__(self, compiled: CompiledDiagram, options: SimulationOptions | None = None, **changes: Any) -> None:
        """Place a diagram at its first state.

        Args:
            compiled: Diagram, compiled.
            options: Options of stepping and constraints; those of `SimulationOptions()` by default.
            changes: Fields of SimulationOptions by name. `output` is the period of a step, by default the longest of
                which all sample times of the diagram are multiples; without samples `dt`.

        Raises:
            SymofrosError: The options contradict each other or have no meaning here, or the method is implicit.
            AssemblyError: The first state does not meet the constraints.
        """
        chosen = diagram_options(options, changes)
        rule = "a loop of the caller's decides how fast it goes"
        chosen.refuse(("realtime",), "stepper: an option of whole runs", rule)
        resolved, name = compiled.resolved, compiled.resolved.wired.name
        rates = rates_of(resolved.pieces)
        default = float(schedule(rates, name).base) if rates else chosen.dt or 1e-3
        self.period = record_interval(default if chosen.output is None else chosen.output, 0.0, 1.0, None)
        plan = schedule([*rates, (RECORD, self.period, 0.0)], name)
        self._plan = PlannedRun(compiled, plan, chosen, chosen.t0, parameter_values(resolved, {}))
        self._name, self._stepping, self._ends = name, Lock(), ExitStack()
        self._starts: Mapping[str, Any] = {}
        finalize(self, self._ends.close)
        self.reset()

    @checked
    def reset(self, *, parameters: Mapping[str, Any] | None = None, starts: Mapping[str, Any] | None = None) -> None:
        """Begin anew at the diagram's first state; blocks of Python's begin anew, too.

        Args:
            parameters: Run-time parameters by name, as `Simulation.run` takes them; those before by default.
            starts: First values of states by name, as `parameters`.

        Raises:
            SymofrosError: They do not fit, or the first accelerations are not finite.
        """
        plan, resolved = self._plan, self._plan.compiled.resolved
        if parameters is not None:
            plan = self._plan = replace(plan, par=parameter_values(resolved, parameters))
        self._starts = dict(self._starts if starts is None else starts)
        begin, t0 = Start.of(resolved, plan.options.t0, plan.par, self._starts), plan.options.t0
        self._ends.close()
        self._called = self._ends.enter_context(begun(resolved.wired))
        ahead = replace(plan, t_end=t0 + _AHEAD * self.period)
        self._loop, parts = placed_loop(ahead, begin, self._called)
        self._ends.enter_context(closing(self._loop))
        start_parts(parts, resolved, plan.par, begin)
        self._status, self._marks, self._known = int(Status.RUNNING), 0, ahead.t_end
        self._loop.start(t0, math.inf, 0.0, 1, 0)
        self._advance(1)

    def close(self) -> None:
        """End the blocks of Python's, of a stepper that is not needed any more."""
        self._ends.close()
        self._status = int(Status.FINISHED)

    @checked
    def step(self, steps: int = 1) -> bool:
        """Go on by so many periods.

        Returns:
            Whether the motion can go on. Where it can't, `outcome` says why.

        Raises:
            SymofrosError: The motion has ended before, the number of steps is none, or another thread makes steps.
        """
        if not 1 <= steps <= MOST_STEPS:
            raise no_steps(steps)
        if not self.running:
            raise SymofrosError(
                "step: the motion has ended", repr(self), "steps are made while step() returns True", "reset()"
            )
        self._begin_alone()
        try:
            t0 = self._plan.options.t0
            while steps > 0 and self.running:
                portion = min(steps, _AHEAD)
                t = t0 + (self._marks + portion) * self.period
                self._look_ahead(t)
                self._advance(self._loop.instants_until(t))
                steps, self._marks = steps - portion, self._marks + portion
            return self.running
        finally:
            self._stepping.release()

    def _look_ahead(self, t: float) -> None:
        """Find the instants of formulas of time at which steps have to end."""
        if t > self._known:
            self._known = t + _AHEAD * self.period
            for part in self._loop.parts:
                part.set_stops(self.t, self._known)

    def _advance(self, instants: int) -> None:
        """Execute so many instants, in portions that let Ctrl-C through."""
        loop = self._loop
        goal = loop.instants_done + instants
        recorded = drive(loop, Recorded(), lambda steps: min(steps, goal - loop.instants_done), lambda _: None)
        if recorded.interrupted:
            raise KeyboardInterrupt
        self._status = recorded.status

    def __getitem__(self, name: str) -> Array:
        """The present signal "block.port", of its own shape.

        Raises:
            DescriptionError: There is no such output.
        """
        d, view = self._loop.diagram, self._loop.view
        q, v, u = (view(of, size)[np.newaxis] for of, size in ((d.q, d.nq), (d.v, d.nv), (d.u, d.nu)))
        records = Records(self._plan.compiled, np.array([self.t]), q, v, u, self._plan.par)
        return np.array(records[name][0])

    def motion(self, block: str) -> tuple[Array, Array]:
        """Present configuration (nq) and speeds (nv) of the mechanism that a block moves."""
        q, v = self._plan.compiled.resolved.layout.moved(block)
        d, view = self._loop.diagram, self._loop.view
        return view(d.q, d.nq)[q.slice].copy(), view(d.v, d.nv)[v.slice].copy()

    @property
    def running(self) -> bool:
        """Whether the motion can go on."""
        return self._status == Status.RUNNING

    @property
    def t(self) -> float:
        """Present time [s]."""
        return self._loop.t

    def trajectory(self) -> DiagramRun:
        """The motion since the reset as `Simulation.run` gives it, recorded at each step; it is made once more.

        Blocks of Python's are not called again: what they gave is kept.

        Raises:
            SymofrosError: They were called too often for that, or no step was made.
        """
        plan, live = self._plan, self._loop
        if not self._marks:
            raise SymofrosError("stepper: no motion yet", repr(self), "a motion has a step at least", "step() first")
        plan = replace(plan, t_end=self.t if self.running else plan.options.t0 + self._marks * self.period)
        resolved, given = plan.compiled.resolved, self._called.given
        begin = Start.of(resolved, plan.options.t0, plan.par, self._starts)
        ended = run_from(plan, begin, CalledBefore(resolved.wired, given))
        if live.failure is not None:
            ended.loop.failure, ended.loop.failed_block = live.failure, live.failed_block
        elif isinstance(ended.loop.failure, NotKeptError):
            what, rule = (
                "stepper: the motion is not made once more",
                "what blocks of Python's give is kept of the first calls",
            )
            raise SymofrosError(
                what, f"{len(given)} calls", rule, "look at signals while the loop goes on, or reset earlier"
            )
        ended.loop.fault = live.fault
        return examined_run(plan, ended, given, self._called.kept())

    @property
    def outcome(self) -> Outcome:
        """Why the motion ended, or what is worth knowing of it: what `Simulation.run` says of the same motion.

        The motion is made once more for it, and examined, at each call: for the end of a loop, not within it.
        """
        return self.trajectory().outcome

    def copy(self) -> NoReturn:
        """Refused."""
        rule = "blocks of Python's may keep what can't be copied"
        raise SymofrosError(
            "DiagramStepper: no copy", repr(self), rule, "make another one by Simulation.stepper, and step it as far"
        )

    def __repr__(self) -> str:
        state = "" if self.running else ", ended"
        return f"<DiagramStepper of '{self._name}': period = {self.period:g} s, t = {self.t:g} s{state}>"
