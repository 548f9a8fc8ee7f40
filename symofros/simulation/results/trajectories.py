"""Many recorded motions of one model, and how each ended."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from functools import partial

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.runtime.beams import NOTED_ERROR, BeamBending, bending_notes, largest_bending, worst_bendings
from symofros.runtime.model import Model
from symofros.simulation.analysis.beam_theory import amplified_in_motion
from symofros.simulation.results.acted import found_of
from symofros.simulation.results.ends import ENDS
from symofros.simulation.results.examination.batch_examination import BatchExamination
from symofros.simulation.results.examination.state_notes import state_notes
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.runs import Index, Runs, indices
from symofros.simulation.results.trajectory import Found, Statistics, Trajectory
from symofros.simulation.stepping.batch_stepper import BatchResults
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.status import Status

# A sample this near before actions, as a share of its time, is their instant: dense_output.c, SYM_GRID_ACTED.
_SAME_INSTANT = 1e-14


@dataclass(frozen=True, repr=False)
class Trajectories(Runs, BatchResults):
    """States over time of many runs of one model, whose batch dimensions are written (...).

    Attributes:
        q: Configurations (..., m, nq); NaN where a run ended before. Likewise v, u.
        t_last: End time of each run (...) [s]; `q_last` (..., nq) and `v_last` (..., nv) are its last good state.
        status: Last status code of each (...); `kinds` and `outcome` state it as text.
        steps: Steps taken (...); `rejected` were tried in vain.
        beam_errors: Largest estimated error of each beam's theory in each run (..., number of beams), at `beam_times`
            [s], with the elastic coordinates `beam_coordinates`.
        model: Model that was simulated.
        t: Times of the samples (m) [s], the same for all.
        par: Run-time parameters (..., npar), or (npar) where all runs share them.
        method: Name of the method.
        seconds: Wall time of all runs together [s].
        processor_seconds: Processor time of all threads together [s]; other programs do not lengthen it.
        examination: What looks at the steps and inputs of a run when its outcome is asked for.
        met: Events met: number of the run, and the event; `events` has those of one.
    """

    model: Model
    t: Array
    par: Array
    method: str
    seconds: float
    processor_seconds: float
    examination: BatchExamination | None = None
    met: tuple[tuple[int, Met], ...] = ()

    @property
    def z(self) -> Array:
        """States of forces (..., m, nz), as q."""
        return self.model.states_of(self.v)

    @property
    def z_last(self) -> Array:
        """Last good states of forces of each run (..., nz)."""
        return self.model.states_of(self.v_last)

    def outcome(self, index: Index) -> Outcome:
        """Outcome of one run; its steps and inputs are examined at this call, which takes as long as a single run."""
        status, states, steps = int(self.status[index]), self._states(index), int(self.steps[index])
        bendings, number = self.bendings(index), self.number(index)
        if self.examination is not None:
            if self.examination.initial.events:
                return self.examination.outcome_with_events(number, status, states, steps, self._met(index))
            return self.examination.outcome(number, status, states, steps, bendings)
        t, worst = float(self.t_last[index]), largest_bending(bendings)
        if status == Status.BEYOND_THEORY and worst is not None:
            return ENDS[status].outcome(t, reason=str(worst))
        par = self.par[index] if self.par.ndim > 1 else self.par
        return ENDS[status].outcome(t, (*state_notes(self.model, states, par), *bending_notes(bendings)))

    def events(self, index: Index) -> tuple[Found, ...]:
        """Events that one run met, in the order of time, with what their actions did."""
        if self.examination is None:
            return ()
        return tuple(found_of(self.examination.single, met) for met in self._met(index))

    def _met(self, index: Index) -> list[Met]:
        number = self.number(index)
        return [met for k, met in self.met if k == number]

    def _changes(self, index: Index) -> tuple[tuple[int, Array], ...]:
        """Samples from which on one run has other parameters: as of `Trajectory`."""
        events = () if self.examination is None else self.examination.initial.events
        acted = [(met, met.done) for met in self._met(index) if met.done is not None and met.done.status > 0]
        lasting = [(met, done) for met, done in acted if events[met.which].restitution is None or done.rests]
        times = self.t[self._reached(index)]
        same = 1.0 - _SAME_INSTANT
        return tuple((int(np.searchsorted(times, met.t * same)), done.par_set) for met, done in lasting)

    def _states(self, index: Index) -> tuple[Array, Array, Array, Array]:
        """Samples that one run reached, and its last state: t (n), q, v, u."""
        reached = self._reached(index)
        t, q, v = self.t[reached], self.q[index][reached], self.v[index][reached]
        u = self.u[index][reached]
        if not len(t) or t[-1] < self.t_last[index]:
            t, q, v = (
                np.append(t, self.t_last[index]),
                np.vstack([q, self.q_last[index]]),
                np.vstack([v, self.v_last[index]]),
            )
            u = np.vstack([u, u[-1:] if len(u) else np.zeros((1, u.shape[1]))])
        return t, q, v, u

    def _reached(self, index: Index) -> npt.NDArray[np.bool_]:
        """Which samples one run reached (m)."""
        before = self.t <= self.t_last[index] + 1e-9 * abs(self.t_last[index])
        return np.asarray(before & ~np.isnan(self.q[index]).any(axis=-1))

    def bendings(self, index: Index) -> tuple[BeamBending, ...]:
        """Bending of each beam in one run, at the step where its theory errs most."""
        par = self.par[index] if self.par.ndim > 1 else self.par
        beams, t, elastic = self.model.beams(par), self.beam_times[index], self.beam_coordinates[index]
        amplify = partial(worst_bendings, beams, t, elastic)
        return amplified_in_motion(amplify(), amplify, self.model, self._states(index), par)

    def __getitem__(self, index: Index) -> Trajectory:
        """One run, as far as it was recorded; `index` addresses all batch dimensions."""
        reached = self._reached(index)
        par = self.par[index] if self.par.ndim > 1 else self.par
        if self.examination is not None and (self.model.record.rigid_contacts or self.model.record.sticking):
            par = self.examination.first_parameters(self.number(index))
        statistics = Statistics(self.method, int(self.steps[index]), int(self.rejected[index]), -1, -1, self.seconds)
        return Trajectory(
            self.model,
            self.t[reached],
            self.q[index][reached],
            self.v[index][reached],
            self.u[index][reached],
            par,
            self.outcome(index),
            self.events(index),
            statistics,
            self.bendings(index),
            self._changes(index),
            self.z[index][reached],
        )

    def __iter__(self) -> Iterator[Trajectory]:
        """Run after run."""
        return (self[index] for index in np.ndindex(self.shape))

    def __repr__(self) -> str:
        """Model, method, sizes, and how the runs ended."""
        name = self.model.record.name
        return f"<Trajectories of '{name}' by {self.method}: {self.shape} runs, {len(self.t)} samples; {self.ends}>"

    def __str__(self) -> str:
        """Counts of outcomes, the first failure, the number with strongly bent beams, and the first note on steps."""
        lines = [self.ends or "no trajectories", *self.first_failure()]
        noted = indices(np.asarray((self.beam_errors > NOTED_ERROR).any(axis=-1)))
        if noted:
            largest = largest_bending(self.bendings(noted[0]))
            lines.append(f"  beams bend much in {len(noted)}, first: {list(noted[0])}: {largest}")
        for index in self.examined():
            if self.examination is None or not self.steps[index]:
                break
            states, steps = self._states(index), int(self.steps[index])
            notes = self.examination.notes_on_steps(self.number(index), states, steps)
            if notes:
                lines.append(f"  steps, first seen in {list(index)}: {notes[0]}")
                break
        return "\n".join(lines)


@dataclass(frozen=True, repr=False)
class StatefulTrajectories(Trajectories):
    """Runs of a model with states of forces.

    Attributes:
        whole: The runs of the model's `carried`.
    """

    whole: Trajectories = field(kw_only=True)

    @property
    def z(self) -> Array:
        """States of forces (..., m, nz), as q."""
        return self.whole.z

    @property
    def z_last(self) -> Array:
        """Last good states of forces of each run (..., nz)."""
        return self.whole.z_last

    def outcome(self, index: Index) -> Outcome:
        """Outcome of one run."""
        return self.whole.outcome(index)

    def events(self, index: Index) -> tuple[Found, ...]:
        """Events that one run met."""
        return tuple(found.of(self.model) for found in self.whole.events(index))

    def bendings(self, index: Index) -> tuple[BeamBending, ...]:
        """Bending of each beam in one run."""
        return self.whole.bendings(index)

    def __getitem__(self, index: Index) -> Trajectory:
        """One run, as far as it was recorded."""
        return self.whole[index].of(self.model)

    def __str__(self) -> str:
        """Text of the runs of the carried model."""
        return str(self.whole)


def of_stated(model: Model, runs: Trajectories) -> Trajectories:
    """Runs of a model's `carried` as those of the model: q, v and z apart."""
    if model.carried is model:
        return runs
    arrays = {item.name: getattr(runs, item.name) for item in fields(runs)}
    arrays |= {"q": runs.q[..., : model.nq], "q_last": runs.q_last[..., : model.nq]}
    arrays |= {"v": runs.v[..., : model.nv], "v_last": runs.v_last[..., : model.nv]}
    return StatefulTrajectories(**arrays | {"model": model}, whole=runs)
