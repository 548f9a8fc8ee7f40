"""A model, seeded states of it, and what C makes of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

import symofros as sf

from ..mechanics.assembly import assemble
from ..mechanics.geometry import Array
from ..procedures.scene import Manifold
from ..timing.models import TIMED_MODELS
from ..timing.task import flat

# Of rollouts, and of what is stepped to be timed.
STEP, STEPS = 1e-3, 100


@dataclass(frozen=True)
class Subject:
    """A model and its states: joints within 1 rad or 1 m, speeds, accelerations and inputs within 1.

    Attributes:
        label: Label of the model.
        system: The description.
        model: The same, compiled.
        q, v, u, a: States (n, nq), (n, nv), (n, nu), (n, nv).
    """

    label: str
    system: sf.System
    model: sf.Model
    q: Array
    v: Array
    u: Array
    a: Array

    @classmethod
    def of(cls, label: str, states: int) -> Subject:
        """A model of the race of times."""
        system = TIMED_MODELS[label].load()
        model = sf.compile(system)
        rng = np.random.default_rng(24)
        v, u, a = (rng.uniform(-1.0, 1.0, (states, size)) for size in (model.nv, model.nu, model.nv))
        manifold, neutral = Manifold.of(assemble(system)), model.neutral()
        q = np.array([manifold.retract(neutral, theta) for theta in rng.uniform(-1.0, 1.0, (states, model.nv))])
        return cls(label, system, model, q, v, u, a)

    def inputs(self, function: str) -> dict[str, Any]:
        """Inputs of a function by name."""
        given: dict[str, Any] = {"q": self.q, "v": self.v, "u": self.u, "a": self.a}
        return {name: given[name] for name, _ in self.model.kernel(function).signature.inputs if name in given}

    def expected(self, function: str) -> Array:
        """Results of C (n, size)."""
        return flat(*(part.reshape(len(self.q), -1) for part in self.model.evaluate(function, **self.inputs(function))))

    @cached_property
    def moved(self) -> dict[str, Array]:
        """Configurations after all steps, by method."""
        return {method: self._moved(method) for method in ("semi_implicit_euler", "rk4")}

    def _moved(self, method: str) -> Array:
        run = sf.simulate_batch(self.model, self.q, self.v, STEP * STEPS, u=self.u, method=method, dt=STEP)
        return np.asarray(run.q_last)
