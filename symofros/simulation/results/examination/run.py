"""A run as it is examined: its records, sizes of its motion, parts of it made once more.

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array, Mask
from symofros.errors import SymofrosError
from symofros.runtime.manifold import retract
from symofros.runtime.model import Model
from symofros.simulation.results.examination.finer_steps import HeldRun, Part, States, change_of_states
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.loops import Recorded, run_to_end
from symofros.simulation.stepping.methods import METHODS, Method
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.windows import WHOLE, Window
from symofros.simulation.user_functions import gives_again

# Leap of a function's input between two states, of its range.
_LEAP = 0.1
# Records, about, among which the fastest is looked for.
_SPEEDS = 64
# Most steps of a part that is made once more in short steps, or with tighter bounds.
MOST_STEPS = 8192
# Share of coordinates and energies that is rounding, and what an equilibrium is found to: at rest nothing else moves.
AT_REST = 1e-11

# Differences of displacements count by this share: they are relative to how they change in the run, while coordinates
# themselves may be larger; those of energies by another: they are squares.
_POSITIONS, _ENERGIES = 3.0, 2.0


class Ranks(NamedTuple):
    """Lowest and highest rank of the constraints' Jacobian that a run met, and when it first met the lowest [s]."""

    least: int
    most: int
    when: float

    @classmethod
    def of(cls, stepper: Stepper) -> Ranks:
        """Ranks that a stepper has met."""
        run = stepper.run
        return cls(int(run.rank_min), int(run.rank_max), float(run.t_rank_min))


