"""How many decimal digits the generator and SymPy agree to, in extended precision at rational points."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
import sympy

import symofros as sf
from symofros.tools import evaluate_precisely

from . import kane
from .models import MODELS
from .scope import Derived

Derivation = Callable[[sf.System], Derived]

FUNCTIONS = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "potential_energy")
# Both sides compute with so many digits; agreement is capped here.
WORKING = 50


@dataclass(frozen=True)
class Agreement:
    """Digits to which the generator and SymPy's derivation of one model agree.

    Attributes:
        model: Name of the model.
        derivation: How SymPy derives it: "kane".
        digits: Digits of agreement by function, the fewest over the points.
        required: Digits that each must have.
        ok: Whether they have.
    """

    model: str
    derivation: str
    digits: Mapping[str, float]
    required: float
    ok: bool


def check(name: str, points: int = 2, seed: int = 0) -> Agreement:
    """Compare the generator with Kane's derivation of one of the models."""
    model = MODELS[name]
    digits = agreement(model.system, kane.derive, points, seed)
    return Agreement(name, "kane", digits, model.digits, min(digits.values()) >= model.digits)


def agreement(system: sf.System, derive: Derivation, points: int, seed: int) -> dict[str, float]:
    """Digits by function, the fewest over the points.

    Args:
        system: System to derive; what the generator rounds ahead of time, such as constant unit vectors, shows in the
            digits.
        derive: Derivation of the oracle.
        points: Number of points.
        seed: Seed of the points.

    Raises:
        NotDerivable: By the oracle.
    """
    derived = derive(system)
    program = sf.program_of(system, FUNCTIONS)
    arguments = [*derived.u, *derived.symbols.values()]
    shorts = sympy.lambdify(arguments, list(derived.shorts.values()), "mpmath", cse=True)
    symbols = [*derived.q, *derived.v, *derived.u, *derived.symbols.values(), *derived.shorts]
    entries = sympy.lambdify(symbols, [list(derived.values[name]) for name in FUNCTIONS], "mpmath", cse=True)
    par = [item for item in system.parameters if not item.constant]
    rng = np.random.default_rng(seed)
    worst = dict.fromkeys(FUNCTIONS, float(WORKING))
    for _ in range(points):
        with mpmath.workdps(WORKING):
            q, v, u = (_rationals(rng, len(symbols)) for symbols in (derived.q, derived.v, derived.u))
            for start in derived.quaternions:
                q[start : start + 4] = _quaternion(q[start : start + 3])
            constants = {item.name: mpmath.mpf(item.value) for item in system.parameters}
            constants["t"] = _rationals(rng, 1)[0]
            known = [constants[key] for key in derived.symbols]
            known += shorts(*u, *known)
        inputs = {"q": q, "v": v, "u": u, "par": [constants[item.name] for item in par], "t": [constants["t"]]}
        with mpmath.workdps(WORKING):
            derived_values = dict(zip(FUNCTIONS, entries(*q, *v, *u, *known), strict=True))
            for function in program.functions:
                values = [x for output in evaluate_precisely(program, function, inputs, WORKING) for x in output]
                worst[function.name] = min(worst[function.name], _digits(values, derived_values[function.name]))
    return worst


def _rationals(rng: np.random.Generator, count: int) -> list[Any]:
    """Between -1 and 1."""
    return [mpmath.mpf(int(n)) / 64 for n in rng.integers(-63, 64, count)]


def _quaternion(x: Sequence[Any]) -> list[Any]:
    """A rational unit quaternion: the stereographic projection of three numbers."""
    square = sum(e * e for e in x)
    return [*(2 * e / (1 + square) for e in x), (1 - square) / (1 + square)]


def _digits(values: Sequence[Any], references: Sequence[Any]) -> float:
    """Decimal digits in which values agree with references, relative to the largest reference."""
    scale = max((abs(x) for x in references), default=mpmath.mpf(0)) or mpmath.mpf(1)
    error = max((abs(a - b) for a, b in zip(values, references, strict=True)), default=mpmath.mpf(0)) / scale
    return float(WORKING) if error == 0 else min(float(WORKING), float(-mpmath.log10(error)))
