"""The interpreted run: Python calls the blocks one by one; slow, simple, and what the compiled run is held against."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.observer import NoObserver, Observer
from symofros.diagrams.program.compiled import Resolved, part_beams
from symofros.diagrams.run.block_functions import Blocks
from symofros.diagrams.run.examination.faults import first_fault, without_end
from symofros.diagrams.run.interpreted_steps import Crossings, NotFiniteError, step
from symofros.diagrams.run.projection import engage
from symofros.diagrams.run.python_blocks import Called
from symofros.diagrams.run.recording import Crossed
from symofros.diagrams.wiring import Source
from symofros.runtime.beams import BeamBending, ElasticBeam, amplification_of, bending_notes, largest_bending
from symofros.simulation.analysis.beam_theory import UNAMPLIFIED, amplifying
from symofros.simulation.results.ends import ENDS, INTERRUPTED, beyond_theory
from symofros.simulation.results.engaging import EngagedApartError, engaged_apart, engaging_notes
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.tableaus import Tableau

# How often an observer gets records [s], and how much earlier than its stop an instant may be, by rounding [s].
_SENT_EVERY, _SLACK = 0.05, 1e-12
# Of states, about, from which on compiled runs end as diverged: SYM_BEYOND_MOTION in native/stepping/state/system.c.
_BEYOND_MOTION = 1e100

# An instant of a run: its time, what is due, whether to record. A record: t, q, v.
Instant = tuple[float, frozenset[str], bool]
Row = tuple[float, Array, Array]


@dataclass
class InterpretedRun:
    """Signals of an interpreted run, `run["block.port"]` (n, *shape).

    Attributes:
        resolved: Diagram that ran.
        t: Times (n) [s].
        values: (block, output) -> its signal.
        memory: (block, memory) -> its values.
        q: Configurations of all mechanisms (n, nq).
        v: Speeds and continuous states (n, nv).
        outcome: Outcome of the run.
        steps: Number of steps.
        bendings: Bending of each beam at the step where its theory errs most.
        kept: Block -> what it kept of the run, by name.
        crossings: Crossings that were met, in order.
    """

    resolved: Resolved
    t: Array
    values: dict[Source, Array]
    memory: dict[tuple[str, str], Array]
    q: Array
    v: Array
    outcome: Outcome
    steps: int
    bendings: tuple[BeamBending, ...] = ()
    kept: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)
    crossings: tuple[Crossed, ...] = ()

    def __getitem__(self, name: str) -> Array:
        """A signal over time."""
        return self.values[self.resolved.wired.output(name)]


class _RecordFeed:
    """Records on their way to an observer.

    Args:
        observer: Observer that gets them.
        blocks: The diagram's blocks.
        rows: Records that grow: times first.
        kept: Signals that grow.
    """

    def __init__(
        self,
        observer: Observer,
        blocks: Blocks,
        rows: Sequence[Row],
        kept: Mapping[Source, Sequence[Array]],
    ) -> None:
        self._observer, self._rows, self._kept = observer, rows, kept
        self._sources = {name: blocks.resolved.wired.output(name) for name in observer.signals}
        self._sent, self._when = 0, time.perf_counter()

    def send(self, t: float, is_over: bool = False) -> bool:
        """Send new records if a stop is reached or they are due; returns whether the run continues."""
        is_due = t >= self._observer.stop() - _SLACK or time.perf_counter() - self._when >= _SENT_EVERY
        if not (is_over and self._sent < len(self._rows)) and not (is_due and not is_over):
            return True
        new = {name: np.array(self._kept[source][self._sent :]) for name, source in self._sources.items()}
        times = np.array([row[0] for row in self._rows[self._sent :]])
        self._sent = len(self._rows)
        try:
            self._observer.see(t, times, new)
        except KeyboardInterrupt:
            return False
        self._when = time.perf_counter()
        return True


class BeamWatch:
    """The bending of all beams of a diagram, each at the step where its theory errs most.

    Args:
        resolved: The diagram.
        par: Run-time parameters (npar).
        limit: Estimated error beyond which the run ends.

    Attributes:
        limit: The same.
    """

    def __init__(self, resolved: Resolved, par: Array, limit: float) -> None:
        self.limit = limit
        self._beams: list[tuple[ElasticBeam, slice]] = []
        for part in resolved.layout.parts:
            for beam in part_beams(resolved, part, par):
                whole = replace(beam, q=part.q.start + beam.q, v=part.v.start + beam.v)
                self._beams.append((whole, whole.in_q))
        self._largest: list[BeamBending | None] = [None] * len(self._beams)

    @property
    def bendings(self) -> tuple[BeamBending, ...]:
        """The largest bending of each beam that was bent at all."""
        return tuple(bending for bending in self._largest if bending is not None)

    def amplify(self, blocks: Blocks, rows: Sequence[Row], kept: Mapping[Source, Sequence[Array]]) -> None:
        """Amplify the errors by the axial loads of the motion (docs/theory/beams.md, 26a).

        Args:
            blocks: The diagram's; they are moved.
            rows: Records of the motion.
            kept: Signals of each record.
        """
        if not rows or max((bending.error for bending in self.bendings), default=0.0) < UNAMPLIFIED:
            return
        works = [np.zeros((2, 0))] * len(self._beams)
        for i in amplifying(*(np.array([row[k] for row in rows]) for k in (1, 2))):
            blocks.t[0], blocks.q[:], blocks.v[:] = rows[i]
            for source in blocks.resolved.layout.held:
                blocks.out[source][...] = kept[source][i]
            works = [np.column_stack([w, _works(blocks, *which)]) for w, which in zip(works, self._beams, strict=True)]
        for k, bending in enumerate(self._largest):
            self._largest[k] = bending and bending.amplified(amplification_of(*works[k]))

    def judge(self, q: Array, t: float) -> bool:
        """Judge a configuration of the diagram (nq); whether it lies within the limit."""
        for i, (beam, at) in enumerate(self._beams):
            largest = self._largest[i]
            if largest is None or beam.error_bound(q[at]) > largest.error:
                bending = beam.bending(q[at], t)
                if largest is None or bending.error > largest.error:
                    self._largest[i] = bending
        return all(bending.error <= self.limit for bending in self.bendings)


def _works(blocks: Blocks, beam: ElasticBeam, at: slice) -> tuple[float, float]:
    """Work of a beam's elastic stiffness at the present point, and of its tangent stiffness there (26a)."""
    layout, x = blocks.resolved.layout, blocks.q[at].copy()
    name = next(name for name, place in layout.q.items() if place.start <= at.start < place.slice.stop)
    step, along = float(beam.difference_step(x)), np.zeros(layout.v[name].size)
    if not step > 0.0:
        return 0.0, 0.0
    along[beam.v - layout.v[name].start :][: beam.size] = x

    def forces(share: float) -> tuple[Array, Array]:
        blocks.q[at] = (1.0 + share) * x
        blocks.signals()
        blocks.accelerate()
        return blocks.a[layout.v[name].slice].copy(), blocks.lam[layout.lam[name].slice].copy()

    (a_more, lam_more), (a_less, lam_less) = forces(step), forces(-step)
    forces(0.0)
    terms = blocks.calls[name, "motion"][1]
    change = along @ terms["t_M"] @ (a_more - a_less)
    if len(lam_more):
        change -= terms["t_G"] @ along @ (lam_more - lam_less)
    return float(x @ beam.elastic_stiffness() @ x), float(-change / (2.0 * step))


