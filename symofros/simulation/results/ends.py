"""How runs end: one row a status, for single runs, batches and diagrams; docs/howto/simulating.md shows the table."""

from __future__ import annotations

from typing import NamedTuple

from symofros.runtime.beams import BeamBending
from symofros.simulation.results.outcome import Kind, Outcome
from symofros.simulation.stepping.status import Status


class End(NamedTuple):
    """What a status means.

    Attributes:
        kind: Kind of the Outcome.
        reason: One sentence; those who know more of a run say more.
        advice: Remedy to try.
    """

    kind: Kind
    reason: str
    advice: str = ""

    def outcome(self, t: float, notes: tuple[str, ...] = (), reason: str = "") -> Outcome:
        """The outcome of a run that ends so at a time [s]; with a reason that says more, where one is known."""
        return Outcome(self.kind, t, reason or self.reason, self.advice, notes)


INTERRUPTED = End("interrupted", "Ctrl-C; the part up to here is kept")
UNEXAMINED = End(
    "interrupted",
    "Ctrl-C while it was examined; all of the run is kept, and its steps are not judged",
    "run it again, and wait for its end",
)
ENDS: dict[int, End] = {
    Status.FINISHED: End("finished", "the end asked for"),
    Status.TERMINAL_EVENT: End("event", "a terminal event"),
    Status.RUNNING: End("interrupted", "max_steps are done, or Ctrl-C"),
    Status.DIVERGED: End(
        "diverged",
        "a state has grown without bound",
        "a smaller dt, an adaptive method, or for stiff beams and contacts an implicit one; look for gains that are too"
        " high, and for a force or posture that has no bound here",
    ),
    Status.SINGULAR: End(
        "singular",
        "the mass matrix is singular beyond what the constraints bind",
        "give every speed an inertia or a constraint",
    ),
    Status.STEP_TOO_SMALL: End(
        "step too small",
        "rtol and atol ask for steps below rounding",
        "look for a force that jumps or a singular posture here; loosen rtol",
    ),
    Status.NO_CONVERGENCE: End("not converged", "the equations of an implicit step were not solved", "a smaller dt"),
    Status.CALLBACK_FAILED: End(
        "input failed", "an input is not a finite number", "inputs and outputs of blocks that are finite at all times"
    ),
    Status.NO_ROTATION: End(
        "input failed",
        "a quaternion among the inputs is not of unit length",
        "divide it by its length; samples of a rotation have to be dense enough for the chords between them",
    ),
    Status.PROJECTION_FAILED: End(
        "constraints lost",
        "the state is off the constraints and projection does not mend it",
        "start from sf.assemble; a smaller step; the loop may be stretched to its end",
    ),
    Status.ENERGY_LOST: End(
        "constraints lost",
        "keeping the constraints has taken the energy of the motion: they are singular here, or the steps are too long",
        "a smaller step, or a terminal event before it; look for a posture near here in which the loops are singular",
    ),
    Status.ENGAGED_APART: End(
        "constraints lost",
        "what engages is apart; closing it would move bodies within an instant, which no force does",
        "engage where the frames meet, bring them there first, or state the closure between the frames that will meet",
    ),
    Status.ACTION_REFUSED: End(
        "input failed",
        "what an event sets is refused",
        "speeds that are finite and parameters that the description allows; restitution where something strikes",
    ),
    Status.ACTS_WITHOUT_END: End(
        "interrupted",
        "an event acts again at the same instant: actions follow each other without end",
        "once=True, or a formula that is not zero after the action, such as 'gap + grip'; bodies that come to rest on"
        " each other need a constraint that engages there, with `rests`, or a Contact with restitution",
    ),
    Status.MODES_UNDECIDED: End(
        "not converged",
        "no modes of friction that sticks, held or sliding, agree with the motion that they bring about",
        "a static level nearer to the dynamic one, or sticks=False at one of the joints that are at rest here",
    ),
    Status.HELD_TWICE: End(
        "singular",
        "friction holds joints that others or constraints hold already, so that what each takes is not determined",
        "in a closed loop friction that sticks at no more joints than the loop has degrees of freedom; sticks=False at"
        " the others",
    ),
    Status.WRONG_CONTACT: End(
        "input failed",
        "a contact that can come to rest is penetrated here, is held though its force draws, or is one of"
        " seventeen rigid ones",
        "a start on the free side of the gap; engaged only where it presses; `rests` above zero where bodies press; at"
        " most sixteen rigid contacts at once",
    ),
    Status.NO_CONTACT_FORCE: End(
        "not converged",
        "no forces of rigid contacts were found that agree with Coulomb's law and the motion that they bring about"
        " (Painleve's paradox)",
        "less friction, or a compliant contact there: stiffness in place of restitution",
    ),
    Status.CONTACTS_AMBIGUOUS: End(
        "not converged",
        "several motions agree with Coulomb's law at rigid contacts (Painleve's paradox): which one follows is not"
        " determined",
        "less friction, or a compliant contact there: stiffness in place of restitution",
    ),
    Status.FLAT_RIM: End(
        "beyond theory",
        "a rim of a rigid contact lies on its plane, or a segment along its surface, to 0.6 degrees, touches all along,"
        " and no other contact carries it; or a rim comes to touch a cylinder at two points",
        "beside the rim or segment `points` on which the body can lie: a capsule's ends; of capsules that lie along"
        " each other the ends of both; across the edges of a box these edges as segments on the capsule",
    ),
    Status.BEYOND_THEORY: End(
        "beyond theory", "a beam is bent beyond its theory", "more modes or segments; or move the limit, beam_limit=..."
    ),
}


def beyond_theory(worst: BeamBending, limit: float, notes: tuple[str, ...] = (), t: float | None = None) -> Outcome:
    """The outcome of a run with a beam bent further than its theory holds: where it errs most, or at a time t [s]."""
    reason, advice = f"{worst}; the limit is {100.0 * limit:g} %", f"{worst.remedy}; or move the limit, beam_limit=..."
    return Outcome("beyond theory", worst.t if t is None else t, reason, advice, notes)


def past_stability(method: str) -> str:
    """The reason of a run whose step multiplies a mode of the motion."""
    return f"the step is past the limit of stability of '{method}'"


def unexamined(status: int, t: float, notes: tuple[str, ...] = ()) -> Outcome:
    """Outcome of a run whose examination Ctrl-C has ended.

    Args:
        status: Status of its last step.
        t: Its last time [s].
        notes: Notes so far.
    """
    return (UNEXAMINED if status >= 0 else ENDS[status]).outcome(t, notes)
