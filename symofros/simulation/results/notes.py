"""Kinds of notes: what a run, a rest or a posture may say of itself; docs/howto/simulating.md shows the table."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

# How notes on the steps of a run, or of a part of it, begin.
_OF_STEPS = ("step", "the step", "the tolerances")
_NUMBER = re.compile(r"[-+.\d]+(e[-+]?\d+)?")


def distinct(notes: Iterable[str]) -> tuple[str, ...]:
    """Notes without those that differ from an earlier one in numbers alone."""
    first: dict[str, str] = {}
    for note in notes:
        first.setdefault(_NUMBER.sub("#", note), note)
    return tuple(first.values())


def of_steps(notes: Iterable[str]) -> tuple[str, ...]:
    """Notes that are about the steps of a run."""
    return tuple(note for note in notes if note.startswith(_OF_STEPS))


class NoteKind(NamedTuple):
    """One kind of note.

    Attributes:
        says: Constant parts of the note's text, with "…" for what it is about.
        when: When it is said.
        remedy: What to try; several notes state it with numbers.
    """

    says: str
    when: str
    remedy: str


_SMALLER = "a smaller dt or an adaptive method"
NOTES: Mapping[str, NoteKind] = {
    "step past stability": NoteKind(
        "the step of … s is past the limit of stability: '…' is … for the mode that …",
        "the method multiplies a mode of the motion, or the way back to the constraints by gains, at each step",
        "dt below the limit, an implicit method, or smaller gains",
    ),
    "mode not resolved": NoteKind(
        "steps of … s follow a mode of the motion to … only: … with … of the speed",
        "fixed steps err by more than a few per cent of a mode that the motion has",
        _SMALLER,
    ),
    "steps decide": NoteKind(
        "… do not determine the motion…: … changes it by …",
        "half the step, or tighter tolerances, give another motion, of a part or over all events",
        "a smaller dt, or tighter tolerances",
    ),
    "other end": NoteKind(
        "… do not show the motion: …; …",
        "the run ends otherwise with half the step, or tighter tolerances",
        "a smaller dt, or tighter tolerances",
    ),
    "partly compared": NoteKind(
        "… are not held against … over all of the run, as '…' is not called again",
        "windows of a diagram with an external block change by finer steps, which adds up; the whole can't be repeated",
        "compare with a smaller dt, or tighter tolerances",
    ),
    "not compared": NoteKind(
        "steps of … s were not held against half of that",
        "an input function gives other inputs when it is asked again about a state",
        "compare with a smaller dt",
    ),
    "loose atol": NoteKind(
        "atol = … bounds no error of speeds that reach … only",
        "the absolute tolerance is above the speeds, and a tighter one leads elsewhere",
        "a smaller atol",
    ),
    "input between steps": NoteKind(
        "steps of … s misjudge the input '…', which changes within them",
        "the impulse of an input of time is off by more than a few per cent of its range",
        _SMALLER,
    ),
    "formula between steps": NoteKind(
        "steps of … s misjudge forces by formulas of time, which change within them",
        "a force by the model's own formula of t gives other speeds in shorter steps",
        _SMALLER,
    ),
    "passed over": NoteKind(
        "the step from t = … s to … s passes over what acts within it",
        "shorter steps change the motion within one step: a short contact, a force that comes and goes",
        "a smaller dt, or max_step",
    ),
    "energy without work": NoteKind(
        "energy changes by … J although no force does work",
        "the energy of a motion changes by more than the work that is seen",
        "a smaller dt, tighter tolerances, or another method",
    ),
    "growth without input": NoteKind(
        "speeds grow …-fold and energy by … J although no input acts",
        "a motion that nothing drives explodes",
        "a smaller dt, tighter tolerances, or another method",
    ),
    "energy overflows": NoteKind(
        "energy overflows, although the states do not, and is not judged",
        "masses or speeds are beyond what numbers hold",
        "units in which it is smaller",
    ),
    "energy of a mechanism": NoteKind(
        "the energy of '…' changes by … J beside the work done on it",
        "a mechanism of a diagram gains or loses energy, which finer steps change",
        "a smaller dt, or tighter tolerances",
    ),
    "creep": NoteKind(
        "it is smooth and holds nothing at rest, so that the joint creeps",
        "a joint with friction moves on slowly under its load at the end",
        "a smaller minimum_velocity",
    ),
    "smooth friction": NoteKind(
        "friction of '…' sticks in runs and is smooth here, by which the joint creeps from rest",
        "modes are asked for at a state at rest of a joint whose friction sticks, with no mode of friction chosen",
        "the mode as a parameter, 2: held, 1 and -1: sliding; or sticks=False",
    ),
    "singular posture passed": NoteKind(
        "a singular posture was passed at t = … s",
        "the constraints lose rank on the way: which branch follows is left to rounding",
        "another path, or compare with another step",
    ),
    "singular posture near": NoteKind(
        "the constraints came close to a singular posture at t = … s",
        "the weakest constraint keeps a small share of its strength",
        "compare with another step",
    ),
    "singular start": NoteKind(
        "the start is a singular posture: the constraints' rank is … there and … beside it",
        "an exported program begins where the constraints have less rank than beside it",
        "start beside it",
    ),
    "start moved": NoteKind(
        "start: … = … was taken as …, which meets the constraints",
        "a stated start violated the constraints in its last digits",
        "state more digits, or none",
    ),
    "gap closed": NoteKind(
        "engaging at t = … s closed a gap of |phi| = … by moving bodies, which no force does",
        "constraints engage while they are violated by a little",
        "engage where the frames meet",
    ),
    "limits left": NoteKind(
        "…, … to …, at t = … s, by up to …",
        "a coordinate, a speed or an effort leaves the limits of its joint, which are data and stop nothing",
        "stops as forces, bounded inputs, or another motion",
    ),
    "contact rests": NoteKind(
        "event '…': the contact persists from t = … s on…",
        "a contact that rests has come to rest, after strikes that accumulate or one without rebound",
        "nothing, or `restitution`, and `dt`, of which the threshold is a share",
    ),
    "strikes in sequence": NoteKind(
        "several balls struck one after the other at t = … s, as no motion was found in which they do at once",
        "rigid contacts without restitution that strike together have no simultaneous answer that is found",
        "a compliant contact there: stiffness in place of restitution",
    ),
    "contact too deep": NoteKind(
        "contact '…' is … times its radius deep at t = … s: …",
        "the centre of a ball came to lie within the solid that should push it back",
        "a larger stiffness, or a smaller dt",
    ),
    "motions contradict": NoteKind(
        "inputs '…' and '…' prescribe no one motion",
        "a recorded input for a rate is not the rate of the coordinate that is prescribed beside it",
        "the coordinate as a formula of t alone, or the rates that belong to it",
    ),
    "beam bends": NoteKind(
        "bends by …: second-order theory errs by about … % of the deflection",
        "a beam bends so far that its theory errs by more than a per cent",
        "more beams joined end to end, or theory: strain",
    ),
    "rod bends": NoteKind(
        "rod '…' bends by …: its … sections place it to about … % of its length",
        "a rod bends so far between its sections that its place is off by more than a per cent",
        "more sections",
    ),
    "beam order": NoteKind(
        "beam '…' leaves out …, with which …",
        "its order (`retain`, `foreshortening`), or a lack of functions, leaves out what loads or rotation do to it",
        "`retain: all`, `first_order` where axial forces or rotation are left out, or functions that are named",
    ),
    "too few functions": NoteKind(
        "beam '…' has too few shape functions for mode …: its frequency of … rad/s is too high…",
        "the frequency of a mode is off by more than 5 %, as a beam's functions do not have its shape",
        "more functions, or segments; or ignore the mode",
    ),
    "functions unjudged": NoteKind(
        "how far too few shape functions of beam … raise frequencies is not estimated: …",
        "modes of a model that was compiled without the functions of the estimate, or of a beam without stations",
        "default functions and stations",
    ),
    "no equilibrium": NoteKind(
        "the state is neither an equilibrium nor a steady motion: '…' accelerates by …",
        "modes are asked for at a state that moves on, to where the linearised equations are others",
        "the state that `sf.equilibrium` finds",
    ),
    "changing equations": NoteKind(
        "the linearised equations change along this motion, for a mode by … % in … s",
        "modes are asked for about a motion on which, or at a time at which, the equations do not stay what they are",
        "coordinates and speeds in which they do, as along axes that turn with the motion; a run of the motion",
    ),
    "regulated motion": NoteKind(
        "model '…' is not at rest in its first state with the nominal inputs: '…' accelerates by …",
        "a regulator (`LQR`) is about a state in which its model does not stay",
        "a first state that `sf.equilibrium` finds, or nominal inputs that hold it",
    ),
    "critical load": NoteKind(
        "beam '…' is loaded past its critical load",
        "axial loads leave a beam no stiffness, so that a rest is unstable or a run has no bent rest",
        "less load, or theory: strain",
    ),
    "unstable rest": NoteKind(
        "this … is unstable: moved by a little, '…' leaves it at … 1/s…",
        "forces with a potential leave a rest that `sf.equilibrium` found, or a mode about its steady motion grows",
        "a guess nearer to the rest that is meant, or held coordinates",
    ),
    "many rests": NoteKind(
        "… may rest at other values, too: of many equilibria this is the one of the least change of the guess",
        "states of forces rest whatever they are, as bristles that stick",
        "a guess of q and z near the rest that is meant, or a run that leads to it",
    ),
    "yields": NoteKind(
        "… would yield under the forces of the guess: kept as in the guess",
        "bristles or elements that slip would carry more than they can; the coordinates move to a rest instead",
        "a guess nearer to where it rests, or less load",
    ),
    "kink of forces": NoteKind(
        "… have a kink here (slopes …): modes are those of the mean slope",
        "forces, or rates of states of forces, differ to both sides, as of a rope that goes slack or of bent bristles",
        "modes about a state beside the kink, about unbent bristles (z = 0), or a run of the motion at hand",
    ),
    "efforts left out": NoteKind(
        "no parameters give all of M a + h: … % of the largest effort is left; …",
        "base parameters of a model with armatures, rotors or beams, which have no columns",
        "the columns of `joint_terms`, or a model of the rigid links",
    ),
    "parameters not excited": NoteKind(
        "the motion determines … of … base parameters, and not …: …",
        "a fit of base parameters to a motion that does not move what shows them",
        "motions of the joints that show them",
    ),
    "parameters poorly excited": NoteKind(
        "the motion tells base parameters poorly apart: … have … times the deviation of one that is fitted alone …; …",
        "a fit whose columns of unit length have a condition above 100",
        "larger or faster motions, of more frequencies, or fewer parameters",
    ),
    "loops not closed": NoteKind(
        "no start closes the loops: constraints are missed by …",
        "inverse kinematics finds no posture on the constraints",
        "another start, or targets that the loops allow",
    ),
    "closed the wrong way": NoteKind(
        "a closure is closed the wrong way round: axes that are to be parallel point apart",
        "inverse kinematics finds a posture of another assembly",
        "a start near the assembly that is meant",
    ),
    "event undecided": NoteKind(
        "event '…' turns at t = … s so near to zero that the steps cannot tell whether it gets there",
        "an event's formula touches zero within the accuracy of the steps",
        "tighter steps, or a formula that crosses",
    ),
    "events missed": NoteKind(
        "event '…' changes too often in the step from t = … s on to be followed",
        "an event's formula oscillates many times within a step",
        "a smaller dt, or max_step",
    ),
    "late steps": NoteKind(
        "… of … steps began late, by … ms at most",
        "steps of a run in real time take longer than they last",
        "a larger dt, or a faster function of inputs",
    ),
    "signal not finite": NoteKind(
        "block '…': output '…' is … at t = … s, …",
        "a block of a diagram gave a number that is not finite: unread, or read through limits, it ended no run",
        "mend the block, or its formula where it leaves its domain",
    ),
    "controller": NoteKind(
        "seen as: …",
        "a diagram's run diverged by a sampled block, which is named; this is how it showed",
        "lower the gains of the block, or sample it more often",
    ),
    "inputs forgotten": NoteKind(
        "what was before t = … s was not looked at: inputs are kept of … changes",
        "a stepper has had more changes of inputs than it keeps",
        "reset, or save, in between",
    ),
    "steps together": NoteKind(
        "the steps of motions that are stepped together are not examined",
        "an outcome of sf.Steppers is asked for, of a motion whose inputs are not kept; it says what others bear",
        "an sf.Stepper with the same inputs",
    ),
    "batch not examined": NoteKind(
        "a motion of so many steps is not examined in a batch",
        "a batch has events, or records of its end alone, and more than 100 000 steps a motion",
        "sf.simulate of that motion, or without events a closer output",
    ),
}
