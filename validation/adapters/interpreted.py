"""SYMOFROS' NumPy interpreter: the same equations without C, so that the two check each other."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..contract.interface import States, Subject
from ..contract.memory import LatestResults
from ..mechanics.geometry import Array
from .compiled import SymofrosEngine, evaluators

NAME = "interpreted"


@dataclass(frozen=True)
class InterpretedEngine(SymofrosEngine):
    """The model on the interpreter, which solves with constraints in Python, state by state: once for each states."""

    _motions: LatestResults[tuple[Array, Array]] = field(default_factory=LatestResults)

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (Q - h), with the model's own Q."""
        return self._motion(states)[0]

    def multipliers(self, states: States) -> Array:
        """Multipliers of the constraints."""
        return self._motion(states)[1]

    def _motion(self, states: States) -> tuple[Array, Array]:
        """Accelerations and multipliers: the interpreter finds both in one call."""
        arguments = states.q, states.v, states.u
        return self._motions.get(arguments, lambda: self.model.constrained_dynamics(*arguments)[:2])


def build(subject: Subject) -> InterpretedEngine:
    """The model on the interpreter."""
    return InterpretedEngine(NAME, evaluators(subject).interpreted, subject.frames)
