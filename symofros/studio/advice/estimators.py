"""What a beam's approximations cost, by formulas: deflection, vibration, stiffening, number of functions.

Dimensionless numbers: eta = Omega sqrt(rhoA L^4 / EI) of a spin, gamma = rhoA a L^3 / EI of an acceleration along the
axis, P L^2 / EI of a force along it. Constants are integrals of the first cantilever mode phi (int phi^2 = 1 over a
unit length); docs/advise.md says where they come from.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Literal

import numpy as np

from symofros.base.arrays import Array

# Roots of cos x cosh x = -1, squared: frequencies of a cantilever in sqrt(EI / rhoA L^4).
FREQUENCIES = (
    3.51601526850015,
    22.03449156466880,
    61.69721441354900,
    120.90191605230574,
    199.85953011680346,
    298.55553096773014,
)
# Share of the load's work that goes into stiffness, of the first mode: rotation about the root, a uniform pull, a force
# at the tip; int (1 - x^2)/2 phi'^2, int (1 - x) phi'^2, int phi'^2.
BY_SPIN, BY_PULL, BY_FORCE = 1.1933363735732485, 1.5708781896764525, 4.647778312645509

# (cosh b + cos b) / (sinh b + sin b) turned over, of the modes: phi'(1) = b sigma phi(1), int phi = 2 sigma / b.
_SIGMA = (0.7340955138, 1.0184673188, 0.9992244965, 1.0000335533, 0.9999985501, 1.0000000627)

Load = Literal["uniform", "rising", "force", "moment"]
# Displacement and slope at the tip under each, EI = L = 1.
_EXACT: dict[Load, tuple[float, float]] = {
    "uniform": (1 / 8, 1 / 6),
    "rising": (11 / 120, 1 / 8),
    "force": (1 / 3, 1 / 2),
    "moment": (1 / 2, 1.0),
}


def residual(r: float) -> float:
    """Vibration left by a load A (1 - cos(2 pi t / T)) on a mode, in units of its deflection by a steady A."""
    if abs(r - 1.0) < 1e-6:
        return math.pi
    return 2.0 * abs(math.sin(math.pi * r)) / abs(r * r - 1.0)


def residual_bound(r: float) -> float:
    """The largest residual of a load as long as r periods or longer; periods below two are not resolved."""
    return math.pi if r < 2.0 else 2.0 / (r * r - 1.0)  # Zero for a load that does not change.


def deflection(
    rhoA: float,
    EI: float,
    length: float,
    across: float,
    turning: float,
    force: float,
    moment: float,
    functions: int | None = None,
    modes: bool = False,
) -> tuple[float, float]:
    """Quasi-static displacement [m] and slope [rad] of a cantilever's tip.

    Args:
        rhoA: Rhoa [kg/m].
        EI: Ei [N m^2].
        length: Length [m].
        across: Acceleration of the root across the axis, less gravity [m/s^2].
        turning: Angular acceleration [rad/s^2].
        force: Across the axis, at the tip [N].
        moment: Moment at the tip [N m].
        functions: Shape functions whose remainder is taken; None: the whole response.
        modes: Modes as in `tip_response`.
    """
    loads: dict[Load, float] = {
        "uniform": rhoA * across * length**4 / EI,
        "rising": rhoA * turning * length**5 / EI,
        "force": force * length**3 / EI,
        "moment": moment * length**2 / EI,
    }
    displacement = slope = 0.0
    for load, size in loads.items():
        exact, shown = tip_response(load), (0.0, 0.0) if functions is None else tip_response(load, functions, modes)
        displacement += size * abs(exact[0] - shown[0])
        slope += size * abs(exact[1] - shown[1]) / length
    return displacement, slope


def first_frequency(rhoA: float, EI: float, length: float, outboard: float) -> float:
    """Lowest frequency of a cantilever with a mass on its tip, by Dunkerley's formula [rad/s]."""
    return 1.0 / math.sqrt(rhoA * length**4 / (FREQUENCIES[0] ** 2 * EI) + outboard * length**3 / (3.0 * EI))


def stiffening(eta: float, gamma: float = 0.0, load: float = 0.0) -> float:
    """Relative shift of the first frequency that goes missing without foreshortening.

    Args:
        eta: Eta of the spin.
        gamma: Gamma of the root's acceleration along the axis, r Omega^2 of a hub included.
        load: P L^2 / EI of what pulls at the tip.
    """
    return (BY_SPIN * eta**2 + BY_PULL * gamma + BY_FORCE * load) / (2.0 * FREQUENCIES[0] ** 2)


def critical_ratio(eta: float) -> float:
    """Spin over the speed at which a beam without foreshortening, but with its softening, diverges."""
    return eta / FREQUENCIES[0]


def rotary_shift(rhoI: float, rhoA: float, length: float) -> float:
    """Relative shift of the first frequency by the rotary inertia of the sections."""
    return 0.5 * BY_FORCE * rhoI / (rhoA * length**2)


def characteristic_period(load: Array, dt: float) -> float:
    """2 pi over the mean frequency of a load's changes [s]; that of 1 - cos(2 pi t / T) is T.

    Args:
        load: Samples (n).
        dt: Between them [s].

    Returns:
        Infinity for a load that does not change.
    """
    changing = load - load.mean()
    size, rate = float(np.sqrt(np.mean(changing**2))), float(np.sqrt(np.mean(np.gradient(load, dt) ** 2)))
    steady = 1e-9 * max(1e-30, float(np.abs(load).max()))
    return math.inf if size <= steady or rate == 0.0 else 2.0 * math.pi * size / rate


@cache
def tip_response(load: Load, functions: int | None = None, modes: bool = False) -> tuple[float, float]:
    """Static displacement and slope of a cantilever's tip under a unit load, EI = L = 1.

    Args:
        load: "uniform", "rising" from the root to one at the tip, a "force" or a "moment" at the tip.
        functions: Shape functions that show it; None: exact.
        modes: Cantilever modes; otherwise polynomials x^2, x^3, and so on, as which the other families count.
    """
    if functions is None:
        return _EXACT[load]
    if modes:
        w, s = np.array(FREQUENCIES[:functions]), np.array(_SIGMA[:functions])
        beta, sign = np.sqrt(w), -np.resize([-1.0, 1.0], len(w))
        value, slope = 2.0 * sign, 2.0 * sign * beta * s
        force = {"uniform": 2.0 * s / beta, "rising": 2.0 / w, "force": value, "moment": slope}[load]
        amplitudes = force / w**2
    else:
        degrees = np.arange(2, min(functions, 8) + 2, dtype=float)
        a, b = np.meshgrid(degrees, degrees)
        value, slope = np.ones(len(degrees)), degrees
        force = {"uniform": 1.0 / (degrees + 1), "rising": 1.0 / (degrees + 2), "force": value, "moment": slope}[load]
        amplitudes = np.linalg.solve(a * (a - 1) * b * (b - 1) / (a + b - 3), force)
    return float(value @ amplitudes), float(slope @ amplitudes)
