"""sf.Stepper: a model whose caller makes the steps, in a loop of its own."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array, real_array
from symofros.errors import ShapeError, SymofrosError, UnknownNameError
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.events import events_of
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.prescribed_motions import recorded_notes
from symofros.simulation.results.acted import found_of
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.trajectory import Found, Trajectory
from symofros.simulation.settings import Settings, check_fit, check_start, first_configuration, vector
from symofros.simulation.simulate import prepare_run, run_to_its_end
from symofros.simulation.stepped import (
    MOST_STEPS,
    SteppedModel,
    check_owner,
    no_steps,
    options_by_hand,
    owner_of,
)
from symofros.simulation.stepping.by_hand import MOST_NOTED, HandRun, HandState
from symofros.simulation.stepping.fast_step import fast_step
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.status import Status


class Stepper(SteppedModel):
    """A model that is stepped by hand: for controllers, learning, sampling, hardware in the loop.

    Steps are those of `simulate`, by the same C: with the same inputs held over the same fixed steps, q and v are the
    same to the last bit. Adaptive methods choose their own steps from one multiple of `dt` to the next.

    ::

        stepper = sf.Stepper(model, dt=1e-3)
        stepper.reset(q0)
        while stepper.t < 2.0 and stepper.step(-50.0 * stepper.q - 5.0 * stepper.v):
            pass
        print(stepper.outcome)

    Args:
        model: Compiled with backend "c".
        u: Inputs that are not given by hand, as `simulate` takes them by name: numbers, formulas, Signals.
        par: Run-time parameters (npar), or values by name; the model's own by default.
        events: Name -> formula or Event, with actions as of `simulate`. A terminal one ends the motion within a step;
            `reset` begins anew behind it, with all events and modes as at first.
        options: Options of stepping and stabilisation; those of `SimulationOptions()` by default.
        changes: Fields of SimulationOptions by name, which replace those of `options`: method="rk4", dt=1e-3, ...
            `dt` is the time of one step, of adaptive methods too, 1e-3 s by default. What concerns recording, the end
            of a run or its pace has no meaning here.

    Attributes:
        model: Model that is stepped.
        dt: Time of one step [s].
        inputs: Names of the inputs that `step` takes, in order.
        q: Present configuration (nq), a view that steps change and that can't be written: copy it to keep it.
        v: Present speeds (nv), as q.
        z: Present states of forces (nz), as q.

    Raises:
        ShapeError: An array does not fit.
        UnknownNameError: The name of an option, an input or in a formula is unknown.
        SymofrosError: The options contradict each other or have no meaning here, or the method has no steps that can be
            made by hand.
    """

    @checked
    def __init__(
        self,
        model: Model,
        *,
        u: Mapping[str, Any] | None = None,
        par: ArrayLike | None = None,
        events: Mapping[str, Any] | None = None,
        options: SimulationOptions | None = None,
        **changes: Any,
    ) -> None:
        chosen = options_by_hand(options, changes, ("u", "par", "events"))
        self._given: dict[str, Any] = {"u": u, "events": events, "options": chosen}
        self._stepping = Lock()
        self.model = stated = model.with_precision("double")
        model = stated.carried
        settings = settings_by_hand(model, chosen)
        values = np.array(model.parameter_values) if par is None else _parameters(model, par)
        inputs = plan_inputs(stated, u)
        check_fit(model, settings, inputs)
        prepare_run(model, settings)
        self._kind = owner_of("stepper", model.record.name)
        self._hand = HandRun(model, settings, inputs, fixed_inputs(u), events_of(model, events), values)
        self._known_events: list[tuple[Met, Found]] = []
        self._first = settings.t0
        self.dt, self.z = settings.dt, model.states_of(self._hand.v)
        self.q, self.v = self._hand.q[: stated.nq], self._hand.v[: stated.nv]
        self.inputs = tuple(model.names.u[i] for i in self._hand.held)
        self.reset()
        if type(self).step is not Stepper.step:  # A class of the caller's has its own.
            return
        fast = fast_step(self._hand, self._made, partial(Stepper.step, self))
        if fast is not None:  # Found before the class's own, it costs a fifth of it.
            vars(self)["step"] = fast

    @checked
    def reset(
        self,
        q: ArrayLike | None = None,
        v: ArrayLike | None = None,
        t: float | None = None,
        *,
        par: ArrayLike | None = None,
        z: ArrayLike | None = None,
    ) -> None:
        """Begin a motion at a state. Its inputs are those of the description until a step gives others.

        Args:
            q: Configuration (nq), or values by name, on the constraints (see `assemble`); the neutral one by default.
            v: Speeds (nv), or values by name; rest by default.
            t: Time [s]; that of the options, `t0`, by default.
            par: Other run-time parameters (npar), or values by name; by default those that the motion before began
                with, whatever actions have made of them.
            z: States of forces (nz), or values by name; the neutral ones by default.

        Raises:
            ShapeError: An array does not fit, or a quaternion is no rotation.
        """
        model = self.model.carried
        q, v = self.model.carry(q, v, z)
        configuration = first_configuration(model, q)
        speeds = np.zeros(model.nv) if v is None else vector(model, "v", v, model.nv)
        time = self._first if t is None else float(t)
        self._hand.reset(time, configuration, speeds, None if par is None else _parameters(model, par))

    def step(self, u: ArrayLike | None = None, steps: int = 1) -> bool:
        """Make steps with inputs held over them.

        Args:
            u: Inputs (number of `inputs`), or values by name; those held before if not given.
            steps: Number of steps.

        Returns:
            Whether the motion can go on. Where it can't, the state is the last good one, and `outcome` says why.

        Raises:
            ShapeError: The inputs do not fit or are not finite; no step is made then.
            AssemblyError: The state of the reset does not meet the constraints.
            SymofrosError: The motion has ended before, the number of steps is none, or another thread makes steps.
        """
        values = None if u is None else checked_inputs(self.model, self.inputs, u)
        if isinstance(steps, bool) or not isinstance(steps, (int, np.integer)) or not 1 <= steps <= MOST_STEPS:
            raise no_steps(steps)
        self._begin_alone()
        try:
            return self._step(values, int(steps))
        finally:
            self._stepping.release()

    def _step(self, values: Array | None, steps: int) -> bool:
        hand = self._hand
        if not hand.started:
            inputs = hand.begin(values)
            start, settings = hand.start, replace(hand.settings, t0=hand.start.t)
            try:
                check_start(self.model.carried, settings, start.q, start.v, inputs, self.par)
            except SymofrosError:
                hand.reset(start.t, start.q, start.v)
                raise
        elif hand.status != Status.RUNNING:
            rule = "steps are made while step() returns True"
            raise SymofrosError("step: the motion has ended", str(self.outcome), rule, "reset() or restore() first")
        return hand.step(values, steps) == Status.RUNNING

    def _made(self, status: int | None) -> bool:
        """After a fast call that did not just make its steps; None: another thread was within one."""
        if status is None:
            raise self._occupied()
        return self._hand.settled(status) == Status.RUNNING

    def __repr__(self) -> str:
        method, state = self._hand.settings.method.name, "" if self.running else ", ended"
        return f"<Stepper of '{self.model.record.name}' by {method}: dt = {self.dt:g} s, t = {self.t:g} s{state}>"

    @property
    def par(self) -> Array:
        """Run-time parameters (npar), a view that can't be written."""
        self._hand.run.take_parameters()
        return read_only(self._hand.run.par)

    @property
    def running(self) -> bool:
        """Whether the motion can go on."""
        return self._hand.status == Status.RUNNING

    @property
    def t(self) -> float:
        """Present time [s]."""
        return self._hand.t

    @property
    def u(self) -> Array:
        """Present inputs (nu), as held; laws at the present state."""
        return self._hand.inputs_now()

    @property
    def kinetic_energy(self) -> float:
        """[J]."""
        return float(self.model.kinetic_energy(self.q, self.v, u=self.u, par=self.par))

    @property
    def potential_energy(self) -> float:
        """[J]."""
        return float(self.model.potential_energy(self.q, u=self.u, par=self.par, t=self.t, z=self.z))

    @property
    def energy(self) -> float:
        """Kinetic and potential energy together [J]."""
        return self.kinetic_energy + self.potential_energy

    @property
    def events(self) -> tuple[Found, ...]:
        """Events met since the reset, in the order of time, with what their actions did."""
        met, known_events, run = self._hand.events, self._known_events, self._hand.run
        known = 0  # Those that were asked for before are not worked out again.
        while known < min(len(met), len(known_events)) and known_events[known][0] is met[known]:
            known += 1
        known_events[known:] = [(one, found_of(run, one).of(self.model)) for one in met[known:]]
        return tuple(found for _, found in known_events)

    def trajectory(self) -> Trajectory:
        """The motion since the reset as `simulate` gives it: it is made once more, with the inputs of its steps.

        States are recorded at each step. Of a motion with more than 2^18 changes of inputs the first part is left out.
        """
        stepper, settings = self._hand.once_more()
        start = self._hand.start
        made = run_to_its_end(stepper, settings, start.q, start.v)
        notes = [*made.outcome.notes, *recorded_notes(self.model.record, made.t, made.u)]
        if start.forgotten:
            notes.append(
                f"what was before t = {start.t:.6g} s was not looked at: inputs are kept of {MOST_NOTED} changes"
            )
        return replace(made, outcome=replace(made.outcome, notes=tuple(notes))).of(self.model)

    @property
    def outcome(self) -> Outcome:
        """Why the motion ended, or what is worth knowing of it: what `simulate` says of the same motion.

        The motion is made once more for it, and examined, at each call: for the end of a loop, not within it.
        """
        return self.trajectory().outcome

    def save(self) -> HandState:
        """The present state, with all that later steps depend on, and what was noted of the motion so far."""
        return self._hand.save(self._kind)

    def restore(self, state: HandState) -> None:
        """Go on from a saved state, bit by bit as from there.

        Args:
            state: What `save` gave, of this stepper or of a copy.

        Raises:
            SymofrosError: It is none, or of a stepper that was made otherwise.
        """
        rule = "a state goes back to the stepper that it was saved of, or to a copy, in the same process"
        remedy = "make other steppers by copy(); elsewhere reset one at the state's t, q, v"
        check_owner(state, HandState, self._kind, ("restore: no state of this stepper", rule, remedy))
        self._hand.restore(state)

    def copy(self) -> Stepper:
        """Another stepper in the same state, which shares nothing that steps change."""
        other = Stepper(self.model, par=self.par, **self._given)
        other._kind = self._kind
        other.restore(self.save())
        return other