@dataclass(frozen=True)
class Course:
    """The run: its parts and settings.

    Attributes:
        instants: Instants in order; the first is the start.
        t_end: End time [s].
        dt: Step [s]; steps also end at instants.
        spacing: Shortest time between two instants [s].
        tableau: Tableau of the method.
        projects: Whether constraints are met again after each step.
        begins: Whether it begins the run: memory then is what signals say.
    """

    instants: Sequence[Instant]
    t_end: float
    dt: float
    spacing: float
    tableau: Tableau
    projects: bool
    begins: bool = True

    @property
    def step(self) -> float:
        """The step that is taken [s]."""
        return min(self.dt, self.spacing)


def run_interpreted(
    blocks: Blocks,
    called: Called,
    course: Course,
    watch: BeamWatch,
    show: Callable[[float], None] = lambda t: None,
    observer: Observer | None = None,
) -> InterpretedRun:
    """Run from the state that the blocks are at.

    Args:
        blocks: The diagram's.
        called: Python blocks, started.
        course: What is run.
        watch: Watch on the beams.
        show: Called with the time [s].
        observer: Receiver of the records, which may stop the run by time.
    """
    rows: list[Row] = []
    kept: dict[Source, list[Array]] = {source: [] for source in blocks.out}
    memory: dict[tuple[str, str], list[Array]] = {key: [] for key in blocks.memory}

    def record() -> None:
        rows.append((float(blocks.t[0]), blocks.q.copy(), blocks.v.copy()))
        for source, array in blocks.out.items():
            kept[source].append(array.copy())
        for key, array in blocks.memory.items():
            memory[key].append(array.copy())

    instants, t_end, dt, projects = course.instants, course.t_end, course.dt, course.projects
    feed, goes_on = _RecordFeed(observer or NoObserver(), blocks, rows, kept), True
    steps, within, failed = 0, watch.judge(blocks.q, float(blocks.t[0])), False
    closed, apart, endless = (0.0, 0.0), None, False
    crossings = Crossings(blocks, projects)
    crossings.restart()

    def record_now() -> None:
        _know(blocks)
        record()

    with np.errstate(all="ignore"):  # What is not finite ends the run, and is named.
        for i, instant in enumerate(instants):
            try:
                closed = max(closed, (_meet(blocks, called, instant, projects), instant[0]))
            except EngagedApartError as error:
                apart = error
                break
            if i == 0 and course.begins:
                blocks.signals()
                blocks.begin()
                crossings.look_anew()
            if instant[2]:
                record_now()
            crossings.begin_span()
            show(instant[0])
            goes_on = feed.send(instant[0])
            if not goes_on:
                break
            until = min(instants[i + 1][0] if i + 1 < len(instants) else t_end, t_end)
            while blocks.t[0] < until and within and not failed and not endless:
                now = float(blocks.t[0])
                last = now + dt >= until - 1e-9 * dt
                try:
                    made = step(blocks, course.tableau, (until if last else now + dt) - now, projects)
                except NotFiniteError:
                    failed = True
                    break
                steps += 1
                failed = not (np.abs(np.concatenate([blocks.q, blocks.v])) < _BEYOND_MOTION).all()
                if last:
                    blocks.t[0] = until
                met = [] if failed else crossings.stop(made)
                if met:
                    record_now()
                    endless = not crossings.execute(met)
                    record_now()
                within = watch.judge(blocks.q, float(blocks.t[0]))
            if failed or endless or not within:
                break
        if goes_on and not failed and not endless and apart is None:
            end = t_end if within else float(blocks.t[0])
            if rows and rows[-1][0] >= end - 1e-9 * dt:
                rows[-1] = (end, *rows[-1][1:])
            else:
                blocks.t[0] = end
                blocks.signals()
                record()
    feed.send(float(blocks.t[0]), is_over=True)
    t_last, fault = float(blocks.t[0]), first_fault(blocks) if failed else ""
    watch.amplify(blocks, rows, kept)
    outcome = _outcome(watch, t_last, steps, fault, failed=failed, within=within)
    if apart is not None:
        outcome = engaged_apart(t_last, apart.gap, apart.name, outcome.notes)
    if endless:
        last_met = (f"{one.block}.{one.crossing}" for one in crossings.met[-8:])
        outcome = without_end(t_last, last_met, outcome.notes)
    outcome = replace(outcome, notes=(*outcome.notes, *crossings.notes, *engaging_notes(closed[1], closed[0])))
    if not goes_on:
        outcome = INTERRUPTED.outcome(outcome.t, outcome.notes, "stopped; the part up to here is kept")
    t, q, v = (np.array(column) for column in zip(*rows, strict=True)) if rows else (np.zeros(0), blocks.q, blocks.v)
    values, memories = ({key: np.array(one) for key, one in by.items()} for by in (kept, memory))
    kept_by, met_all = called.kept(), tuple(crossings.met)
    return InterpretedRun(blocks.resolved, t, values, memories, q, v, outcome, steps, watch.bendings, kept_by, met_all)


