"""Many recorded motions of one model, and how each ended."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.runtime.beams import NOTED_ERROR, BeamBending, bending_notes, largest_bending, worst_bendings
from symofros.runtime.model import Model
from symofros.simulation.analysis.beam_theory import UNAMPLIFIED, amplifications
from symofros.simulation.analysis.kinematics.postures import limit_notes
from symofros.simulation.analysis.singular_mass import ADVICE, singular_mass
from symofros.simulation.results.examination.batch_examination import BatchExamination
from symofros.simulation.results.outcome import Kind, Outcome
from symofros.simulation.results.trajectory import Statistics, Trajectory
from symofros.simulation.stepping.resolution import Mode
from symofros.simulation.stepping.status import Status

Index = int | tuple[int, ...]

# Status of C -> kind, reason, advice.
_ENDS: dict[int, tuple[Kind, str, str]] = {
    Status.FINISHED: ("finished", "the end asked for", ""),
    Status.RUNNING: ("interrupted", "max_steps are done, or Ctrl-C", ""),
    Status.DIVERGED: (
        "diverged",
        "a state has grown without bound",
        "a smaller dt or an adaptive method; sf.simulate from this state says more",
    ),
    Status.SINGULAR: (
        "singular",
        "the mass matrix is singular beyond what the constraints bind",
        "give every speed an inertia or a constraint",
    ),
    Status.STEP_TOO_SMALL: (
        "step too small",
        "the error bounds ask for steps below rounding",
        "look for a force that jumps or a singular posture here; loosen rtol",
    ),
    Status.CALLBACK_FAILED: ("input failed", "a constant input is not a finite number", "mend its value"),
    Status.PROJECTION_FAILED: (
        "constraints lost",
        "the state is off the constraints and projection does not mend it",
        "start from sf.assemble; a smaller step; the loop may be stretched to its end",
    ),
    Status.ENERGY_LOST: (
        "constraints lost",
        "keeping the constraints has taken the energy of the motion: they are singular here, or the steps are too long",
        "sf.simulate from this state says which; a smaller step, or a terminal event before it",
    ),
    Status.NO_ROTATION: (
        "input failed",
        "a quaternion among the inputs is not of unit length",
        "divide it by its length; samples of a rotation have to be dense enough for the chords between them",
    ),
    Status.BEYOND_THEORY: ("beyond theory", "a beam is bent beyond second-order theory", ""),
}
# Statuses that a step past the limit of stability leads to.
_EXPLODED = (Status.DIVERGED, Status.BEYOND_THEORY)
# Runs whose steps the summary of a batch looks at.
_EXAMINED = 8


@dataclass(frozen=True, repr=False)
class Trajectories:
    """States over time of many runs of one model, whose batch dimensions are written (...).

    Attributes:
        model: Model that was simulated.
        t: Times of the samples (m) [s], the same for all.
        q: Configurations (..., m, nq); NaN where a run ended before.
        v: Speeds (..., m, nv), as q.
        u: Inputs (..., m, nu), as q.
        par: Run-time parameters (..., npar), or (npar) where all runs share them.
        t_last: End time of each run (...) [s].
        q_last: Last good configuration of each (..., nq).
        v_last: Last good speeds of each (..., nv).
        status: Last status code of each (...); `kinds` and `outcome` state it as text.
        steps: Steps taken (...).
        rejected: Steps tried in vain (...).
        beam_errors: Largest estimated error of each beam's theory in each run (..., number of beams).
        beam_times: When that was (..., number of beams) [s].
        beam_coordinates: Elastic coordinates of all beams, each then (..., number of elastic coordinates).
        method: Name of the method.
        seconds: Wall time of all runs together [s].
        processor_seconds: Processor time of all threads together [s]; other programs do not lengthen it.
        examination: What looks at the steps and inputs of a run when its outcome is asked for.
    """

    model: Model
    t: Array
    q: Array
    v: Array
    u: Array
    par: Array
    t_last: Array
    q_last: Array
    v_last: Array
    status: npt.NDArray[np.int32]
    steps: npt.NDArray[np.int64]
    rejected: npt.NDArray[np.int64]
    beam_errors: Array
    beam_times: Array
    beam_coordinates: Array
    method: str
    seconds: float
    processor_seconds: float
    examination: BatchExamination | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """The batch dimensions."""
        return self.status.shape

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """Which runs came to their end (...)."""
        return np.asarray(self.status == Status.FINISHED)

    @property
    def kinds(self) -> npt.NDArray[np.str_]:
        """Kind of each run's Outcome, as a word (...): how the run ended."""
        return np.asarray(np.vectorize(lambda status: _ENDS[int(status)][0], otypes=["U16"])(self.status))

    def outcome(self, index: Index) -> Outcome:
        """Outcome of one run; its steps and inputs are examined at this call."""
        kind, reason, advice = _ENDS[int(self.status[index])]
        bendings = self.bendings(index)
        t, reached = float(self.t_last[index]), self._states(index)
        record = self.model.record
        values = dict(zip("qvu", reached[1:], strict=True))
        notes = (*limit_notes(record.vectors, record.joint_limits, reached[0], values), *bending_notes(bendings))
        if self.status[index] < 0:
            reason = self._input_fault(index) or reason
        mode, remarks = self._step_size(index)
        notes = (*notes, *remarks)
        if self.status[index] in _EXPLODED and mode is not None and mode.amplified:
            reason, advice = f"the step is past the limit of stability of '{self.method}'", "see the note"
            return Outcome("diverged", t, reason, advice, notes)
        if self.status[index] == Status.DIVERGED:
            par = self.par[index] if self.par.ndim > 1 else self.par
            massless = singular_mass(self.model, self.q_last[index], par)
            if massless:
                return Outcome("singular", t, massless, ADVICE, notes)
        if self.status[index] == Status.BEYOND_THEORY:
            worst = largest_bending(bendings)
            assert worst is not None
            return Outcome(kind, t, str(worst), worst.remedy)
        return Outcome(kind, t, reason, advice, notes)

    def _number(self, index: Index) -> int:
        """Number of a run among all."""
        return int(np.arange(self.status.size).reshape(self.shape)[index])

    def _input_fault(self, index: Index) -> str:
        last = float(self.t_last[index]), self.q_last[index], self.v_last[index]
        return self.examination.input_fault(self._number(index), *last) if self.examination else ""

    def _step_size(self, index: Index) -> tuple[Mode | None, tuple[str, ...]]:
        """The mode that the steps of one run resolve worst, and notes on its steps."""
        if self.examination is None or not self.steps[index]:
            return None, ()
        states = self._states(index)
        settings = self.examination.settings
        meant = max(1, round((settings.t_end - settings.t0) / settings.dt)) if settings.dt > 0.0 else 1
        failed, ended_well = self.status[index] in _EXPLODED, bool(self.status[index] >= 0)
        steps = meant if failed else int(self.steps[index])
        return self.examination.step_size(self._number(index), states, steps, ended_well=ended_well, failed=failed)

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
        bent = worst_bendings(beams, t, elastic)
        if max((bending.error for bending in bent), default=0.0) < UNAMPLIFIED:
            return bent
        states = self._states(index)
        return worst_bendings(beams, t, elastic, amplifications(self.model, states, par)) if len(states[0]) else bent

    def __getitem__(self, index: Index) -> Trajectory:
        """One run, as far as it was recorded; `index` addresses all batch dimensions."""
        reached = self._reached(index)
        par = self.par[index] if self.par.ndim > 1 else self.par
        statistics = Statistics(self.method, int(self.steps[index]), int(self.rejected[index]), -1, -1, self.seconds)
        return Trajectory(
            self.model,
            self.t[reached],
            self.q[index][reached],
            self.v[index][reached],
            self.u[index][reached],
            par,
            self.outcome(index),
            (),
            statistics,
            self.bendings(index),
        )

    def __len__(self) -> int:
        """Number of runs."""
        return self.status.size

    def __iter__(self) -> Iterator[Trajectory]:
        """Run after run."""
        return (self[index] for index in np.ndindex(self.shape))

    def __repr__(self) -> str:
        """Model, method, sizes, and how the runs ended."""
        counts = zip(*np.unique(self.kinds, return_counts=True), strict=True)
        ends = ", ".join(f"{count} {kind}" for kind, count in counts)
        name = self.model.record.name
        return f"<Trajectories of '{name}' by {self.method}: {self.shape} runs, {len(self.t)} samples; {ends}>"

    def __str__(self) -> str:
        """How many ended how, the first that went wrong, in how many beams bend much, and the steps of some."""
        kinds = self.kinds
        names, counts = np.unique(kinds, return_counts=True)
        lines = [", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True)) or "no trajectories"]
        wrong = np.argwhere(~self.ok)
        if len(wrong):
            index = tuple(map(int, wrong[0]))
            lines.append(f"  first: {list(index)}: {self.outcome(index)}")
        noted = np.argwhere((self.beam_errors > NOTED_ERROR).any(axis=-1))
        if len(noted):
            index = tuple(map(int, noted[0]))
            largest = largest_bending(self.bendings(index))
            lines.append(f"  beams bend much in {len(noted)}, first: {list(index)}: {largest}")
        good = np.argwhere(self.ok)
        for row in good[:: max(1, -(-len(good) // _EXAMINED))]:
            index = tuple(map(int, row))
            _, notes = self._step_size(index)
            if notes:
                lines.append(f"  steps, first seen in {list(index)}: {notes[0]}")
                break
        return "\n".join(lines)