@dataclass(frozen=True)
class ExaminedRun(HeldRun):
    """A run of one model, parts of which are held against finer steps.

    Attributes:
        stepper: Stepper of the run; its state stays.
        settings: Settings of the run.
        start: Initial q, v.
        states: Records of the run.
        steps: Number of steps.
        counted: Ranks of the constraints where another stepper has met them; otherwise those that its own has.
        recorded: All that it recorded, where `states` are ends of steps: only these hold what a function gave there.
    """

    stepper: Stepper
    settings: Settings
    start: tuple[Array, Array]
    states: States
    steps: int
    counted: Ranks | None = None
    recorded: States = ()

    @property
    def ranks(self) -> Ranks:
        """Ranks of the constraints' Jacobian that it met."""
        return self.counted or Ranks.of(self.stepper)

    @property
    def model(self) -> Model:
        """Model that was simulated."""
        return self.stepper.model

    @property
    def span(self) -> float:
        """Time between the first record and the last [s]."""
        return float(self.states[0][-1] - self.states[0][0])

    @cached_property
    def moving(self) -> Mask:
        """Whether each speed counts as motion (nv): states of forces and blocks do where nothing else moves."""
        moving = self.stepper.moving
        moves = bool(np.any(self.start[1][moving]) or np.any(self.states[2][:, moving]))
        return moving if moves else np.ones_like(moving)

    @property
    def is_of_first_order(self) -> bool:
        """Whether fixed steps err by their first power, as much as forces that bend make better methods err."""
        return not self.settings.adaptive and self.settings.method.order == 1

    @cached_property
    def amplifies(self) -> bool:
        """Whether contacts, or forces or inputs that bend or jump, may amplify errors: no mode at a state shows it."""
        if self.model.record.has_compliant_contacts or self._inputs_jump:
            return True
        t, q, v, u = self.states
        states = {"t": t[:, np.newaxis], "q": q, "v": v, "u": u}
        return self.model.formula_instants.bend(self.stepper.laws, self.stepper.par, states)

    @property
    def _inputs_jump(self) -> bool:
        """Whether inputs jump within fixed steps: held samples, or those of a function from one state to the next."""
        inputs, u = self.stepper.inputs, self.states[3]
        if inputs.callback is None or self.settings.adaptive:
            return self.settings.samples_within_steps(inputs.jumps)
        return bool(np.any(np.abs(np.diff(u, axis=0)) > _LEAP * np.ptp(u, axis=0)))

    def metrics(self, q: Array, u: Array) -> Array:
        """Mass matrices (n, nv, nv) at configurations (n, nq), states left out; units where there is no mass matrix."""
        nv = self.model.nv
        try:  # What every model is compiled with, but for Options.functions.
            M: Array = self.model.dynamics(q, np.zeros((len(q), nv)), u, par=self.stepper.par)[0]
        except SymofrosError:
            M = np.broadcast_to(np.eye(nv), (len(q), nv, nv))
        return self._of_motion(M)

    def _of_motion(self, M: Array) -> Array:
        """Metrics (n, nv, nv) in which speeds that are no motion, of other units, have no size."""
        return M if self.moving.all() else M * (self.moving[:, np.newaxis] & self.moving)

    def norms(self, q: Array, u: Array, v: Array) -> Array:
        """The root of v^T M v for each row of speeds (n, nv): in it metres and radians a second have one unit."""
        return norms_in(self.metrics(q, u), v)

    def energies(self, states: States) -> tuple[Array, Array] | None:
        """Kinetic and total energy (n) of records; None where motions are prescribed or the model has no energies."""
        model, par, (t, q, v, u) = self.model, self.stepper.par, states
        if model.record.driven or not (np.isfinite(q).all() and np.isfinite(v).all()):
            return None
        try:
            kinetic = model.kinetic_energy(q, v, u=u, par=par)
            z = model.states_of(v) if model.nz else None
            return kinetic, kinetic + model.potential_energy(q, u=u, par=par, t=t, z=z)
        except SymofrosError:  # Options.functions left them out.
            return None

    @cached_property
    def _some(self) -> States:
        """Some of the records, the last one among them."""
        stride = max(1, len(self.states[0]) // _SPEEDS)
        return [np.ascontiguousarray(x[::-stride]) for x in self.states]  # As C reads them.

    @cached_property
    def _rest_of_some(self) -> tuple[Array, float]:
        """Mass matrices of `_some`, the last record's first; the largest acceleration there without speeds.

        That which gravity, or the applied forces, alone would give, in the norm of the kinetic energy.
        """
        t, q, _, u = self._some
        try:
            M, h, Q = self.model.dynamics(q, np.zeros((len(q), self.model.nv)), u, par=self.stepper.par, t=t)
            alone = np.asarray(np.linalg.solve(M, np.stack([h, Q], axis=-1)), dtype=np.float64)
        except (SymofrosError, np.linalg.LinAlgError):  # Options.functions left them out; what moves no mass.
            return self.metrics(q, u), 0.0
        M = self._of_motion(M)
        return M, float(np.nan_to_num(norms_in(M, alone.swapaxes(1, 2))).max(initial=0.0))

    @property
    def _metrics_of_some(self) -> Array:
        return self._rest_of_some[0]

    @cached_property
    def fastest(self) -> float:
        """Largest speed of the run, in the norm of the kinetic energy."""
        return float(norms_in(self._metrics_of_some, self._some[2]).max())

    @property
    def inertia(self) -> float:
        """Norm of a unit of each speed at the end of the run."""
        return float(np.sqrt(np.trace(self._metrics_of_some[0])))

    @property
    def allowed(self) -> float:
        """Error of all states that the absolute tolerance allows a step, in the norm of the kinetic energy."""
        return self.settings.atol * self.inertia if self.settings.adaptive else 0.0

    @cached_property
    def reach(self) -> float:
        """Largest displacement of the run, in that norm."""
        _, q, _, _ = self._some
        moved = self.model.difference(np.broadcast_to(self.states[1][0], q.shape), q)
        return float(norms_in(self._metrics_of_some, moved).max())

    def rounding(self, states: States) -> float:
        """Speed of a motion by rounding, in the norm of the kinetic energy.

        A share of the coordinates a record, and of what forces that are balanced would give over the records.
        """
        t, q, _, u = states
        span = float(t[-1] - t[0])
        if not span > 0.0:
            return 0.0
        coordinates = self.model.difference(self.model.neutral(), q[-1])[np.newaxis]
        metric = self._metrics_of_some[:1] if states is self.states else self.metrics(q[-1:], u[-1:])
        moved = float(norms_in(metric, coordinates)[0]) * max(1, len(t) - 1) / span
        return AT_REST * (moved + span * self._rest_of_some[1])

    @property
    def repeatable(self) -> bool:
        """Whether it can be made once more: by a method without history, and with the same inputs."""
        return not self.stepper.method.family.multistep and self.same_inputs_again

    @property
    def same_inputs_again(self) -> bool:
        """Whether a function of the user's that gives the inputs gives the same again; True where there is none.

        It is called at some of the recorded states, the last one first, so that what it keeps of the run shows: once a
        run, whose stepper keeps the answer. In real time it is not called: what it serves may be hardware.
        """
        function = self.stepper.inputs.callback
        if function is None or self.settings.realtime:
            return function is None
        if self.stepper.same_inputs_again is None:
            self.stepper.same_inputs_again = gives_again(function, self.recorded or self.states)
        return self.stepper.same_inputs_again

    def repeated(self, start: Sequence[Any], t_end: float, dt: float, **changes: Any) -> tuple[int, list[Array]]:
        """Status and states of a part of the run, made once more; arguments as of `made_again`."""
        _, recorded = self.made_again(start, t_end, dt, **changes)
        return recorded.status, recorded.arrays()

    def made_again(
        self,
        start: Sequence[Any],
        t_end: float,
        dt: float,
        *,
        every: int = 1,
        method: Method | None = None,
        **changes: Any,
    ) -> tuple[Stepper, Recorded]:
        """Another stepper that has made a part of the run once more, and what it recorded.

        Args:
            start: First t, q, v.
            t_end: End [s].
            dt: Step [s]; of adaptive methods the first one, 0: found anew.
            every: Number of steps between records.
            method: Stepping method; the run's own if not given.
            changes: Other settings of the part.
        """
        (t, q, v), stepper = start, self.stepper
        method = method or stepper.method
        once = {"max_steps": None, "realtime": 0.0, "grid": np.zeros(0)} | changes
        part = replace(self.settings, t0=float(t), t_end=t_end, dt=dt, every=every, method=method, **once)
        part = replace(part, project=part.project or (method != stepper.method and self.model.nc > 0))
        again = self._another(method)
        part.apply(again)
        return again, run_to_end(again, q, v, part, lambda _: None)

    def _another(self, method: Method) -> Stepper:
        """Another stepper for a part of the run, in which no event acts."""
        again = Stepper(self.model, method, self.stepper.inputs, (), self.stepper.par)
        if self.model.record.rigid_contacts:
            again.contact_memory[:] = self.stepper.contact_memory
        return again

    def in_short_steps(self, start: Sequence[Any], t_end: float, part: float) -> tuple[int, list[Array]]:
        """Status and states of a part of the run, made once more in steps that are no longer than `part` [s].

        In place of a method that keeps a history another one is taken.
        """
        method, settings = self.stepper.method, self.settings
        if method.family.multistep:
            method = METHODS["rodas4" if self.stepper.inputs.callback is None else "dopri5"]
        if settings.adaptive:
            return self.repeated(start, t_end, 0.0, method=method, max_steps=MOST_STEPS, max_step=part)
        return self.repeated(start, t_end, min(part, settings.dt), method=method, max_steps=MOST_STEPS)

    @property
    def h(self) -> float:
        """Step [s]; of adaptive methods the first one."""
        return self.settings.dt

    @property
    def short(self) -> bool:
        """Whether all of it is held against finer steps."""
        return self.steps <= WHOLE

    def coarse(self, window: Window, every: int) -> States | None:
        """Records of a window, or recomputed steps where these are fewer."""
        if self.short:
            return self.states
        if len(self.states[0]) == self.steps + 1:  # A record at each step.
            return [x[window.first : window.first + self._count(window) + 1 : every] for x in self.states]
        return self.fine(window, 0, every)

    def fine(self, window: Window, refinements: int, every: int) -> States | None:
        """The window by halves of the step, quarters, ..., with the states at the ends of the steps."""
        start: Sequence[Any] = [x[window.first] for x in self.states[:3]]
        t_end, parts = float(start[0]) + self._count(window) * self.h, 2**refinements
        if self.short:
            start, t_end = (self.settings.t0, *self.start), window.t_end
        status, states = self.repeated(start, t_end, self.h / parts, every=every * parts)
        return states if status >= 0 else None

    def _count(self, window: Window) -> int:
        return max(1, round((window.t_end - float(self.states[0][window.first])) / self.h))

    def change(self, coarse: States, fine: States, part: Part) -> tuple[float, str]:
        """In the norm of the kinetic energy; states of forces and blocks by themselves."""
        rows = slice(min(len(coarse[0]), len(fine[0])))  # One of them may end with a part of `every` steps.
        if part == "run":
            change = self.whole_change(coarse, fine)
            rows = rows if len(coarse[0]) == len(fine[0]) else slice(-1, None)
        else:
            change = self.change_in_part([x[rows] for x in coarse], [x[rows] for x in fine])
        ends = (x[2][rows] for x in (coarse, fine))
        return max(change, change_of_states(*(v[:, ~self.moving] for v in (self.states[2], *ends)))), ""

    def change_in_part(self, coarse: States, fine: States, size: float = 0.0) -> float:
        """Largest difference of speeds and displacements, relative to the run's fastest and what that makes of time.

        Args:
            coarse: States of a part of the run.
            fine: The same by finer steps.
            size: Speed, and displacement, that the run's count as at least, in the norm of the kinetic energy.
        """
        (_, q, v, _), (t, q_fine, v_fine, u) = coarse, fine
        with np.errstate(all="ignore"):  # What has exploded overflows.
            changes = v - v_fine, self.model.difference(q_fine, q)
            faster, apart = (float(self.norms(q_fine, u, x).max()) for x in changes)
        span, rounding = float(t[-1] - t[0]), max(self.rounding(fine), self.rounding(self.states))
        largest = max(self.fastest, rounding, size)
        reach = max(size, min(largest * span, max(self.reach, rounding * span)))  # To and fro comes no farther.
        return max(share_of(faster, largest), share_of(apart, reach) / _POSITIONS)

    def whole_change(self, states: States, finer: States) -> float:
        """Largest difference of speeds, displacements and energies, relative to the largest of each (17), (17a).

        Args:
            states: Its records; the last are compared where the finer run has other rows.
            finer: Records of the finer run.
        """
        (_, q, v), (t, q_finer, v_finer, u) = states[:3], finer
        rows = slice(None) if len(v) == len(v_finer) else slice(-1, None)
        with np.errstate(all="ignore"):  # What has exploded overflows.
            displacements = self.model.difference(np.broadcast_to(self.start[0], q_finer.shape), q_finer)
            changes = self.model.difference(q_finer[rows], q[rows]), v[rows] - v_finer[rows]
            moved, fastest = (float(self.norms(q_finer, u, x).max()) for x in (displacements, v_finer))
            apart, faster = (float(self.norms(q_finer[rows], u[rows], x).max()) for x in changes)
            rounding, span = self.rounding(finer), float(t[-1] - t[0])
            change = [
                share_of(faster, max(fastest, rounding)),
                share_of(apart, max(moved, rounding * span)) / _POSITIONS,
            ]
            energies = self.energies(finer)
            others = self.energies((t[rows], q[rows], v[rows], u[rows]))
            if energies is not None and others is not None:
                largest = float(np.abs(energies[1] - energies[0]).max() + energies[0].max())
                spread = max(float(energies[0].max()), float(np.ptp(energies[1])), AT_REST * largest)
                change.append(share_of(float(np.abs(others[1] - energies[1][rows]).max()), spread) / _ENERGIES)
                bent = self._potential_norms((t[rows], q_finer[rows], u[rows]), changes[0])
                change.append(share_of(float(bent.max()), math.sqrt(2.0 * spread)))
        return max(change)

    def _potential_norms(self, states: Sequence[Array], changes: Array) -> Array:
        """Root of |V(q + x) - 2 V(q) + V(q - x)| of displacements x (n, nv), a norm of linear motions (17a)."""
        (t, q, u), segments = states, self.model.record.segments

        def energy(x: Array) -> Array:
            return self.model.potential_energy(retract(segments, q, x), u=u, par=self.stepper.par, t=t)

        norms: Array = np.sqrt(np.abs(energy(changes) - 2.0 * energy(0.0 * changes) + energy(-changes)))
        return norms


def norms_in(metric: Array, v: Array) -> Array:
    """The root of v^T M v without overflow, (n) or (n, m).

    Args:
        metric: Metrics M (n, nv, nv).
        v: Speeds for each of them (n, nv), or several (n, m, nv).
    """
    sizes = np.abs(v).max(axis=-1, initial=0.0)
    unit = v / np.where(sizes > 0.0, sizes, 1.0)[..., np.newaxis]
    # Products of matrices pay where a metric serves several.
    squares = np.einsum("ni,nij,nj->n", unit, metric, unit) if v.ndim == 2 else (unit @ metric * unit).sum(axis=-1)
    norms: Array = sizes * np.sqrt(np.maximum(squares, 0.0))
    return norms


def share_of(part: float, whole: float) -> float:
    """Part of a whole; none of nothing."""
    return part / whole if whole > 0.0 else 0.0
