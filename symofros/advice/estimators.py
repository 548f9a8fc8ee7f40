"""What a beam's approximations cost, by formulas: deflection, vibration, stiffening, number of functions.

Dimensionless numbers: eta = Omega sqrt(rhoA L^4 / EI) of a spin, gamma = rhoA a L^3 / EI of an acceleration along the
axis, P L^2 / EI of a force along it. Constants are integrals of the first cantilever mode phi (int phi^2 = 1 over the unit
length); docs/advise.md derives them.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from symofros.runtime.kernel import Array

# Roots of cos x cosh x = -1, squared: frequencies of a cantilever in sqrt(EI / rhoA L^4).
FREQUENCIES = (3.5160152685, 22.0344915647, 61.6972144135, 120.9019160523, 199.8595301168, 298.5555310341)
# Share of the load's work that goes into stiffness, of the first mode: rotation about the root, a uniform pull, a force
# at the tip; int (1 - x^2)/2 phi'^2, int (1 - x) phi'^2, int phi'^2.
BY_SPIN, BY_PULL, BY_FORCE = 1.1933363735732485, 1.5708781896764525, 4.647778312645509


def residual(r: float) -> float:
    """Vibration left by a load A (1 - cos(2 pi t / T)) on a mode, in units of its deflection by a steady A.

    Args:
        r: Periods of the mode in T.
    """
    if abs(r - 1.0) < 1e-6:
        return math.pi
    return 2.0 * abs(math.sin(math.pi * r)) / abs(r * r - 1.0)


def residual_bound(r: float) -> float:
    """The largest residual of a load as long as r periods or longer; what is shorter than two is not told apart."""
    return math.pi if r < 2.0 else 2.0 / (r * r - 1.0)


def deflection(rhoA: float, EI: float, length: float, outboard: float, across: float, turning: float) -> float:
    """Quasi-static displacement of a cantilever's tip [m].

    Args:
        rhoA: [kg/m].
        EI: [N m^2].
        length: [m].
        outboard: Mass on the tip [kg].
        across: Acceleration of the root across the axis, less gravity [m/s^2].
        turning: Angular acceleration [rad/s^2].
    """
    uniform = rhoA * across * length**4 / (8.0 * EI)
    rising = 11.0 * rhoA * turning * length**5 / (120.0 * EI)
    return uniform + rising + outboard * (across + turning * length) * length**3 / (3.0 * EI)


def first_frequency(rhoA: float, EI: float, length: float, outboard: float) -> float:
    """Lowest frequency of a cantilever with a mass on its tip, by Dunkerley's formula [rad/s]."""
    return 1.0 / math.sqrt(rhoA * length**4 / (FREQUENCIES[0] ** 2 * EI) + outboard * length**3 / (3.0 * EI))


def stiffening(eta: float, gamma: float = 0.0, load: float = 0.0) -> float:
    """Relative shift of the first frequency that goes missing without foreshortening.

    Args:
        eta: Of the spin.
        gamma: Of the root's acceleration along the axis, r Omega^2 of a hub included.
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
def left_out(functions: int, modes: bool, at_tip: bool) -> float:
    """Share of the static deflection at the tip that some shape functions can't show.

    Args:
        functions: How many.
        modes: Cantilever modes; otherwise polynomials x^2, x^3, and so on, as which the other families count.
        at_tip: Under a force at the tip; otherwise under a load that rises from the root, as by turning.
    """
    whole = 1.0 / 3.0 if at_tip else 11.0 / 120.0
    if functions == 0:
        return 1.0
    if modes:
        # phi(1) = 2 (-1)^n, int x phi = 2 (-1)^n / w_n, of unit modes.
        shares = [4.0 / w**2 if at_tip else 4.0 / w**3 for w in FREQUENCIES[:functions]]
        return abs(1.0 - sum(shares) / whole)
    degrees = np.arange(2, min(functions, 8) + 2, dtype=float)
    a, b = np.meshgrid(degrees, degrees)
    K = a * (a - 1) * b * (b - 1) / (a + b - 3)
    force = np.ones(len(degrees)) if at_tip else 1.0 / (degrees + 2)
    return abs(1.0 - float(np.linalg.solve(K, force).sum()) / whole)