def _know(blocks: Blocks) -> None:
    """Compute all signals at the present point, then those that read accelerations and multipliers."""
    blocks.signals()
    if len(blocks.lam):
        blocks.accelerate()
        blocks.signals()


def _meet(blocks: Blocks, called: Called, instant: Instant, projects: bool) -> float:
    """Handle an instant: sample blocks, engage constraints.

    Returns:
        The largest |phi| that engaging has closed.

    Raises:
        EngagedApartError: It is more than may be closed.
    """
    gap = 0.0
    t, due, _ = instant
    blocks.t[0] = t
    reads_accelerations = bool(len(blocks.lam))
    if due:
        blocks.signals()
        if reads_accelerations:
            blocks.accelerate()
        before = blocks.engaged()
        blocks.signals(due, called)
        blocks.update(due)
        if projects and not np.array_equal(before, blocks.engaged()):
            gap = engage(blocks, before)
    return gap


def _outcome(watch: BeamWatch, t: float, steps: int, fault: str, *, failed: bool, within: bool) -> Outcome:
    """The outcome of a run: why it ended at time t, with advice and notes."""
    notes = bending_notes(watch.bendings)
    if failed:
        return ENDS[Status.CALLBACK_FAILED if fault else Status.DIVERGED].outcome(t, notes, fault)
    worst = largest_bending(watch.bendings)
    if worst is not None and not (within and worst.error <= watch.limit):
        return beyond_theory(worst, watch.limit)
    return ENDS[Status.FINISHED].outcome(t, notes, f"{steps} steps")
