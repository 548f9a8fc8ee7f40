"""What a number in a description may be: a float, a formula, or a SymPy expression; vectors, rotations, arithmetic."""

from __future__ import annotations

import math
import numbers
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, Literal

from symofros.base.arguments import CheckedCalls, entries_of, shown
from symofros.description.parser import ExpressionError, parse
from symofros.errors import DescriptionError, did_you_mean
from symofros.expr.expression import Expression

Value = float | Expression
Vector = tuple[Value, Value, Value]
RotationKind = Literal["rpy", "axis_angle", "quaternion", "matrix"]

_ROTATION_SIZE: dict[str, int] = {"rpy": 3, "axis_angle": 4, "quaternion": 4, "matrix": 9}


def as_value(value: Any, what: str = "value") -> Value:
    """A user's number, formula text or SymPy expression as a Value.

    Args:
        value: Number, formula text or SymPy expression.
        what: The thing it belongs to, for the error.

    Raises:
        DescriptionError: Not finite, not a legal formula, or of another type.
    """
    if isinstance(value, Expression):
        return value
    if isinstance(value, str):
        try:
            parsed = parse(value)
        except ExpressionError as error:
            raise DescriptionError(error.problem_of(what)) from None
        return parsed.number if parsed.kind == "number" else parsed
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:  # An integer that no double holds.
            number = math.inf
        if not math.isfinite(number):
            raise DescriptionError(
                f"{what}: not a finite number", repr(number), "every number is finite", "give a finite value"
            )
        return number
    if type(value).__module__.partition(".")[0] == "sympy":
        from symofros.expr.freeze import freeze  # SymPy takes a third of a second, from those who use it alone.

        try:
            frozen = freeze(value)
        except ValueError as error:
            raise DescriptionError(
                f"{what}: {error}",
                str(value),
                "formulas use the op table's functions only",
                "rewrite it with these functions",
            ) from None
        return frozen.number if frozen.kind == "number" else frozen
    raise DescriptionError(
        f"{what}: neither a number nor a formula",
        shown(value),
        "a value is a number, a formula such as 'L1/2', or a SymPy expression",
        "convert it to one of these",
    )


def as_values(values: Iterable[Any], size: int, what: str) -> tuple[Value, ...]:
    """A fixed number of values.

    Raises:
        DescriptionError: The count is wrong, or a value is.
    """
    listed = entries_of(values)
    if listed is None:  # One value, or entries without an order.
        listed = [] if isinstance(values, Mapping | Set) else [values]
    if len(listed) != size:
        raise DescriptionError(
            f"{what}: wrong number of entries",
            f"{len(listed)} entries",
            f"{size} entries, in order",
            f"give all {size}, zeros included",
        )
    return tuple(as_value(value, f"{what}[{i}]") for i, value in enumerate(listed))


def as_vector(values: Iterable[Any], what: str) -> Vector:
    """Three values: x, y, z."""
    x, y, z = as_values(values, 3, what)
    return x, y, z


def symbols(value: Value) -> frozenset[str]:
    """The names a value depends on."""
    return value.symbols() if isinstance(value, Expression) else frozenset()


