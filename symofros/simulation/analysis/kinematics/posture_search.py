"""The search for the posture that inverse kinematics returns (docs/theory/constraints.md, section 9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.analysis.kinematics.assembly import Indices
from symofros.simulation.analysis.kinematics.facing import facings
from symofros.simulation.analysis.kinematics.least_squares import End, damped_least_squares, polished
from symofros.simulation.analysis.kinematics.nearest_posture import FromRest, FromTargets, NearestPosture, Restore, pull
from symofros.simulation.analysis.kinematics.restarts import start_again
from symofros.simulation.analysis.kinematics.targets import Task
from symofros.simulation.analysis.states import given_inputs

# Most starts: of 300 reachable poses of each of five arms with six and seven joints the hardest took 73.
STARTS = 96
# Most steps from a drawn start; from those that lead to a solution fewer than 20 are the rule.
DRAWN_STEPS = 60
# Where no start reaches the targets: most steps of a descent, and relative differences of what is missed that do not
# tell one end from another.
_NEWTON_STEPS, _ALIKE = 60, 1e-6


@dataclass(frozen=True)
class Posture:
    """A posture that a search ends at.

    Attributes:
        q: Configuration (nq).
        solved: Whether targets and constraints are met and, with a posture of rest, no posture nearby is nearer to it.
        steps: Steps taken.
        distance: Distance from rest; 0 without.
        gradient: Norm of the gradient of half its square; 0 without.
        wrong_way_round: Whether a closure is closed with its axes apart.
        starts: Number of starts that were followed.
    """

    q: Array
    solved: bool
    steps: int
    distance: float = 0.0
    gradient: float = 0.0
    wrong_way_round: bool = False
    starts: int = 1


class _Again(NamedTuple):
    """Results of drawn starts.

    Attributes:
        solutions: The nearest solution (nq) of the first round that has any; none otherwise.
        promising: Ends (nq) that are nearest to meeting the task, without it.
        used: Free speeds that the targets depend on, by themselves or through loops.
        steps: Steps taken.
        starts: Number of starts.
    """

    solutions: list[Array]
    promising: list[Array]
    used: Indices
    steps: int
    starts: int


@dataclass(frozen=True)
class PostureSearch:
    """A search for the posture that meets a task, near a guess.

    Attributes:
        task: Targets and constraints.
        guess: Configuration (nq).
        rest: Posture of rest (nq), or None.
        free: Speeds that may be used.
        held: Names of the others.
        tolerance: Bound of the targets' largest error.
        iterations: Most steps from one start.
    """

    task: Task
    guess: Array
    rest: Array | None
    free: Indices
    held: tuple[str, ...]
    tolerance: float
    iterations: int

    def from_guess(self) -> End:
        """Where the steps from the guess alone end."""
        return self._least_squares(self.guess, self.iterations)

    def best(self, of_guess: End, starts: int) -> Posture:
        """The posture that the guess leads to, or else the best of what other starts lead to.

        Args:
            of_guess: Where the steps from the guess alone end.
            starts: Most starts.
        """
        ends = [of_guess]
        if self.rest is not None and not self.held and not np.array_equal(self.rest, self.guess):
            ends.append(self._least_squares(self.rest, self.iterations))
        solutions, given = self._solutions(ends), len(ends)
        if solutions:
            found = self._nearest_to_rest(solutions)
            return replace(found, steps=found.steps + sum(end.steps for end in ends), starts=given)
        again = self._started_again(starts - 1)
        solutions = again.solutions
        if not solutions:
            ends += [self._least_squares(q, self.iterations) for q in again.promising]
            solutions = self._nearest(self._solutions(ends[given:]))
        found = self._nearest_to_rest(solutions) if solutions else self._nearest_miss(ends, again.used)
        steps = found.steps + again.steps + sum(end.steps for end in ends)
        return replace(found, steps=steps, starts=given + again.starts)

    def _started_again(self, most: int) -> _Again:
        """The nearest solution of the first round of drawn starts that has any."""
        solver = self.task.solver
        refused = (
            self._wrong_way_round if any(closure.parallel for closure in self.task.model.record.closures) else None
        )
        near = self.guess if self.rest is None else self.rest
        steps = min(self.iterations, DRAWN_STEPS)
        found = start_again(solver, solver.within(self.guess), near, most, steps, refused)
        kept = [np.array(q[: solver.nq]) for q in solver.kept[: solver.posture.n_kept]]
        posture = solver.posture
        return _Again([solver.end()] if found else [], kept, solver.used(), int(posture.steps), int(posture.starts))

    def _least_squares(self, start: Array, most: int) -> End:
        return damped_least_squares(self.task, start, self.free, self.tolerance, most)

    def _solutions(self, ends: Sequence[End]) -> list[Array]:
        """Configurations (nq) that meet the task."""
        return [end.q for end in ends if end.met and not self._wrong_way_round(end.q)]

    def _nearest(self, solutions: Sequence[Array]) -> list[Array]:
        """The solution nearest to rest, or to the guess without rest, as a list; empty without solutions."""
        return [min(solutions, key=self._distance)] if solutions else []

    def _distance(self, q: Array) -> float:
        """Distance from rest, or from the guess without."""
        return float(np.linalg.norm(pull(self.task.model, q, self.guess if self.rest is None else self.rest)))

    def _wrong_way_round(self, q: Array) -> bool:
        """Whether a closed posture is so with axes apart that are to be parallel, where conditions vanish as well."""
        model, inputs = self.task.model, self.task.inputs
        u = given_inputs(model, inputs["u"])
        return any(float(facing.cosines) < 0.0 for facing in facings(model, q, u, inputs["par"]))

    def _nearest_to_rest(self, solutions: Sequence[Array]) -> Posture:
        """The posture nearest to rest among those that descents from the solutions reach; a solution without rest."""
        if self.rest is None:
            return Posture(solutions[0], True, 0)
        found = [self._descended(q, self.rest) for q in solutions]
        return min(found, key=lambda posture: (not posture.solved, posture.distance))

    def _descended(self, q: Array, rest: Array) -> Posture:
        """The posture nearest to rest among the solutions near one of them."""
        objective = FromRest(self.task.model, rest)
        nearest = NearestPosture(self.task, objective, self.free, self._restore(self.task))
        q, count = nearest.descend(polished(self.task, q, self.free), self.iterations)
        gradient = float(np.linalg.norm(nearest.projected_pull(q)[0]))
        solved = self._met(q) and gradient <= objective.flat(q)
        return Posture(q, solved, count, objective.distance(q), gradient)

    def _met(self, q: Array) -> bool:
        return bool(np.all(np.abs(self.task.error(q)) <= self.task.bounds(self.tolerance)))

    def _nearest_miss(self, ends: Sequence[End], used: Indices) -> Posture:
        """The best posture that some ends lead to: least error of constraints, then of targets, then distance."""
        found = [self._closed_and_descended(end.q, used) for end in ends]
        missed = [self._missed(posture) for posture in found]
        least = min(missed)
        equal_ones = [
            posture
            for posture, (broken, miss) in zip(found, missed, strict=True)
            if broken == least[0] and miss <= least[1] * (1.0 + _ALIKE)
        ]
        best = min(equal_ones, key=lambda posture: self._distance(posture.q))
        if self._met(best.q) and not best.wrong_way_round:
            return replace(self._nearest_to_rest([best.q]), steps=best.steps)
        return replace(best, distance=0.0 if self.rest is None else self._distance(best.q))

    def _closed_and_descended(self, q: Array, used: Indices) -> Posture:
        """The posture that misses the targets by least, on the constraints and near a configuration."""
        conditions = self.task.conditions
        restore = self._restore(conditions)
        closed, met, steps = restore(q, self.free, self.iterations)
        if not met:
            return Posture(closed, False, steps)
        objective = FromTargets(self.task, closed)
        end, count = NearestPosture(conditions, objective, used, restore).descend(closed, _NEWTON_STEPS)
        return Posture(end, False, steps + count, wrong_way_round=self._wrong_way_round(end))

    def _missed(self, posture: Posture) -> tuple[float, float]:
        """Norms of the errors of constraints (0 if closed, plus 1 if the wrong way round) and of targets."""
        wishes, gaps = np.split(self.task.error(posture.q), [self.task.wishes])
        closed = np.all(np.abs(gaps) <= self.task.bounds(self.tolerance)[self.task.wishes :])
        broken = 0.0 if closed else float(np.linalg.norm(gaps))
        return broken + float(posture.wrong_way_round), float(np.linalg.norm(wishes))

    def _restore(self, task: Task) -> Restore:
        """Least squares back onto a task."""

        def restore(at: Array, movable: Indices, most: int) -> tuple[Array, bool, int]:
            near = damped_least_squares(task, at, movable, self.tolerance, most)
            return (polished(task, near.q, movable) if near.met else near.q), near.met, near.steps

        return restore
