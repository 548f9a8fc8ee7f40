"""Units of ports, parameters and inputs: products of powers of SI names, with dimension, scale and angle."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from symofros.errors import DescriptionError

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_FACTOR = re.compile(r"(?P<name>[A-Za-z%]+)(?:\^?(?P<power>-?\d+))?$")


@dataclass(frozen=True)
class Unit:
    """A scale, and the powers of kg, m, s, A, K, mol, cd and rad; an angle counts as a quantity of its own."""

    scale: float
    powers: tuple[int, ...]

    def __mul__(self, other: Unit) -> Unit:
        return Unit(self.scale * other.scale, tuple(a + b for a, b in zip(self.powers, other.powers, strict=True)))

    def __pow__(self, n: int) -> Unit:
        return Unit(self.scale**n, tuple(n * a for a in self.powers))


def _unit(scale: float = 1.0, **powers: int) -> Unit:
    return Unit(scale, tuple(powers.get(name, 0) for name in BASE))


NAMES: dict[str, Unit] = {
    **{name: _unit(**{name: 1}) for name in BASE},
    "g": _unit(1e-3, kg=1),
    "mm": _unit(1e-3, m=1),
    "cm": _unit(1e-2, m=1),
    "km": _unit(1e3, m=1),
    "ms": _unit(1e-3, s=1),
    "us": _unit(1e-6, s=1),
    "min": _unit(60.0, s=1),
    "h": _unit(3600.0, s=1),
    "Hz": _unit(s=-1),
    "N": _unit(kg=1, m=1, s=-2),
    "kN": _unit(1e3, kg=1, m=1, s=-2),
    "J": _unit(kg=1, m=2, s=-2),
    "W": _unit(kg=1, m=2, s=-3),
    "Pa": _unit(kg=1, m=-1, s=-2),
    "V": _unit(kg=1, m=2, s=-3, A=-1),
    "deg": _unit(math.pi / 180.0, rad=1),
    "rev": _unit(2.0 * math.pi, rad=1),
    "%": _unit(1e-2),
}


def parse(text: str) -> Unit:
    """The unit of a text such as "N m/rad", "rad/s^2" or "1".

    Raises:
        DescriptionError: The text names no unit.
    """
    product, inverse = _unit(), False
    for part in re.split(r"\s*([/*])\s*|\s+", text.strip()):
        if part in (None, "", "*", "1"):
            continue
        if part == "/":
            inverse = True
            continue
        match = _FACTOR.match(part)
        unit = NAMES.get(match["name"]) if match else None
        if match is None or unit is None:
            raise DescriptionError(
                f"unit '{text:.60}'",
                f"'{part:.40}'",
                f"products of powers of {', '.join(NAMES)}",
                "write for example N m, rad/s, kg m^2; leave it out where any unit will do",
            )
        power = int(match["power"] or 1)
        product = product * unit ** (-power if inverse else power)
    return product


def agree(first: str, second: str) -> bool:
    """Whether a signal may go from one unit into the other; an empty unit takes any."""
    if not first or not second:
        return True
    a, b = parse(first), parse(second)
    return a.powers == b.powers and math.isclose(a.scale, b.scale, rel_tol=1e-12)
