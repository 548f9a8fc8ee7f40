"""sf.Steppers: many motions of a model whose caller makes the steps, together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array, real_array
from symofros.errors import ShapeError, SymofrosError
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.events import events_of
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.acted import failure_of, found_of
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.trajectories import Trajectories
from symofros.simulation.results.trajectory import Found
from symofros.simulation.settings import check_fit
from symofros.simulation.simulate import prepare_run
from symofros.simulation.simulate_batch import starts_off
from symofros.simulation.stepped import (
    MOST_STEPS,
    SteppedModel,
    check_owner,
    no_steps,
    options_by_hand,
    owner_of,
)
from symofros.simulation.stepper import Stepper, checked_inputs, fixed_inputs, read_only, settings_by_hand
from symofros.simulation.stepping.batch_by_hand import BatchState, Followed, HandBatch, Held
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.status import Status


class Steppers(SteppedModel):
    """Motions of one model that are stepped by hand together, several in the lanes of a vector, shared by threads.

    Each takes the steps that `simulate_batch` would take, and does not depend on the others. One that ends stays at its
    last good state, and the others go on.

    ::

        steppers = sf.Steppers(model, 1024, dt=1e-3)
        steppers.reset(q0)
        for _ in range(100):
            steppers.step(policy(steppers.q, steppers.v))

    Args:
        model: Compiled with backend "c".
        n: Number of motions.
        u: Inputs that are not given by hand, as `simulate` takes them by name: numbers, formulas, Signals.
        par: Run-time parameters (npar), or of each motion (n, npar); the model's own by default.
        events: Name -> formula or Event, with actions as of `simulate`, of each motion. A terminal one ends its motion
            within a step; `reset` begins it anew, with all events and modes as at first.
        threads: Number of threads; by default that of the model (`Model.with_threads`).
        options: Options of stepping and stabilisation; those of `SimulationOptions()` by default.
        changes: Fields of SimulationOptions by name, which replace those of `options`; methods are explicit, their
            steps fixed.

    Attributes:
        model: Model that is stepped.
        par: Run-time parameters (npar) of all, or of each motion (n, npar), as where actions change them; a view that
            can't be written.
        dt: Length of a step [s].
        inputs: Names of the inputs that `step` takes, in order.
        t: Present times (n) [s], a view that steps change: copy it to keep it.
        q: Present configurations (n, nq), as t.
        v: Present speeds (n, nv), as t.
        z: Present states of forces (n, nz), as t.

    Raises:
        ShapeError: An array does not fit.
        UnknownNameError: The name of an option, an input or in a formula is unknown.
        SymofrosError: The options contradict each other or have no meaning here, or the method is none of batches.
    """

    @checked
    def __init__(
        self,
        model: Model,
        n: int,
        *,
        u: Mapping[str, Any] | None = None,
        par: ArrayLike | None = None,
        events: Mapping[str, Any] | None = None,
        threads: int | None = None,
        options: SimulationOptions | None = None,
        **changes: Any,
    ) -> None:
        chosen = options_by_hand(options, changes, ("n", "u", "par", "events", "threads"))
        settings = settings_by_hand(model, chosen)
        if not settings.method.family.batched or settings.adaptive:
            explicit = ", ".join(name for name, method in METHODS.items() if method.family.batched)
            what, rule = f"steppers: '{chosen.method}' has no fixed explicit steps", f"batches step by {explicit}"
            raise SymofrosError(what, chosen.method, rule, "adaptive=False, or an sf.Stepper for each motion")
        n, threads = int(n), int(model.threads if threads is None else threads)
        self._given: dict[str, Any] = {"u": u, "events": events, "threads": threads, "options": chosen}
        for name, number in (("n", n), ("threads", threads)):
            if not 1 <= number < _MOST:
                what, rule = f"steppers: {name} is no number of them", f"1 <= {name} < {_MOST}"
                raise SymofrosError(what, str(number), rule, "give a whole number of that range")
        self._stepping = Lock()
        stated, model = model, model.carried
        self.model, self.n, self.dt = stated, n, settings.dt
        self._par = np.array(model.parameter_values if par is None else model.checked_parameters(par))
        if self._par.shape not in ((model.npar,), (n, model.npar)):
            raise self._misfit("par", self._par, model.npar, "parameters of each motion, or one set for all")
        plan = plan_inputs(stated, u)
        check_fit(model, settings, plan)
        prepare_run(model, settings)
        self._settings, self._kind = settings, owner_of("steppers", model.record.name)
        looked_for = events_of(model, events)
        if any(event.acts for event in looked_for):
            self._par = np.array(np.broadcast_to(self._par, (n, model.npar)), order="C")
        self._begun_with = self._par.copy()
        rows = np.atleast_2d(self._par.copy())
        self._hand = HandBatch(model, settings, plan, fixed_inputs(u), rows, n, threads, looked_for)
        self.inputs = tuple(model.names.u[i] for i in self._hand.held)
        results = self._hand.results
        q, v = results.q_last[:, : stated.nq], results.v_last[:, : stated.nv]
        self.t, self.q, self.v, self.z, self._status = (
            read_only(array) for array in (results.t_last, q, v, model.states_of(results.v_last), results.status)
        )
        self._kept = np.linspace(0, n - 1, min(n, _KEPT)).astype(int)
        self._followed: dict[int, Followed] = {}
        self._held: Held | None = None
        # Notes on motions that were made once more, with where these began and what they were given.
        self._seen: dict[int, tuple[Followed, Held | None, tuple[str, ...]]] = {}
        self.reset()

    @checked
    def reset(
        self,
        q: ArrayLike | None = None,
        v: ArrayLike | None = None,
        t: float | None = None,
        *,
        par: ArrayLike | None = None,
        which: ArrayLike | None = None,
        z: ArrayLike | None = None,
    ) -> None:
        """Begin motions at states, their inputs those of the description until a step gives others.

        Args:
            q: Configurations (n, nq), or (nq) for all, on the constraints; the neutral one by default.
            v: Speeds (n, nv), or (nv) for all; rest by default.
            t: Time [s]; that of the options, `t0`, by default.
            par: Other run-time parameters (n, npar), of steppers that were made with one set each; by default those
                that the motions before began with, whatever actions have made of them.
            which: Motions that begin anew, of bool (n); all by default. The rows of the others count for nothing.
            z: States of forces (n, nz), or (nz) for all; the neutral ones by default.

        Raises:
            ShapeError: An array does not fit, or a quaternion is no rotation.
            SymofrosError: Parameters of each motion where all share one set.
        """
        model, chosen = self.model.carried, self._chosen(which)
        q, v = self.model.carry(q, v, z)
        first = self._rows("q", model.neutral() if q is None else q, model.nq)[chosen]
        speeds = self._rows("v", np.zeros(model.nv) if v is None else v, model.nv)[chosen]
        first = at_unit_length(model.record, "q", first, "q")
        values = None
        if par is not None:
            if self.par.ndim == 1:
                rule = "steppers have one set of parameters for all, or one each"
                raise SymofrosError(
                    "reset: parameters", "one set for all", rule, "make them with par of shape (n, npar)"
                )
            values = np.asarray(model.checked_parameters(self._rows("par", par, model.npar)[chosen]))
            self._begun_with[chosen] = values
        elif self._hand.single.actions is not None:
            values = self._begun_with[chosen]
        if values is not None:
            self._par[chosen] = values
        time = np.full(len(chosen), self._settings.t0 if t is None else float(t))
        self._hand.reset(chosen, time, first, speeds, values)
        self._held = None if len(chosen) == self.n else self._held
        for i in np.intersect1d(self._kept, chosen).tolist():
            par = self._begun_with[i] if self.par.ndim > 1 else self._begun_with
            state = self.q[i].copy(), self.v[i].copy(), self.z[i].copy()
            self._followed[i] = Followed(float(self.t[i]), *state, par.copy(), self._held)

    @checked
    def step(self, u: ArrayLike | None = None, steps: int = 1) -> npt.NDArray[np.bool_]:
        """Make steps with inputs held over them.

        Args:
            u: Inputs (n, number of `inputs`), or one row for all; those held before if not given.
            steps: Number of steps.

        Returns:
            Which motions (n) can go on. Of others the state is the last good one; `outcome` says why.

        Raises:
            ShapeError: The inputs do not fit or are not finite; no step is made then.
            SymofrosError: The number of steps is none, or another thread makes steps.
        """
        hand, size = self._hand, len(self.inputs)
        values = None
        if u is not None:
            values = checked_inputs(self.model, self.inputs, u, self.n)
            values = np.ascontiguousarray(np.broadcast_to(values, (self.n, size)))
        if not 1 <= steps <= MOST_STEPS:
            raise no_steps(steps)
        self._begin_alone()
        try:
            if self.model.nc and hand.begins.any():
                self._check_starts(values)
            before = self._held
            rows = None if values is None else values[self._kept]
            self._held = Held(before, rows, steps, 1 if before is None else before.total + 1)
            if self._held.total > _MOST_CALLS:
                self._followed, self._held = {}, None
            hand.step(values, steps)
            if hand.single.actions is not None:
                self._par[...] = hand.present_parameters()
            return self.running
        finally:
            self._stepping.release()

    def _check_starts(self, u: Array | None) -> None:
        """Motions that would begin off the constraints end before."""
        hand = self._hand
        chosen = np.flatnonzero(hand.begins)
        inputs, par = hand.inputs_at_start(chosen, u), self.par[np.newaxis] if self.par.ndim == 1 else self.par[chosen]
        off = starts_off(
            self.model.carried, self._settings, hand.q0[chosen], hand.v0[chosen], inputs, par, hand.t0[chosen]
        )
        hand.results.status[chosen[off]] = Status.PROJECTION_FAILED

    def __repr__(self) -> str:
        name, ended = self.model.record.name, self.n - int(self.running.sum())
        return f"<{self.n} Steppers of '{name}' by {self._settings.method.name}: dt = {self.dt:g} s, {ended} ended>"

    @property
    def par(self) -> Array:
        """Run-time parameters (npar) of all, or (n, npar)."""
        return read_only(self._par)

    @property
    def running(self) -> npt.NDArray[np.bool_]:
        """Which motions (n) can go on."""
        return np.asarray(self._status == Status.RUNNING)

    @property
    def u(self) -> Array:
        """Inputs that are held (n, nu)."""
        return self._hand.constant.copy()

    @property
    def energy(self) -> Array:
        """Kinetic and potential energy together (n) [J]."""
        kinetic = self.model.kinetic_energy(self.q, self.v, u=self.u, par=self.par)
        return np.asarray(kinetic + self.model.potential_energy(self.q, u=self.u, par=self.par, t=self.t, z=self.z))

    @checked
    def outcome(self, i: int) -> Outcome:
        """Why motion i ended, or what is worth knowing of it.

        Of a few motions, the first and the last among them, inputs are kept: each is made once more by a `Stepper`,
        which examines it, once for each state. The outcome of another one says what was found of these.
        """
        if not 0 <= i < self.n:
            raise SymofrosError(
                "outcome: no such motion", str(i), f"0 <= i < {self.n}", "steppers.running tells which can go on"
            )
        results = self._hand.results
        status = np.where(results.status == Status.RUNNING, Status.FINISHED, results.status)
        arrays: dict[str, Any] = {**results.shaped((self.n,)), "status": status}
        method = self._settings.method.name
        ends = Trajectories(
            **arrays,
            model=self.model.carried,
            t=np.zeros(0),
            par=self.par,
            method=method,
            seconds=0.0,
            processor_seconds=0.0,
        )
        met, ended = self._hand.met.get(i, ()), ends.outcome(i)
        if met and results.status[i] < 0:
            ended = failure_of(self._hand.single, met[-1]) or ended
        examined = self._examined(i)
        return replace(ended, notes=(*ended.notes, self._unseen_note()) if examined is None else examined)

    def _examined(self, i: int) -> tuple[str, ...] | None:
        """Notes of a Stepper that makes motion i once more; None where its inputs are not kept, or it has no steps."""
        one, held = self._followed.get(i), self._held
        if one is None or held is one.before or self._status[i] == Status.PROJECTION_FAILED:
            return None
        if (seen := self._seen.get(i)) is not None and seen[0] is one and seen[1] is held:
            return seen[2]
        given = {name: value for name, value in self._given.items() if name != "threads"}
        stepper = Stepper(self.model, par=one.par, **given)
        stepper.reset(one.q, one.v, one.t, z=one.z if self.model.nz else None)
        links, row = list[Held](), int(np.searchsorted(self._kept, i))
        while held is not None and held is not one.before:
            links.append(held)
            held = held.before
        for link in reversed(links):
            if not stepper.step(None if link.u is None else link.u[row], link.steps):
                break
        self._seen[i] = one, self._held, stepper.outcome.notes
        return self._seen[i][2]

    def _unseen_note(self) -> str:
        """What is known of the steps of a motion whose inputs are not kept."""
        found = {i: notes for i in self._followed if (notes := self._examined(i)) is not None}
        says = [f"{note} (motion {i})" for i, notes in found.items() for note in notes]
        others = ", ".join(map(str, found))
        known = f"; of motions {others}, which are, {' and '.join(says) or 'none bears a note'}" if found else ""
        return f"the steps of motions that are stepped together are not examined{known}: an sf.Stepper says more of one"

    @checked
    def events(self, i: int) -> tuple[Found, ...]:
        """Events that motion i has met since it began, in the order of time, with what their actions did."""
        return tuple(found_of(self._hand.single, met).of(self.model) for met in self._hand.met.get(i, ()))

    def save(self) -> BatchState:
        """The present states, with all that later steps depend on."""
        return replace(
            self._hand.save(self._kind, self._par, self._begun_with), followed=dict(self._followed), held=self._held
        )

    def copy(self) -> Steppers:
        """Others in the same states, which share nothing that steps change."""
        others = Steppers(self.model, self.n, par=self._par, **self._given)
        others._kind = self._kind
        others.restore(self.save())
        return others

    def restore(self, state: BatchState) -> None:
        """Go on from saved states, bit by bit as from there.

        Args:
            state: What `save` gave, of these steppers or of a copy.

        Raises:
            SymofrosError: It is none, or of others.
        """
        rule = "a state goes back to the steppers that it was saved of, or to a copy, in the same process"
        remedy = "make others by copy(); elsewhere reset some at the state's t, q, v"
        refused = ("restore: no state of these steppers", rule, remedy)
        check_owner(state, BatchState, self._kind, refused)
        self._hand.restore(state, None if np.array_equal(state.par, self._par) else state.par)
        self._par[...], self._begun_with[...] = state.par, state.given
        self._followed, self._held = dict(state.followed), state.held

    def _rows(self, name: str, values: ArrayLike, size: int) -> Array:
        array = real_array(self.model.by_name(name, values))
        if array is None or array.shape not in ((size,), (self.n, size)) or not np.isfinite(array).all():
            raise self._misfit(name, values if array is None else array, size, "one row a motion, or one for all")
        return np.broadcast_to(array, (self.n, size))

    def _chosen(self, which: ArrayLike | None) -> npt.NDArray[np.intp]:
        if which is None:
            return np.arange(self.n)
        mask = np.asarray(which)
        if mask.dtype != bool or mask.shape != (self.n,):
            found = f"{mask.dtype} of shape {mask.shape}"
            raise SymofrosError("reset: which does not fit", found, f"one bool for each of {self.n}", _MASK)
        return np.flatnonzero(mask)

    def _misfit(self, name: str, found: Any, size: int, remedy: str) -> ShapeError:
        what = f"model '{self.model.record.name}': {name} does not fit"
        fault = f"{type(found).__name__} {found!r:.60}"
        if isinstance(found, np.ndarray):
            fits = found.shape in ((size,), (self.n, size))
            fault = "a number that is not finite" if fits else str(found.shape)
        rule = f"{name} is finite, of shape ({size},) or ({self.n}, {size})"
        return ShapeError(what, fault, rule, remedy)


# How a mask is made.
_MASK = "leave it out for all; np.isin(np.arange(n), numbers) is a mask of numbers"
# Motions of which the inputs are kept, at most; of so many calls, after which they are forgotten until the next reset.
_KEPT, _MOST_CALLS = 4, 1 << 16
# More than any memory holds.
_MOST = 1 << 31
