"""A run as it is examined: its records, sizes of its motion, parts of it made once more.

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.runtime.model import Model
from symofros.simulation.inputs import Callback
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.loops import run_own
from symofros.simulation.stepping.methods import METHODS, Method
from symofros.simulation.stepping.stepper import Stepper

# States, about, at which a function of the user's is asked again for the inputs; share by which they may differ.
_CALLED, _SAME = 8, 1e-9
# Records, about, among which the fastest is looked for.
_SPEEDS = 64
# Most steps of a part that is made once more in short steps, or with tighter bounds.
MOST_STEPS = 8192
# Share of coordinates and energies that is rounding, and what an equilibrium is found to: at rest nothing else moves.
AT_REST = 1e-11

# Records of a run: t (n), q (n, nq), v (n, nv), u (n, nu).
States = Sequence[Array]


@dataclass(frozen=True)
class ExaminedRun:
    """A run of one model, parts of which are held against shorter steps.

    Attributes:
        stepper: Stepper of the run; its state stays.
        settings: Settings of the run.
        start: Initial q, v.
        states: Records of the run.
        steps: Number of steps.
    """

    stepper: Stepper
    settings: Settings
    start: tuple[Array, Array]
    states: States
    steps: int

    @property
    def model(self) -> Model:
        """Model that was simulated."""
        return self.stepper.model

    @property
    def span(self) -> float:
        """Time between the first record and the last [s]."""
        return float(self.states[0][-1] - self.states[0][0])

    def metrics(self, q: Array, u: Array) -> Array:
        """Mass matrices (n, nv, nv) at configurations (n, nq); units where the model has no mass matrix."""
        nv = self.model.nv
        try:  # What every model is compiled with, but for Options.functions.
            M: Array = self.model.dynamics(q, np.zeros(nv), u, par=self.stepper.par)[0]
        except SymofrosError:
            M = np.broadcast_to(np.eye(nv), (len(q), nv, nv))
        return M

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
            return kinetic, kinetic + model.potential_energy(q, u=u, par=par, t=t)
        except SymofrosError:  # Options.functions left them out.
            return None

    @cached_property
    def _some(self) -> States:
        """Some of the records, the last one among them."""
        return [x[:: -max(1, len(x) // _SPEEDS)] for x in self.states]

    @cached_property
    def fastest(self) -> float:
        """Largest speed of the run, in the norm of the kinetic energy."""
        _, q, v, u = self._some
        return float(self.norms(q, u, v).max())

    @cached_property
    def reach(self) -> float:
        """Largest displacement of the run, in that norm."""
        _, q, _, u = self._some
        moved = self.model.difference(np.broadcast_to(self.states[1][0], q.shape), q)
        return float(self.norms(q, u, moved).max())

    def rounding(self, states: States) -> float:
        """Speed of a motion by rounding, in the norm of the kinetic energy: a share of the coordinates a record."""
        t, q, _, u = states
        coordinates = self.model.difference(self.model.neutral(), q[-1])[np.newaxis]
        span = float(t[-1] - t[0]) / max(1, len(t) - 1)
        return AT_REST * float(self.norms(q[-1:], u[-1:], coordinates)[0]) / span if span > 0.0 else 0.0

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
            self.stepper.same_inputs_again = _gives_again(function, self.states)
        return self.stepper.same_inputs_again

    def repeated(
        self,
        start: Sequence[Any],
        t_end: float,
        dt: float,
        *,
        every: int = 1,
        method: Method | None = None,
        **changes: Any,
    ) -> tuple[int, list[Array]]:
        """Status and states of a part of the run, made once more.

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
        again = Stepper(self.model, method, stepper.inputs, (), stepper.par)
        part.apply(again)
        recorded = run_own(again, q, v, part, lambda _: None)
        return recorded.status, recorded.arrays()

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


def norms_in(metric: Array, v: Array) -> Array:
    """The root of v^T M v for each row of speeds (n, nv) in metrics M (n, nv, nv), without overflow."""
    sizes = np.abs(v).max(axis=1, initial=0.0)
    unit = v / np.where(sizes > 0.0, sizes, 1.0)[:, np.newaxis]
    squares = np.einsum("ni,nij,nj->n", unit, metric, unit)
    norms: Array = sizes * np.sqrt(np.maximum(squares, 0.0))
    return norms


def _gives_again(function: Callback, states: States) -> bool:
    """Whether a function of the user's gives the recorded inputs once more, at some of the states t (n), q, v, u."""
    t, q, v, u = (array[:: -max(1, len(array) // _CALLED)] for array in states)
    try:
        again = [np.asarray(function(float(t[i]), q[i].copy(), v[i].copy()), float) for i in range(len(t))]
    except Exception:  # Whatever it raises: the run itself has ended well.
        return False
    size = float(np.abs(u).max(initial=0.0))
    return all(row.shape == u[i].shape and np.abs(row - u[i]).max() <= _SAME * size for i, row in enumerate(again))
