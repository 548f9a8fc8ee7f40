"""An interpreted run as its steps are judged: parts of it made once more, accelerations and modes at its records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from symofros.base.arrays import Array, Mask
from symofros.base.options import Options
from symofros.diagrams.run.block_functions import Blocks
from symofros.diagrams.run.examination.examined import Energies, Examined
from symofros.diagrams.run.examination.postures import posture_notes
from symofros.diagrams.run.examination.remarks import remarks
from symofros.diagrams.run.interpret import BeamWatch, Course, InterpretedRun, run_interpreted
from symofros.diagrams.run.python_blocks import Called, CalledBefore
from symofros.runtime.manifold import chart_rate, retract
from symofros.runtime.model import Model
from symofros.simulation.results.examination.paths import Numbers
from symofros.simulation.results.examination.step_size import step_size_note
from symofros.simulation.stepping.methods import METHODS, Method
from symofros.simulation.stepping.resolution import Resolution, Spectrum, resolution

# States whose modes are looked at, as far as their evaluations are below this share of the run's.
_STATES, _SHARE = 4, 0.05


def notes_on_steps(run: InterpretedRun, blocks: Blocks, course: Course, called: Called, method: Method) -> list[str]:
    """Notes on the steps of an interpreted run that has come to its end.

    Args:
        run: Run.
        blocks: Its blocks, which are placed at other states.
        course: What was run.
        called: Blocks of Python's, as they were called.
        method: Stepping method.
    """
    seen = _Revisited(run, blocks, course, called, method)
    steps = seen.resolution()
    notes = [step_size_note(steps.worst, method, course.step)] if steps.worst else []
    examined = seen.examined
    signal = run.values.__getitem__
    return [*posture_notes(examined, signal), *notes, *remarks(examined, steps, signal)]


class _Revisited:
    """An interpreted run and the blocks that made it.

    Args:
        run: Run.
        blocks: Its blocks.
        course: What was run.
        called: Blocks of Python's, as they were called.
        method: Stepping method.
    """

    def __init__(self, run: InterpretedRun, blocks: Blocks, course: Course, called: Called, method: Method) -> None:
        self._run, self._blocks, self._course, self._method = run, blocks, course, method
        self._called = CalledBefore(run.resolved.wired, called.given)

    @property
    def examined(self) -> Examined:
        """The run in the form that its steps are judged in."""
        run, locks = self._run, self._run.resolved.layout.lock_inputs
        u = np.zeros((len(run.t), len(run.resolved.layout.u0)))
        for i in range(len(run.t)) if locks else ():
            self._place(i)
            u[i, locks] = self._blocks.engaged()
        states = run.t, run.q, run.v, u
        return Examined(
            Energies(run.resolved, self._blocks.par, self._energies_of),
            states,
            self._course.step,
            self._method,
            (0.0, 0.0),
            run.steps,
            self._repeat,
            self._accelerations,
            parts=1 + len(run.crossings),
            spacing=self._course.spacing,
        )

    def resolution(self) -> Resolution:
        """How well the time steps resolve the modes of the motion, linearised about a few recorded states."""
        run, nv, h = self._run, self._run.v.shape[1], self._course.step
        wanted = int(min(_STATES, _SHARE * run.steps * self._method.tableau.stages / (2 * nv + 1)))
        if wanted < 1 or not len(run.t):
            return Resolution(None, evident=False)
        rows = np.unique(np.linspace(0, len(run.t) - 1, wanted).astype(int))
        moving = self._moving
        sizes = np.linalg.norm(run.v[:, moving], axis=1)
        metric = np.broadcast_to(np.diag(moving.astype(float)), (len(rows), nv, nv))
        with np.errstate(all="ignore"):  # States that have exploded overflow.
            return resolution(
                self._method,
                h,
                run.steps,
                [float(run.t[i]) for i in rows],
                lambda k: self._spectrum(int(rows[k]), h),
                [float(sizes.max())] * len(rows),
                metric,
                reach=float(np.abs(run.q[np.isfinite(run.q).all(axis=1)]).max(initial=0.0)),
            )

    def _spectrum(self, i: int, h: float) -> Spectrum | None:
        """The linearised motion about a record, by differences of the size of one step's motion."""
        nv, moving = self._run.v.shape[1], self._moving
        # States have scales of their own, by which none changes by more in a step than the motion does.
        scale, none = np.concatenate([moving.astype(float), np.where(moving, h, 1.0)]), np.zeros(2 * nv)
        motion, of_motion = self._scaled_slope(i, h, scale, none), np.tile(moving, 2)
        change = float(np.linalg.norm(motion[of_motion])) or 1e-6
        scale *= np.where(of_motion | (np.abs(motion) <= change), 1.0, change / np.maximum(np.abs(motion), change))
        motion = self._scaled_slope(i, h, scale, none)
        matrix = np.empty((2 * nv, 2 * nv))
        for k in range(2 * nv):
            moved = self._scaled_slope(i, h, scale, change * np.eye(2 * nv)[k])
            matrix[:, k] = (moved - motion) / change
        return (np.eye(2 * nv), matrix, motion) if np.isfinite(matrix).all() else None

    @cached_property
    def _moving(self) -> Mask:
        """Whether each speed counts as one of the motion (nv): states do where nothing else moves."""
        moving = self._run.resolved.layout.moving
        return moving if np.any(self._run.v[:, moving]) else np.ones_like(moving)

    def _scaled_slope(self, i: int, h: float, scale: Array, x: Array) -> Array:
        """H scale (theta', v') at changes x = scale (theta, v) of a record; a scale of 0 is of what stays."""
        blocks, nv, segments = self._blocks, len(self._blocks.v), self._run.resolved.layout.segments
        self._place(i)
        theta = scale[:nv] * x[:nv]
        blocks.q[:], blocks.v[:] = retract(segments, blocks.q.copy(), theta), blocks.v + x[nv:] / scale[nv:]
        blocks.signals()
        blocks.accelerate()
        rate: Array = np.concatenate([chart_rate(segments, theta, blocks.v), blocks.a])
        return h * scale * rate

    def _accelerations(self, rows: Numbers) -> Array:
        a = np.empty((len(rows), self._run.v.shape[1]))
        for k, i in enumerate(rows):
            self._place(int(i))
            self._blocks.signals()
            self._blocks.accelerate()
            a[k] = self._blocks.a
        return a

    def _energies_of(self, name: str) -> Model:
        return self._run.resolved.wired.models.energies(name, Options(backend="interpreter"))

    def _place(self, i: int) -> None:
        """The blocks at a record, with all that they held then."""
        blocks, run = self._blocks, self._run
        blocks.t[0], blocks.q[:], blocks.v[:] = run.t[i], run.q[i], run.v[i]
        for source, values in run.values.items():
            blocks.out[source][...] = values[i]
        for key, values in run.memory.items():
            blocks.memory[key][...] = values[i]

    def _repeat(self, first: int, t_end: float, refinements: int, method: str | None = None) -> Sequence[Array] | None:
        course, slack, start = self._course, 1e-9 * self._course.dt, float(self._run.t[first])
        later = [instant for instant in course.instants if start + slack < instant[0] <= t_end + slack]
        again = replace(
            course,
            instants=[(start, frozenset(), True), *later],
            t_end=t_end,
            dt=0.5**refinements * course.step if refinements else course.dt,
            tableau=METHODS[method].tableau if method else course.tableau,
            begins=False,
        )
        # Of the records of a crossing, at one time, the last has what the crossing changed.
        self._place(int(np.searchsorted(self._run.t, start, "right")) - 1)
        watch = BeamWatch(self._run.resolved, self._blocks.par, np.inf)
        run = run_interpreted(self._blocks, self._called, again, watch)
        return (run.t, run.q, run.v) if run.outcome.ok else None
