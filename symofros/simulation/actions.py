"""Actions of events: parameters and speeds that change, constraints that engage (docs/theory/constraints.md, 13)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.names import coordinate_of, speed_column, speed_of
from symofros.base.rotations import matrix_quaternion
from symofros.errors import Problem, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.model import Model
from symofros.runtime.record import SwitchRecord
from symofros.simulation.events import Event
from symofros.simulation.results.ends import ENDS
from symofros.simulation.results.engaging import engaged_apart, engaging_notes
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.trajectory import Found
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# An event that acts twice within this share of a run acts without end: smaller spans are not resolved within steps.
_AT_ONCE = 1e-9
# Combinations of rows of G of a smaller share of the largest one are rounding: their impulse is none.
_RANK = 1e-12


@dataclass(frozen=True)
class Acted:
    """What an instant's actions have done; the stepper is at the state after them, or, where they failed, before.

    Attributes:
        found: Events, with what was done at each.
        notes: Remarks.
        failure: Why the run ends here; None if it goes on.
    """

    found: tuple[Found, ...]
    notes: tuple[str, ...] = ()
    failure: Outcome | None = None


class Actions:
    """The actions of the events of one run.

    Args:
        model: Model.
        events: All events of the run.
        span: Time from start to end [s].

    Raises:
        UnknownNameError: An action names no run-time parameter or speed, or a formula no name of the model.
    """

    def __init__(self, model: Model, events: Sequence[Event], span: float) -> None:
        self.model, self.events, self.span = model, events, span
        formulas: list[Any] = [switch.engaged for switch in model.record.switches]
        self._assignments: dict[int, list[tuple[str, int, int]]] = {}
        for which, event in enumerate(events):
            for name, formula in (event.action or {}).items():
                place = *_target(model, event, name), len(formulas)
                self._assignments.setdefault(which, []).append(place)
                formulas.append(formula)
        self._kernel = model.formulas(formulas, derivatives=False)
        self._last: dict[int, float] = {}

    def act(self, stepper: Stepper, which: Sequence[int]) -> Acted:
        """Do the actions of the events met at the present state, one after the other, as the events are stated.

        Args:
            stepper: Its run has been cut there.
            which: Indices of the events met.
        """
        found, notes, failure = list[Found](), tuple[str, ...](), None
        for i in sorted(which):
            t, q, v = stepper.state
            met = Found(self.events[i].name, t, q, v)
            if i in self._assignments and failure is None:
                acted = self._act(stepper, i, met)
                met, notes, failure = acted.found[0], (*notes, *acted.notes), acted.failure
            found.append(met)
        return Acted(tuple(found), notes, failure)

    def _act(self, stepper: Stepper, which: int, met: Found) -> Acted:
        """Do the action of one event."""
        event, par, (_, t, q, v, *_) = self.events[which], stepper.par, met
        if t - self._last.get(which, -np.inf) <= _AT_ONCE * self.span:
            return Acted((met,), failure=_without_end(t, event.name))
        self._last[which] = t
        state = t, q, v, stepper.inputs_at(t, q, v)
        try:
            after, speeds = self._assigned(which, state, par)
            after, engaging = self._held(after, par, state)
            self.model.checked_parameters(after)
            _refuse_no_strike(event, engaging)
            self._refuse_other_beams(stepper, after)
        except SymofrosError as error:
            reason = f"what event '{event.name}' sets is refused: {error.problem.what}; {error.problem.rule}"
            return Acted((met,), failure=Outcome("input failed", t, reason, error.problem.remedy))
        if event.once:
            stepper.ignore_event(which)
        stepper.set_parameters(after)
        stepper.set_state(q, speeds)
        status, gap = stepper.engage() if self.model.nc else (int(Status.RUNNING), 0.0)
        if status != Status.RUNNING:
            apart = status == Status.ENGAGED_APART
            failure = engaged_apart(t, gap, ", ".join(engaging) or event.name) if apart else ENDS[status].outcome(t)
            stepper.set_parameters(par)
            stepper.set_state(q, v)
            return Acted((met,), failure=failure)
        _, q_after, v_after = stepper.state
        if event.restitution is not None:  # (32)
            v_after = v_after + event.restitution * (v_after - speeds)
            stepper.set_parameters(par)
            stepper.set_state(q_after, v_after)
        done = self._done((q, q_after), (v, speeds, v_after), (par, after), state[3], t)
        return Acted((met._replace(v_after=v_after, **done),), engaging_notes(t, gap))

    def _values(self, state: tuple[float, Array, Array, Array], par: Array) -> Array:
        """Values of all formulas at a state (t, q, v, u): what says whether constraints hold, then assignments."""
        given = dict(zip("tqvu", (np.array([state[0]]), *state[1:]), strict=True))
        inputs = [given[group][np.newaxis] for group, _ in self._kernel.signature.inputs]
        values = self._kernel.run(1, self._kernel.prepare(par[np.newaxis]), inputs)[0]
        return np.asarray(values, dtype=np.float64).reshape(-1)

    def _assigned(self, which: int, state: tuple[float, Array, Array, Array], par: Array) -> tuple[Array, Array]:
        """Parameters and speeds as the action of an event sets them, all by the state before."""
        values, speeds, par = self._values(state, par), state[2].copy(), par.copy()
        for group, index, place in self._assignments[which]:
            (par if group == "par" else speeds)[index] = values[place]
        if not np.isfinite(speeds).all():
            i = int(np.argmin(np.isfinite(speeds)))
            what, found = f"action sets speed '{self.model.names.v[i]}'", f"{speeds[i]} at t = {state[0]:.6g} s"
            fault = Problem(what, found, "speeds are finite", "mend its formula")
            raise SymofrosError(fault)
        return par, speeds

    def _held(
        self, par: Array, before: Array, state: tuple[float, Array, Array, Array]
    ) -> tuple[Array, tuple[str, ...]]:
        """Parameters with the poses that engage now held, and the names of the constraints that engage."""
        switches, rises = self.model.record.switches, []
        if switches:
            engaged = self._values(state, par)[: len(switches)] - self._values(state, before)[: len(switches)]
            rises = [switch for switch, change in zip(switches, engaged, strict=True) if change > 0.0]
        for switch in rises:
            par = _holding(self.model, switch, par, state) if switch.moment else par
        return par, tuple(switch.name for switch in rises)

    def _refuse_other_beams(self, stepper: Stepper, par: Array) -> None:
        """Refuse parameters that change beams, whose bending is judged over the whole run."""
        for before, after in zip(stepper.beams, self.model.beams(par), strict=True):
            if (before.EI_z, before.EI_y, *before.scale) != (after.EI_z, after.EI_y, *after.scale):
                found = f"EI_z, EI_y = {before.EI_z:g}, {before.EI_y:g} before"
                rule = "the length and stiffness of an elastic beam stay the same in a run"
                raise SymofrosError(Problem("an action changes an elastic beam", found, rule, "make two runs"))

    def _done(
        self,
        q: tuple[Array, Array],
        v: tuple[Array, Array, Array],
        par: tuple[Array, Array],
        u: Array,
        t: float,
    ) -> dict[str, Any]:
        """Impulse and energies of speeds v as they were, as they were set, and as the impact left them."""
        model, (before, set_to, after) = self.model, v
        given: dict[str, Any] = {"u": u, "par": par[1]}
        try:
            lost = float(model.kinetic_energy(q[0], set_to, **given) - model.kinetic_energy(q[1], after, **given))
            energies = [
                float(model.kinetic_energy(q[0], speeds, u=u, par=at) + model.potential_energy(q[0], u=u, par=at, t=t))
                for speeds, at in ((before, par[0]), (set_to, par[1]))
            ]
            M, G = model.mass_matrix(q[1], **given), np.zeros((0, model.nv))
            if model.nc:
                G = model.constraint_jacobian(q[1], t=t, **given)
            impulse = np.linalg.lstsq(G.T, M @ (after - set_to), rcond=_RANK)[0]
        except SymofrosError:  # Options.functions left them out.
            return {}
        return {"impulse": impulse, "energy_lost": lost, "energy_added": energies[1] - energies[0]}


def _target(model: Model, event: Event, name: str) -> tuple[str, int]:
    """Group, "par" or "v", and index of what an action sets."""
    names = model.names
    if found := coordinate_of(name, names.par):
        return "par", names.par.index(found)
    if name in names.q:  # Of a joint with one coordinate that of its speed, too; in formulas it is the coordinate.
        what, rule = f"event '{event.name}': its action sets the coordinate '{name}'", "an action moves nothing at once"
        speed = f"its speed, '{speed_column(name, names.q)}'" if name in names.v else "speeds"
        remedy = f"set {speed}, or a parameter"
        raise UnknownNameError(Problem(what, f"'{name}' among coordinates", rule, remedy))
    if found := speed_of(name, names.v):
        return "v", names.v.index(found)
    known = [*names.par, *names.v]
    rule = "an action sets run-time parameters, and speeds: d and the coordinate's name, or the speed's own"
    what = f"event '{event.name}': its action sets '{name}', which is no parameter or speed"
    raise UnknownNameError(Problem(what, ", ".join(known[:12]) or "none", rule, did_you_mean(name, known)))


def _refuse_no_strike(event: Event, engaging: tuple[str, ...]) -> None:
    """Refuse restitution where nothing strikes: parameters would be as before, and the action nothing."""
    if event.restitution is not None and not engaging:
        rule = "restitution is that of constraints which the action engages"
        raise SymofrosError(Problem("no constraint engages", "restitution", rule, "a Switch by what the action sets"))


def _holding(model: Model, switch: SwitchRecord, par: Array, state: tuple[float, Array, Array, Array]) -> Array:
    """Parameters with which a constraint is fulfilled at a state, (29) and (30)."""
    (t, q, _, u), par = state, par.copy()
    par[[place for _, place in switch.offsets]] = 0.0
    if switch.rotation:
        R_A, R_B = (np.asarray(model.frame_pose(frame, q, u=u, par=par)[1]) for frame in switch.frames)
        par[list(switch.rotation)] = matrix_quaternion(R_B.T @ R_A)
    phi = model.constraint(q, u=u, par=par, t=t)
    for row, place in switch.offsets:
        par[place] = phi[row]
    return par


def _without_end(t: float, name: str) -> Outcome:
    return Outcome(
        "interrupted",
        t,
        f"event '{name}' acts again at the same instant: actions follow each other without end",
        "once=True, or a formula that is not zero after the action, such as 'gap + grip'; bodies that come to rest on"
        " each other need a constraint that engages there",
    )


def plan_actions(model: Model, events: Sequence[Event], span: float) -> Actions | None:
    """The actions of a run's events; None where they have none."""
    return Actions(model, events, span) if any(event.action for event in events) else None


def refuse_actions(events: Sequence[Event], what: str, remedy: str) -> None:
    """Refuse events with actions where these can't be done.

    Raises:
        SymofrosError: One has an action.
    """
    named = [event.name for event in events if event.action]
    if named:
        rule = "an action begins the motion anew in the middle of a run, which `simulate` by a one-step method does"
        raise SymofrosError(Problem(f"{what}: event '{named[0]}' has an action", "action", rule, remedy))