def _parameters(model: Model, par: ArrayLike) -> Array:
    """A copy of run-time parameters (npar) that are given, checked."""
    return np.array(vector(model, "par", model.checked_parameters(par), model.npar))


def fixed_inputs(u: Mapping[str, Any] | None) -> set[str]:
    """Names of the inputs that are numbers for good."""
    return {name for name, value in (u or {}).items() if isinstance(value, (int, float, np.floating))}


def checked_inputs(model: Model, names: Sequence[str], u: ArrayLike, n: int = 0) -> Array:
    """Inputs that are given by hand, checked.

    Args:
        model: Model that is stepped.
        names: Their names.
        u: Inputs (number of names), or values by name.
        n: Number of motions that may have a row each; 0: one motion.

    Raises:
        ShapeError: They do not fit, or are not finite.
        UnknownNameError: A name is not among them.
    """
    if isinstance(u, Mapping) and len(names) < model.nu:
        for name in u.keys() - set(names):
            what, rule = f"step: no input '{name}' by hand", f"inputs by hand are {', '.join(names) or 'none'}"
            raise UnknownNameError(what, str(name), rule, "laws and numbers of the stepper stay as they are")
        u = np.array([u.get(name, 0.0) for name in names])
    array, shape = real_array(model.by_name("u", u)), (len(names),)
    fits = array is not None and array.shape in ((shape, (n, *shape)) if n else (shape,))
    if array is not None and fits and np.isfinite(array).all():
        return np.ascontiguousarray(array)
    found, remedy = f"{type(u).__name__} {u!r:.60}", "one number for each of `inputs`"
    if isinstance(u, (int, np.integer)):
        remedy = f"u comes first: step(steps={u}) makes {u} steps; {remedy}"
    if array is not None:
        found = str(array.shape)
        if fits:
            *row, i = np.argwhere(~np.isfinite(array))[0]
            found = f"a number that is not finite: {array[*row, i]} for '{names[i]}'"
            found += f" of motion {row[0]}" if row else ""
    listed = ", ".join(names[:8]) or ("all inputs are laws and numbers" if model.nu else "there are no inputs")
    listed += ", …" if len(names) > 8 else ""
    rule = f"u is finite, of shape {shape}{f' or {(n, *shape)}' if n else ''}: {listed}"
    raise ShapeError(f"model '{model.record.name}': u does not fit", found, rule, remedy)


def settings_by_hand(model: Model, options: SimulationOptions) -> Settings:
    """Settings of a run without an end; options that speak of one, or of records, are refused."""
    rule = "a loop of the caller's decides when it ends, what it records and how fast it goes"
    options.refuse(("output", "every", "max_steps", "realtime"), "stepper: an option of whole runs", rule)
    settings = Settings.of(model, options, options.t0)
    if settings.method.family.multistep:
        raise SymofrosError(
            f"stepper: '{options.method}' has no steps to be made by hand",
            "a method of SUNDIALS, with a history of steps",
            "inputs that change at each step would cut its history",
            "method='rodas4' for stiff models, or a method of fixed steps",
        )
    return replace(settings, dt=options.dt or 1e-3, every=0, t_end=math.inf)


def read_only(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """A view that can't be written."""
    view = array.view()
    view.flags.writeable = False
    return view