@dataclass(frozen=True)
class Rotation(metaclass=CheckedCalls):
    """A constant rotation R_AB (x_A = R_AB x_B), in the form it was stated.

    Attributes:
        kind: "rpy" (URDF's fixed-axis roll, pitch, yaw: Rz(y) Ry(p) Rx(r)) [rad], "axis_angle" (x, y, z, angle)
            [rad], "quaternion" (x, y, z, w), or "matrix" (nine entries, row by row).
        values: Numbers or formulas, in the order of the kind.
    """

    kind: RotationKind = "rpy"
    values: tuple[Value, ...] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Check the count and convert the values."""
        size = _ROTATION_SIZE.get(self.kind) if isinstance(self.kind, str) else None
        if size is None:
            raise DescriptionError(
                f"rotation: unknown kind '{self.kind!s:.40}'",
                shown(self.kind),
                f"one of {', '.join(_ROTATION_SIZE)}",
                did_you_mean(str(self.kind), _ROTATION_SIZE),
            )
        object.__setattr__(self, "values", as_values(self.values, size, f"rotation ({self.kind})"))

    @staticmethod
    def rpy(roll: Any, pitch: Any, yaw: Any) -> Rotation:
        """Fixed-axis roll, pitch, yaw [rad], as in URDF."""
        return Rotation("rpy", (roll, pitch, yaw))

    @staticmethod
    def axis_angle(axis: Sequence[Any], angle: Any) -> Rotation:
        """A turn by `angle` [rad] about `axis` (normalised by us)."""
        return Rotation("axis_angle", (*as_values(axis, 3, "rotation (axis_angle): axis"), angle))

    @staticmethod
    def quaternion(x: Any, y: Any, z: Any, w: Any) -> Rotation:
        """A quaternion, scalar last (normalised by us)."""
        return Rotation("quaternion", (x, y, z, w))

    @staticmethod
    def matrix(rows: Sequence[Sequence[Any]]) -> Rotation:
        """Nine entries, row by row."""
        return Rotation("matrix", tuple(entry for row in _rows(rows, "rotation (matrix)") for entry in row))

    @property
    def is_identity(self) -> bool:
        """Whether it is stated as no rotation at all."""
        return self.kind == "rpy" and self.values == (0.0, 0.0, 0.0)

    def __iter__(self) -> Iterator[Value]:
        """Iterate over the values of the rotation."""
        return iter(self.values)


def _rows(rows: Any, what: str) -> list[list[Any]]:
    """Three rows of three entries.

    Raises:
        DescriptionError: They are not.
    """
    entries = [entries_of(row) or [] for row in entries_of(rows) or []]
    if [len(row) for row in entries] != [3, 3, 3]:
        rule = "three rows of three numbers or formulas each"
        raise DescriptionError(f"{what}: no matrix of three rows", shown(rows), rule, "give all nine, zeros included")
    return entries


def as_rotation(what: str, value: Any) -> Rotation:
    """A rotation, also by the rows of its matrix.

    Args:
        what: The thing it belongs to, for the error.
        value: A Rotation, or three rows of three numbers.

    Raises:
        DescriptionError: It is neither.
    """
    if isinstance(value, Rotation):
        return value
    try:
        rows = _rows(value, what)
    except DescriptionError:
        rule = "it is a Rotation, or the rows of a matrix"
        remedy = "sf.Rotation.rpy(roll, pitch, yaw), .quaternion(x, y, z, w), .axis_angle(axis, angle) or .matrix(rows)"
        raise DescriptionError(f"{what} is no rotation", shown(value), rule, remedy) from None
    return Rotation.matrix(rows)


IDENTITY = Rotation()
ORIGIN: Vector = (0.0, 0.0, 0.0)


class Term:
    """A number or a formula with the operators of arithmetic, for formulas that are written like equations.

    Args:
        value: Number or formula.
    """

    __slots__ = ("value",)

    def __init__(self, value: Value) -> None:
        self.value = value

    def __add__(self, other: Term) -> Term:
        return _combined("add", self, other)

    def __sub__(self, other: Term) -> Term:
        return _combined("sub", self, other)

    def __mul__(self, other: Term) -> Term:
        return _combined("mul", self, other)

    def __truediv__(self, other: Term) -> Term:
        return _combined("div", self, other)

    def sqrt(self) -> Term:
        """Square root."""
        return _combined("sqrt", self)

    def tanh(self) -> Term:
        """Hyperbolic tangent."""
        return _combined("tanh", self)

    def maximum(self, other: Term) -> Term:
        """The larger of two."""
        return _combined("max", self, other)

    def minimum(self, other: Term) -> Term:
        """The smaller of two."""
        return _combined("min", self, other)

    def absolute(self) -> Term:
        """Absolute value."""
        return _combined("abs", self)


def _combined(kind: str, *terms: Term) -> Term:
    values = [term.value for term in terms]
    numbers = [value for value in values if not isinstance(value, Expression)]
    if len(numbers) == len(values):
        return Term(_ON_NUMBERS[kind](*numbers))
    return Term(
        Expression(kind, tuple(v if isinstance(v, Expression) else Expression("number", number=v) for v in values))
    )


_ON_NUMBERS: dict[str, Callable[..., float]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "sqrt": math.sqrt,
    "tanh": math.tanh,
    "max": max,
    "min": min,
    "abs": abs,
}


def substituted(value: Value, name: str, replacement: Value) -> Value:
    """A formula with a symbol replaced."""
    if not isinstance(value, Expression) or name not in value.symbols():
        return value
    if value.kind == "symbol":
        return replacement
    args = (substituted(arg, name, replacement) for arg in value.args)
    return Expression(
        value.kind,
        tuple(arg if isinstance(arg, Expression) else Expression("number", number=arg) for arg in args),
        value.number,
        value.name,
    )
