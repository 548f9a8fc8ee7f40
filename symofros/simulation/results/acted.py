"""What the actions of events have done, in numbers and words (docs/theory/constraints.md, 13)."""

from __future__ import annotations

from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.events import Event
from symofros.errors import Problem, SymofrosError
from symofros.native import native_number
from symofros.runtime.model import Model
from symofros.runtime.record import STICKS
from symofros.simulation.events import ModeEvent
from symofros.simulation.results.ends import ENDS, INTERRUPTED
from symofros.simulation.results.engaging import engaged_apart, engaging_notes
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.trajectory import Found
from symofros.simulation.stepping.bound_run import BoundRun
from symofros.simulation.stepping.met import Done, Met
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Combinations of rows of G of a smaller share of the largest one are rounding: their impulse is none.
_RANK = 1e-12
# Distance of a ball from a plane that it touches [m].
_TOUCHES = native_number("stepping/events/events.c", "SYM_TOUCHING")


def found_of(run: BoundRun, met: Met) -> Found:
    """An event that a run has met, with what its action did."""
    return found_event(run.events[met.which], run.model, met)


def found_event(event: Event, model: Model, met: Met) -> Found:
    """An event that was met, with what its action did: energies and impulse where the model has functions for them."""
    done = met.done
    found = Found(event.name, met.t, met.q, met.v)
    if done is None or done.status <= 0:
        return found
    if isinstance(event, ModeEvent):
        found = found._replace(
            name=event.said(done.par, done.par_set, impulse=bool(np.any(done.v_after != done.v_set)))
        )
    return found._replace(v_after=done.v_after, **_effects(model, met, done))


def notes_of(run: Stepper, met: Met) -> tuple[str, ...]:
    """Remarks on what an action did: a gap closed beyond rounding, strikes in sequence, a contact that came to rest."""
    if met.done is None or met.done.status <= 0:
        return ()
    event, notes = run.events[met.which], engaging_notes(met.t, met.done.gap)
    if met.done.in_sequence:
        notes = (
            *notes,
            f"several balls struck one after the other at t = {met.t:.6g} s, as no motion was found in which they do at"
            " once: another order may lead elsewhere; compare with a compliant contact",
        )
    if not met.done.rests:
        return notes
    further = ""
    if event.restitution:
        further = f", where strikes would follow within {run.accumulation(met.t, event.restitution):.3g} s"
    return (*notes, f"event '{event.name}': the contact persists from t = {met.t:.12g} s on{further}")


def failure_of(run: BoundRun, met: Met) -> Outcome | None:
    """Why a run ends at an event, where its action has failed.

    Raises:
        BaseException: What the check of the parameters that the action sets raised, which is no refusal.
    """
    event, done, t = run.events[met.which], met.done, met.t
    if done is None or done.status >= 0:
        return None
    if done.status == Status.ENGAGED_APART and run.actions is not None:
        engaging = run.actions.engaging(done.par, done.par_set, (t, met.q, met.v, done.u))
        return engaged_apart(t, done.gap, ", ".join(engaging) or event.name)
    if done.status == Status.ACTS_WITHOUT_END:
        reason = f"event '{event.name}' acts again at the same instant: actions follow each other without end"
        if event.restitution == 0.0:
            reason = f"event '{event.name}' brings bodies to rest on each other, and nothing parts them again"
        return ENDS[done.status].outcome(t, reason=reason)
    if done.status != Status.ACTION_REFUSED:
        return ENDS[done.status].outcome(t)
    if isinstance(run.failure, KeyboardInterrupt):
        return INTERRUPTED.outcome(t)
    if run.failure is not None:
        raise run.failure
    problem = _refused(run, event, met, done)
    reason = f"what event '{event.name}' sets is refused: {problem.what}; {problem.rule}"
    return Outcome(ENDS[done.status].kind, t, reason, problem.remedy)


def _refused(run: BoundRun, event: Event, met: Met, done: Done) -> Problem:
    """What is wrong with what an action sets."""
    finite = np.isfinite(done.v_set)
    if not finite.all():
        i = int(np.argmin(finite))
        what, found = f"action sets speed '{run.model.names.v[i]}'", f"{done.v_set[i]} at t = {met.t:.6g} s"
        return Problem(what, found, "speeds are finite", "mend its formula")
    try:
        run.check_changed(done.par_set)
    except SymofrosError as error:
        return error.problem
    if event.rests is not None and done.v_set.size and run.model.nc and _engages(run, met, done):
        what, rule = "its `rests` does not press as the bodies do", "the force is above zero where bodies press"
        return Problem(what, f"{event.rests}", rule, "the other sign, or the multiplier of what the action engages")
    if event.restitution is not None:
        rule = "restitution is that of constraints which the action engages"
        return Problem("no constraint engages", "restitution", rule, "a Switch by what the action sets")
    i = int(np.argmax(np.abs(done.v_set)))
    what, found = f"action sets speed '{run.model.names.v[i]}'", f"{done.v_set[i]:.3g}"
    return Problem(what, found, "no motion is as fast", "mend its formula")


def _engages(run: BoundRun, met: Met, done: Done) -> bool:
    """Whether what an action sets engages a constraint."""
    return run.actions is not None and bool(run.actions.engaging(done.par, done.par_set, (met.t, met.q, met.v, done.u)))


def _touching(model: Model, met: Met, done: Done) -> Array:
    """The parameters that an action has set, with rows of the rigid contacts that took part in its impact."""
    par, balls = done.par_set.copy(), model.record.rigid_contacts
    gaps = model.contact_forces(met.q, met.v, u=done.u, par=done.par).gap if balls else ()
    for ball in balls:
        near = abs(gaps[model.names.contacts.index(ball.name)]) < _TOUCHES
        if near or done.par[ball.mode] or done.par_set[ball.mode]:
            par[ball.mode] = STICKS
    return par


def _effects(model: Model, met: Met, done: Done) -> dict[str, Any]:
    """Impulse and energies of speeds as they were, as they were set, and as the impact left them."""
    u, before, set_to, after = done.u, met.v, done.v_set, done.v_after
    given: dict[str, Any] = {"u": u, "par": done.par_set}

    def energy(speeds: Array, par: Array) -> float:
        potential = model.potential_energy(met.q, u=u, par=par, t=met.t, z=model.states_of(speeds))
        return float(model.kinetic_energy(met.q, speeds, u=u, par=par) + potential)

    try:
        lost = float(model.kinetic_energy(met.q, set_to, **given) - model.kinetic_energy(done.q_after, after, **given))
        added = energy(set_to, done.par_set) - energy(before, done.par)
        M, G = model.mass_matrix(done.q_after, **given), np.zeros((0, model.nv))
        if model.nc:
            G = model.constraint_jacobian(done.q_after, t=met.t, u=u, par=_touching(model, met, done))
        impulse = np.linalg.lstsq(G.T, M @ (after - set_to), rcond=_RANK)[0]
    except SymofrosError:  # Options.functions left them out.
        return {}
    return {"impulse": impulse, "energy_lost": lost, "energy_added": added}
