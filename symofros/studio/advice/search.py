"""sf.advise: the cheapest model that meets a scene's tolerance, each step verified against a richer model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from symofros.base.arguments import checked
from symofros.base.options import Options
from symofros.description import DIRECTIONS, Beam, System
from symofros.errors import BeamTheoryError, DescriptionError, SymofrosError, did_you_mean
from symofros.runtime.beams import bending_notes
from symofros.studio.advice.advice import Advice, Choice, Verdict
from symofros.studio.advice.candidates import Reduction, candidates, constants, fewer_functions, lower_orders
from symofros.studio.advice.loads import BeamLoads, Observed
from symofros.studio.advice.scene import Scene
from symofros.studio.advice.scene_runner import ReferenceSolution, SceneRunner, Trial
from symofros.studio.advice.stepping import cheapest
from symofros.studio.advice.theories import as_rods, missed_by_theory, simpler_theories


def refined(system: System) -> System:
    """One function more in every direction that bends or twists, and rotary inertia wherever it is stated."""
    return system.with_bodies(*(_refined(body) for body in system.beams if body.modes))


def _refined(beam: Beam) -> Beam:
    more = {"hermite": 2, "user": 0}.get(beam.family, 1)
    counts = {d: getattr(beam, d) + more for d in DIRECTIONS if getattr(beam, d)}
    stated = beam.rhoI_y != 0.0 or beam.rhoI_z != 0.0
    return replace(beam, rotary_inertia=beam.rotary_inertia or stated, **counts)


# Shares of the tolerance: what is left out may err by the first, stepping by the second.
MODEL, STEPPING = 0.8, 0.2
# A description whose own truncation takes more than this share is refined before anything is left out.
REFINE = 0.4
# Beams whose theory is estimated to miss more than this share of the tolerance are judged by geometrically exact rods.
THEORY = 0.2
_ROUNDS = 3
# Estimates err by less than this factor; what is expected to be worse is not simulated, foreshortening excepted.
HOPELESS = 30.0


@checked
def advise(system: System, scene: Scene, tolerance: float | Mapping[str, float] | None = None) -> Advice:
    """Find the cheapest model of a system that a scene can be served with.

    Estimators order what may be left out; each thing left out is verified by simulating the reduced model against a
    richer one, which has more functions than described. Last come the integrator and its step.

    Args:
        system: System with every refinement that the scene may need.
        scene: Inputs, first state, outputs of interest and their tolerances.
        tolerance: Absolute ones in place of the scene's: one for all outputs, or by name.

    Returns:
        The reduced system, how to step it, every choice with its numbers, costs and errors.

    Raises:
        DescriptionError: The scene does not fit the system.
        BeamTheoryError: A beam bends beyond second-order theory and can't be stated as a rod, because the scene starts
            from its elastic coordinates.
        UnknownNameError: An input or a first coordinate does not exist.
        SymofrosError: The motion can't be computed to the tolerance.
    """
    return _Search(system, scene.within(tolerance)).advice()


class _Search:
    """One search: the current system, what it errs by, what was decided."""

    def __init__(self, system: System, scene: Scene) -> None:
        _check(system, scene)
        self.stated = self.full = system
        self.scene, self.runner = scene, SceneRunner(scene)
        self.divided: set[str] = set()  # Beams that were put in segments, and these.
        self.choices: list[Choice] = []
        self.notes: list[str] = []
        self.unsettled = 0.0
        self.current = system
        self.reference = self._settle()
        self.seen = Observed.of(self.current, scene, self.reference)
        self.loads = {b.name: self.seen.beam(b) for b in self.current.beams if b.modes}

    def advice(self) -> Advice:
        """Reduce, then choose the stepping, of the full model as well."""
        self._reduce()
        trial, _ = self.runner.exact(self.current)
        stepping, _, _, methods = cheapest(self.runner, self.current, trial, STEPPING)
        full_trial, _ = self.runner.exact(self.full)
        full_stepping, _, _, _ = cheapest(self.runner, self.full, full_trial, STEPPING)
        stepped = self.runner.trial(self.current, stepping)
        self.notes += bending_notes(self.reference.run.bendings)
        return Advice(
            self.scene,
            self.full,
            self.current,
            stepping,
            full_stepping,
            self.runner.timed(self.current, stepping),
            self.runner.timed(self.full, full_stepping),
            tuple(self.choices),
            self.runner.errors(stepped, self.reference.trial),
            self.bounds,
            self.truncation,
            self.unsettled,
            Options(self.runner.functions(self.current, stepping.method), self.scene.frames),
            tuple(methods),
            self.runner.runs,
            tuple(self.notes),
        )

    def _settle(self) -> ReferenceSolution:
        """The richer model; the description is refined until its own truncation is small beside the tolerance.

        Beams that bend too far for their theory are rods from here on.
        """
        first = described = self._within_theory()
        if self.current != self.full:
            described = self.runner.exact(self.current)[0]
        changes: list[float] = []
        for _ in range(_ROUNDS):
            richer = refined(self.current)
            if richer == self.current:
                reference = described
                self._note_unjudged_beams()
                break
            reference = self.runner.exact(richer)[0]
            changes.append(self.runner.error(described, reference))
            if changes[-1] <= REFINE:
                break
            self.notes.append(
                f"the model errs by {changes[-1]:.2g} of the tolerance against one of more functions: refined"
            )
            self.current, described = richer, reference
        self.unsettled = _still_to_come(changes)
        if changes and changes[-1] > REFINE:
            self.notes.append(
                "the richer model has not converged: its last functions still change the outputs by"
                f" {changes[-1]:.2g} of what is allowed, by which errors count as larger; state more functions or a"
                " rod, or allow more"
            )
        self.truncation = self.runner.error(first, reference)
        self.bounds = {output.name: output.bound(reference.values[output.name]) for output in self.scene.outputs}
        return ReferenceSolution(richer, reference)

    def _note_unjudged_beams(self) -> None:
        """Add a note on beams with user-defined functions, for which no richer model judges their error."""
        own = [f"'{b.name}'" for b in self.current.beams if b.modes and b.family == "user"]
        if own:
            self.notes.append(
                f"{', '.join(own)}: functions of yours, of which there are no more to judge them by: errors are"
                " relative to the description"
            )

    def _within_theory(self) -> Trial:
        """The described motion; where second-order theory misses too much of it, rods take the place of its beams."""
        beams = [b for b in self.full.beams if b.modes and not b.elastic.is_exact]
        try:
            described = self.runner.exact(self.full)[0]
        except BeamTheoryError as error:
            self.full = self.current = as_rods(self.full, [beam.name for beam in beams], self.scene.start)
            if self.full == self.stated:
                raise
            self.notes.append(
                f"{error.problem.found}; the full model has geometrically exact rods in place of its beams"
            )
            return self.runner.exact(self.full)[0]
        seen, far = Observed.of(self.full, self.scene, ReferenceSolution(self.full, described)), []
        bendings = {bending.beam: bending for bending in seen.reference.run.bendings}
        for beam in beams:
            bending = bendings[beam.name]
            share = missed_by_theory(seen.beam(beam), bending)
            if share > THEORY:
                far.append(beam.name)
                self.notes.append(
                    f"{bending}, which is {share:.2g} of what is allowed: judged by a geometrically exact rod"
                )
        self.current = as_rods(self.full, far, self.scene.start)
        return described

    def _reduce(self) -> None:
        pool = sorted(candidates(self.seen), key=lambda one: one.estimate)
        promising = [one for one in pool if one.estimate <= 1.0]
        taken = self._take_as_many_as_allowed(promising)
        rest = [one for one in pool if one not in promising[:taken]]
        for one in sorted(rest, key=_order):
            if one.kind not in ("foreshortening", "order"):
                self._consider(one)
        self._simpler_theories()
        self._fewer()
        for beam in self._beams():
            if self.loads[beam.name].beam.elastic.is_exact and not beam.elastic.is_exact:
                rest += lower_orders(replace(self.loads[beam.name], beam=beam))
        for one in sorted(rest, key=_order):
            if one.kind in ("foreshortening", "order"):
                self._consider(one)
        if self.current.parameters:
            one = constants(self.current, self.scene.keep)
            if one.apply(self.current) != self.current:
                self._consider(one)

    def _beams(self) -> list[Beam]:
        """Elastic beams that the motion was observed of: no segments."""
        return [b for b in self.current.beams if b.modes and b.name not in self.divided]

    def _simpler_theories(self) -> None:
        """Beams of second order in place of rods: one if it serves, or the segments of the fewest operations."""
        bendings = {bending.beam: bending for bending in self.reference.run.bendings}
        for beam in self._beams():
            if not beam.elastic.is_exact:
                continue
            of_rod = self._evaluation(self.current)
            stated = simpler_theories(self.loads[beam.name], beam, bendings[beam.name])
            priced = [(one.apply(self.current), one) for one in stated]
            tried = [(len(system.bodies), self._evaluation(system), system, one) for system, one in priced]
            # One beam comes first: of its functions some may go, of those of segments none.
            for _, cost, changed, one in sorted(tried, key=lambda row: row[:2]):
                if cost >= of_rod:
                    costly = f"{one.reason}; an evaluation takes {cost} operations, {of_rod} with the rod"
                    self._note(replace(one, reason=costly), "not tried", None)
                    continue
                if self._consider(one):
                    self.divided |= {b.name for b in changed.bodies} - {b.name for b in self.full.bodies}
                    self.divided |= {beam.name} if len(changed.bodies) > len(self.full.bodies) else set()
                    break

    def _evaluation(self, system: System) -> int:
        """Operations of one evaluation of the accelerations."""
        return self.runner.operations(system, ("forward_dynamics",))["forward_dynamics"]

    def _fewer(self) -> None:
        """Fewer functions: the same for all beams first, then beam by beam."""
        beams = self._beams()
        if len(beams) > 1:
            first = [next(iter(self._hopeful(beam)), None) for beam in beams]
            together = [one for one in first if one is not None]
            if len(together) == len(beams) and self._take_as_many_as_allowed(together, whole=True):
                return
        for beam in beams:
            for one in self._hopeful(beam):
                if self._consider(one):
                    break

    def _hopeful(self, beam: Beam) -> Iterable[Reduction]:
        loads: BeamLoads = self.loads[beam.name]
        return (one for one in fewer_functions(loads, beam) if one.estimate <= HOPELESS)

    def _take_as_many_as_allowed(self, ordered: Sequence[Reduction], whole: bool = False) -> int:
        """Take as many of the first reductions as the tolerance bears, found by halving; all or none where `whole`.

        Returns:
            How many were taken.
        """
        if not ordered:
            return 0
        error = self._try(ordered)
        good, bad = (len(ordered), len(ordered) + 1) if error <= MODEL else (0, len(ordered))
        if whole and not good:
            return 0
        while bad - good > 1:
            middle = (good + bad) // 2
            off = self._try(ordered[:middle])
            good, bad, error = (middle, bad, off) if off <= MODEL else (good, middle, error)
        for one in ordered[:good]:
            self._note(one, "taken", error)
        self.current = _all(ordered[:good], self.current)
        return good

    def _consider(self, one: Reduction) -> bool:
        """Take a reduction, or refuse it, by simulation; whether it was taken."""
        if one.apply(self.current) == self.current or self._rigid(one):
            return False
        if one.estimate > HOPELESS and one.kind != "foreshortening":
            self._note(one, "not tried", None)
            return False
        error = self._try([one])
        if error > MODEL:
            self._note(self._worse(one) if one.kind == "foreshortening" else one, "refused", error)
            return False
        self.current = one.apply(self.current)
        self._note(one, "taken", error)
        return True

    def _rigid(self, one: Reduction) -> bool:
        """Whether it is about a beam that bends no more."""
        return any(not b.modes and one.subject == f"beam '{b.name}'" for b in self.current.beams)

    def _worse(self, one: Reduction) -> Reduction:
        """A refused "no foreshortening", with the error of a model that keeps only the softening in its reason."""
        name = one.subject.split("'")[1]
        body = self.current.body(name)
        assert isinstance(body, Beam)
        softened = self.current.with_bodies(replace(body, foreshortening=False, retain="first_order"))
        softened_trial = self._attempt(softened)
        off = self.runner.error(softened_trial, self.reference.trial)
        end = f"ends: {softened_trial.failure}" if softened_trial.failure else f"errs by {off:.3g} of the tolerance"
        reason = f"{one.reason}; a model that keeps the softening by the spin, without the stiffening, {end}"
        return replace(one, reason=reason, numbers={**one.numbers, "softened_error": off})

    def _try(self, some: Sequence[Reduction]) -> float:
        """The error of the current system with some reductions more."""
        return self.runner.error(self._attempt(_all(some, self.current)), self.reference.trial)

    def _attempt(self, system: System) -> Trial:
        """The motion of a candidate, stepped as the description was; none where it can't be stated."""
        _, stepping = self.runner.exact(self.full)
        try:
            return self.runner.trial(system, stepping)
        except SymofrosError as error:
            return Trial(None, str(error).splitlines()[0], {})

    def _note(self, one: Reduction, verdict: Verdict, error: float | None) -> None:
        self.choices.append(
            Choice(one.subject, one.change, one.kind, verdict, one.estimate, error, one.reason, one.numbers)
        )


# What saves most comes first.
_PRIORITY = ("rigid", "elastic joint", "direction", "theory", "rotor", "rotary inertia", "order", "foreshortening")


def _still_to_come(changes: Sequence[float]) -> float:
    """Estimated change of outputs by still more functions, after changes by one more each, in units of the tolerance.

    Changes that have become small are extrapolated as a geometric series by the ratio of the last two; after a single
    small change none is expected.
    """
    if not changes or changes[-1] > REFINE:
        return changes[-1] if changes else 0.0
    ratio = changes[-1] / changes[-2] if len(changes) > 1 else 0.0
    return changes[-1] * ratio / (1.0 - ratio)


def _order(one: Reduction) -> tuple[int, float]:
    return _PRIORITY.index(one.kind), one.estimate


def _all(some: Sequence[Reduction], system: System) -> System:
    for one in some:
        system = one.apply(system)
    return system


def _check(system: System, scene: Scene) -> None:
    names = [parameter.name for parameter in system.parameters]
    for name in scene.keep:
        if name not in names:
            raise DescriptionError(
                f"scene: keep: no parameter '{name}'",
                ", ".join(names) or "none",
                "what is kept at run time is a parameter",
                did_you_mean(name, names),
            )
