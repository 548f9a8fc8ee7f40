"""Couplings of two coordinates as polynomials, which URDF (mimic) and MJCF (joint equalities) have places for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from symofros.base.names import symbol_of
from symofros.description import Coupling, System, Value
from symofros.exports.interchange.rigid import RigidLink
from symofros.expr import Expression
from symofros.mechanics.topology import Numbers

# Largest degree of a polynomial that is looked for: MuJoCo's.
DEGREE = 4

# Coefficients by the powers of two coordinates.
_Terms = dict[tuple[int, int], float]


@dataclass(frozen=True)
class PolynomialCoupling:
    """A coordinate that is a polynomial of another: q_follower = sum c_k q_leader^k.

    Attributes:
        name: Name of the coupling.
        follower: Name of the coordinate that follows.
        leader: Name of the coordinate that it follows; None where it is held in its place.
        coefficients: c_0, c_1, ... in units of the coordinates, at the parameters' default values; DEGREE + 1 at most.
    """

    name: str
    follower: str
    leader: str | None
    coefficients: tuple[float, ...]


def polynomial_couplings(system: System, links: Sequence[RigidLink], numbers: Numbers) -> list[PolynomialCoupling]:
    """The couplings of a system that are polynomials of one turn or slide in another, in order."""
    axes = {axis.name for link in links for axis in link.axes}
    couplings = (polynomial_coupling(item, numbers, axes) for item in system.constraints if isinstance(item, Coupling))
    return [coupling for coupling in couplings if coupling is not None]


def polynomial_coupling(coupling: Coupling, numbers: Numbers, candidates: set[str]) -> PolynomialCoupling | None:
    """A coupling as a polynomial of one coordinate in another; None where it is none.

    Args:
        coupling: Coupling by formula.
        numbers: Values of the parameters.
        candidates: Names of coordinates that may be bound: those of turns and slides.
    """
    names = _symbols(coupling.residual)
    called = {symbol_of(name): name for name in candidates}
    bound = sorted(names - numbers.parameters.keys())
    if not 0 < len(bound) <= 2 or not called.keys() >= {*bound}:
        return None
    terms = _terms(coupling.residual, numbers, tuple(bound))
    if terms is None:
        return None
    # A gear is linear in both: the coordinate that is stated first follows, as in `q2 - 3*q1`.
    stated = [name for name in _names(coupling.residual) if name in bound]
    order = sorted(range(len(bound)), key=lambda i: stated.index(bound[i]))
    for i in order:
        solved = _solved(terms, i)
        if solved is not None:
            leader = called[bound[1 - i]] if len(bound) == 2 and any(solved[1:]) else None
            return PolynomialCoupling(coupling.name, called[bound[i]], leader, solved)
    return None


def _symbols(value: Value) -> frozenset[str]:
    return value.symbols() if isinstance(value, Expression) else frozenset()


def _names(value: Value) -> Iterator[str]:
    """Names in the order of a formula's text, one as often as it stands there."""
    if isinstance(value, Expression):
        if value.kind == "symbol":
            yield value.name
        for arg in value.args:
            yield from _names(arg)


def _solved(terms: _Terms, i: int) -> tuple[float, ...] | None:
    """Coefficients of coordinate i in powers of the other one, if it enters by itself alone and linearly."""
    own = (1, 0) if i == 0 else (0, 1)
    slope = terms.get(own, 0.0)
    rest = {powers: c for powers, c in terms.items() if powers != own and c != 0.0}
    if slope == 0.0 or any(powers[i] for powers in rest):
        return None
    degree = max((powers[1 - i] for powers in rest), default=0)
    if degree > DEGREE:
        return None
    by_power = {powers[1 - i]: -c / slope + 0.0 for powers, c in rest.items()}
    solved = tuple(by_power.get(k, 0.0) for k in range(degree + 1))
    return solved if all(map(math.isfinite, solved)) else None


def _terms(value: Value, numbers: Numbers, names: tuple[str, ...]) -> _Terms | None:
    """A formula as a polynomial of one or two coordinates; None where it is none, or of a high degree."""
    if not _symbols(value) & set(names):
        return {(0, 0): numbers.value(value)}
    assert isinstance(value, Expression)
    if value.kind == "symbol":
        return {(1, 0) if value.name == names[0] else (0, 1): 1.0}
    if value.kind == "pow":
        return _power(value, numbers, names)
    args = [_terms(arg, numbers, names) for arg in value.args]
    first = args[0]
    if value.kind == "neg" and first is not None:
        return _scaled(first, -1.0)
    second = args[1] if len(args) == 2 else None
    if first is None or second is None:
        return None
    if value.kind in ("add", "sub"):
        return _sum(first, second if value.kind == "add" else _scaled(second, -1.0))
    if value.kind == "mul":
        return _product(first, second)
    if value.kind == "div" and second.keys() == {(0, 0)} and second[0, 0] != 0.0:
        return {powers: c / second[0, 0] for powers, c in first.items()}
    return None


def _power(value: Expression, numbers: Numbers, names: tuple[str, ...]) -> _Terms | None:
    base, exponent = value.args
    if _symbols(exponent) & set(names):
        return None
    count, terms = numbers.value(exponent), _terms(base, numbers, names)
    if terms is None or count not in range(DEGREE + 1):
        return None
    raised: _Terms | None = {(0, 0): 1.0}
    for _ in range(int(count)):
        raised = None if raised is None else _product(raised, terms)
    return raised


def _scaled(terms: _Terms, factor: float) -> _Terms:
    return {powers: factor * c for powers, c in terms.items()}


def _sum(a: _Terms, b: _Terms) -> _Terms:
    return {powers: a.get(powers, 0.0) + b.get(powers, 0.0) for powers in a | b}


def _product(a: _Terms, b: _Terms) -> _Terms | None:
    terms: _Terms = {}
    for ((i, j), x), ((k, m), y) in product(a.items(), b.items()):
        powers = i + k, j + m
        if x * y == 0.0:
            continue
        if max(powers) > DEGREE:
            return None
        terms[powers] = terms.get(powers, 0.0) + x * y
    return terms
