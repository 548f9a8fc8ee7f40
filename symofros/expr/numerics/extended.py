"""Constants of generated text, the same on every machine: formed in extended precision and rounded once to doubles.

The last digits of LAPACK, of BLAS and of the C library's functions depend on the processor and on the library's
version: a constant that rests on them makes the generated text, and so the model, depend on where it was generated.
Sums, products, quotients and square roots of doubles are the same everywhere (IEEE 754) and need none of this.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, lru_cache
from importlib import import_module
from typing import Any

import numpy as np

from symofros.expr.ops import ADD, DIV, MUL, OPS, STOP_GRADIENT

# A number in extended precision: mpmath's mpf, which has no type annotations.
Extended = Any

# A double has 53 bits; the others allow for cancellation and tell the nearest double from the next one.
PRECISION = 192

_RULES: dict[str, Callable[..., Extended]] = {
    ADD: lambda x, y: x + y,
    MUL: lambda x, y: x * y,
    DIV: lambda x, y: x / y,
    "min": min,
    "max": max,
    "step": lambda x: int(x >= 0),
    STOP_GRADIENT: lambda x: x,
}
# Names of the op table that mpmath spells otherwise; the rest have the same name there.
_SPELLINGS = {"pow": "power", "abs": "fabs"}
# Operations on doubles whose result IEEE 754 fixes to the last bit.
_EXACT = {ADD, MUL, DIV, "sqrt", "abs", "sign", "min", "max", "floor", "step", STOP_GRADIENT}


@cache
def extended_context() -> Any:
    """A context of mpmath with `PRECISION` bits, apart from the global one, whose precision belongs to other users.

    mpmath is loaded here, at the first formula: `import symofros` alone needs none.
    """
    context = import_module("mpmath").MPContext()
    context.prec = PRECISION
    # Loading mpmath forms inf - inf. Within a NumPy loop over objects that would be taken for an error of the loop;
    # any operation of NumPy's clears the processor's flags.
    with np.errstate(all="ignore"):
        np.zeros(1) + 0.0
    return context


def extended_rule(op: str, context: Any = None) -> Callable[..., Extended]:
    """An operation of the op table on the numbers of a context of mpmath; of `extended_context` where none is given."""
    named = context or extended_context()
    rule: Callable[..., Extended] = _RULES.get(op) or getattr(named, _SPELLINGS.get(op, op))
    return rule


def nearest(op: str, *x: float) -> float:
    """The double nearest to an operation on doubles; NaN outside its domain.

    Args:
        op: Name in the op table.
        x: Operands; zeros have no sign.
    """
    return _nearest(op, *(operand + 0.0 for operand in x))


@lru_cache(maxsize=4096)
def _nearest(op: str, *x: float) -> float:
    # The C library knows domains and infinities, and errs by less than the digits that are replaced.
    with np.errstate(all="ignore"):
        approximate = float(OPS[op].rule(*x))
    if op in _EXACT or approximate == 0.0 or not math.isfinite(approximate) or not all(map(math.isfinite, x)):
        return approximate
    return float(extended_rule(op)(*map(extended_context().mpf, x)))
