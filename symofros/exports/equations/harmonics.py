"""Harmonic sums: the form in which products of sines and cosines combine into those of sums of angles.

A sum maps (monomial, frequency) to a complex coefficient c, each term being c * monomial * exp(i frequency). A
frequency is a linear form of monomials, as q1 + q2, so that a product of two terms adds their frequencies: what sines
and cosines multiply to is combined without rewriting rules, and equal functions have equal sums.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping

# Atom -> exponent, sorted by atom; atoms are numbered by who forms the sums.
Monomial = tuple[tuple[int, int], ...]
# Monomial -> multiple, sorted.
Frequency = tuple[tuple[Monomial, float], ...]
Harmonics = dict[tuple[Monomial, Frequency], complex]

ONE: Monomial = ()
CONSTANT: Frequency = ()
# What is left of two terms that cancel is rounding below this part of them.
_ROUNDING = 1e-13


class TooManyTermsError(Exception):
    """A sum has more terms than a person reads."""


def number(value: complex) -> Harmonics:
    """A number."""
    return {(ONE, CONSTANT): complex(value)} if value else {}


def atom(index: int, exponent: int = 1) -> Harmonics:
    """A power of an atom."""
    return {(((index, exponent),), CONSTANT): 1.0 + 0.0j}


def negated(a: Harmonics) -> Harmonics:
    """The negative of a sum."""
    return {key: -c for key, c in a.items()}


def added(a: Harmonics, b: Harmonics) -> Harmonics:
    """The sum of two sums; terms that cancel to rounding vanish."""
    total = dict(a)
    for key, c in b.items():
        earlier = total.get(key)
        if earlier is None:
            total[key] = c
            continue
        size, c = abs(earlier) + abs(c), earlier + c
        if abs(c) <= _ROUNDING * size:
            del total[key]
        else:
            total[key] = c
    return total


def multiplied(a: Harmonics, b: Harmonics, most: int) -> Harmonics:
    """The product of two sums.

    Raises:
        TooManyTermsError: It takes more than `most` products of terms.
    """
    if len(a) * len(b) > most:
        raise TooManyTermsError
    sizes: dict[tuple[Monomial, Frequency], float] = {}
    total: Harmonics = {}
    for (m1, f1), c1 in a.items():
        for (m2, f2), c2 in b.items():
            key = (_merged(m1, m2), _merged(f1, f2))
            c = c1 * c2
            total[key] = total.get(key, 0.0) + c
            sizes[key] = sizes.get(key, 0.0) + abs(c)
    return {key: c for key, c in total.items() if abs(c) > _ROUNDING * sizes[key]}


def _merged(a: tuple, b: tuple) -> tuple:  # type: ignore[type-arg]
    """Exponents, or multiples, added."""
    if not a or not b:
        return a or b
    total = dict(a)
    for key, n in b:
        total[key] = total.get(key, 0) + n
    return tuple(sorted((key, n) for key, n in total.items() if n))


def inverted(a: Harmonics) -> Harmonics | None:
    """The inverse of a single term; None for other sums."""
    if len(a) != 1:
        return None
    ((monomial, frequency), c) = next(iter(a.items()))
    powers = tuple((key, -n) for key, n in monomial)
    return {(powers, tuple((key, -n) for key, n in frequency)): 1.0 / c}


def wave(angle: Harmonics, sine: bool) -> Harmonics | None:
    """Sine or cosine of a sum without waves; None of other sums."""
    if any(frequency for _, frequency in angle):
        return None
    phase = angle.get((ONE, CONSTANT), 0.0).real
    rest = [(monomial, c.real) for (monomial, _), c in angle.items() if monomial]
    plus: Frequency = tuple(sorted(rest))
    minus: Frequency = tuple((monomial, -n) for monomial, n in plus)
    turned = cmath.exp(1j * phase)
    if sine:
        return added({(ONE, plus): -0.5j * turned}, {(ONE, minus): 0.5j * turned.conjugate()})
    return added({(ONE, plus): 0.5 * turned}, {(ONE, minus): 0.5 * turned.conjugate()})


def real_waves(a: Harmonics) -> dict[tuple[Frequency, bool], dict[Monomial, float]]:
    """Coefficient of each monomial by wave: (frequency, whether a sine); first multiples are positive."""
    waves: dict[tuple[Frequency, bool], dict[Monomial, float]] = {}
    for (monomial, frequency), c in a.items():
        if frequency and frequency[0][1] < 0:
            continue  # The conjugate of the term of the opposite frequency.
        factor = 2.0 if frequency else 1.0
        for sine, value in ((False, factor * c.real), (True, -factor * c.imag)):
            if abs(value) > _ROUNDING * abs(c):
                waves.setdefault((frequency, sine), {})[monomial] = value
    return waves


def frozen(a: Mapping[tuple[Monomial, Frequency], complex]) -> tuple[tuple[tuple[Monomial, Frequency], complex], ...]:
    """A sum as a key."""
    return tuple(sorted(a.items(), key=lambda item: item[0]))
