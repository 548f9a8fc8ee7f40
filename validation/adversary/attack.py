"""What an attack is: scenes, our answer to each, and an independent route that may contradict it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ..mechanics.geometry import Array

Value = float | sf.Expression

# The choices that make a scene, as JSON writes them: numbers, texts, lists and objects.
Scene = dict[str, Any]


@dataclass(frozen=True)
class Verdict:
    """What became of a scene.

    Attributes:
        kind: "agreed"; "refused" where we said ourselves that there is no good answer; "undecided" where the
            independent route has none; "contradicted".
        said: Sentence on it.
        quantity: What is contradicted: it distinguishes finds of one attack.
        share: Error over its bound; above one where contradicted.
    """

    kind: Literal["agreed", "refused", "undecided", "contradicted"]
    said: str
    quantity: str = ""
    share: float = 0.0

    @property
    def sound(self) -> bool:
        """Whether the answer stands."""
        return self.kind != "contradicted"


def refused(said: object) -> Verdict:
    """The verdict on a scene for which our own code says that it has no good answer."""
    return Verdict("refused", " ".join(str(said).split()))


def undecided(said: object) -> Verdict:
    """The independent route has no answer."""
    return Verdict("undecided", " ".join(str(said).split()))


def compared(quantity: str, error: float, bound: float, claim: str) -> Verdict:
    """An error against its bound; one that is not a number contradicts.

    Args:
        quantity: Name of what was compared, without digits.
        error: Distance of our answer from the independent one.
        bound: Largest error that our claim allows.
        claim: What we claimed, in words.
    """
    share = error / bound if bound > 0.0 else math.inf if error else 0.0
    said = f"{claim}; {quantity}: {error:.3g}, allowed {bound:.3g}"
    return Verdict("agreed" if share <= 1.0 else "contradicted", said, quantity, share)


def worst(*verdicts: Verdict) -> Verdict:
    """The verdict that counts of several comparisons of one scene."""
    return max(verdicts, key=lambda verdict: (not verdict.sound, verdict.share))


@dataclass(frozen=True)
class Attack:
    """One way to look for wrong answers.

    Attributes:
        name: Name.
        claim: Our claim, and the bound that it puts on the error.
        route: Independent route.
        scenes: Strategy of scenes; what it shrinks to is the plainest scene.
        system: Scene -> its description.
        judge: Scene -> verdict; any exception but a SymofrosError is a contradiction, too.
    """

    name: str
    claim: str
    route: str
    scenes: st.SearchStrategy[Scene]
    system: Callable[[Scene], sf.System]
    judge: Callable[[Scene], Verdict]

    def verdict(self, scene: Scene) -> Verdict:
        """The verdict on a scene, with exceptions that are no refusals taken as contradictions."""
        try:
            with np.errstate(all="ignore"):
                return self.judge(scene)
        except sf.SymofrosError as error:
            return refused(error)
        except (ArithmeticError, LookupError, TypeError, ValueError, RuntimeError, AssertionError) as error:
            kind = type(error).__name__
            return Verdict("contradicted", f"an exception without words of ours: {kind}: {error}", kind, math.inf)


@dataclass(frozen=True)
class Mechanism:
    """One mechanism of many sizes: its numbers are run-time parameters, so that one compilation serves all scenes.

    Attributes:
        system: Description; the parameters' values stand for no scene.
        options: Options of compilation.
    """

    system: sf.System
    options: sf.Options = sf.Options()

    @cached_property
    def model(self) -> sf.Model:
        """The compiled model."""
        return sf.compile(self.system, self.options)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return tuple(parameter.name for parameter in self.system.parameters)

    def par(self, **values: float) -> Array:
        """Parameters (npar) in the model's order."""
        return np.array([values[name] for name in self.names], float)

    def at(self, **values: float) -> sf.System:
        """The description with these values."""
        stated = tuple(sf.Parameter(name, float(values[name])) for name in self.names)
        return sf.System(
            self.system.name,
            self.system.bodies,
            stated,
            gravity=self.system.gravity,
            constraints=self.system.constraints,
            connections=self.system.connections,
        )


def inertia(mass: Any, center: Any = (0.0, 0.0, 0.0), moments: Any = (0.0, 0.0, 0.0)) -> sf.Inertia:
    """An inertia by formulas of the parameters."""
    return sf.Inertia(sf.formula(mass), along(*center), tuple(map(sf.formula, moments)))


def along(x: Any, y: Any = 0.0, z: Any = 0.0) -> tuple[Value, Value, Value]:
    """A vector by formulas of the parameters."""
    return sf.formula(x), sf.formula(y), sf.formula(z)


def decades(low: int, high: int) -> st.SearchStrategy[float]:
    """Powers of ten; they shrink to one."""
    return st.integers(low, high).map(lambda exponent: float(10.0**exponent))
