"""What a step makes of a free mode exp(rate t), by the tableau of its method (docs/theory/simulation.md, section 8)."""

from __future__ import annotations

import cmath

import numpy as np

from symofros.simulation.stepping.tableaus import Tableau

# Of generalized alpha: native/stepping/run.c.
SPECTRAL_RADIUS = 0.8
# In place of the zero at the pole of a rational function, z = 1/gamma.
_POLE = 1e-9


def explicit(tableau: Tableau, z: complex) -> complex:
    """Explicit Runge-Kutta methods, (12): the polynomial of the tableau."""
    slopes = np.zeros(tableau.stages, dtype=complex)
    for i in range(tableau.stages):
        slopes[i] = z * (1.0 + tableau.a[i, : tableau.stages] @ slopes)
    return complex(1.0 + tableau.b[: tableau.stages] @ slopes)


def rosenbrock(tableau: Tableau, z: complex) -> complex:
    """Rosenbrock methods, (12): a rational function of the tableau."""
    solutions = np.zeros(tableau.stages, dtype=complex)
    for i in range(tableau.stages):
        right = z * (1.0 + tableau.a[i, : tableau.stages] @ solutions) + tableau.coupling[i] @ solutions
        solutions[i] = right / (1.0 / tableau.gamma - z or _POLE)
    return complex(1.0 + tableau.b[: tableau.stages] @ solutions)


def semi_implicit(_tableau: Tableau, z: complex) -> complex:
    """Semi-implicit Euler, (13): of the oscillator, or of the pair of an unstable equilibrium, or of a damper."""
    stiffness, damping = _oscillator(z)
    if stiffness == 0.0:
        return complex(1.0 - damping)
    half = 1.0 - 0.5 * (damping + stiffness)
    root = cmath.sqrt(half * half - (1.0 - damping))
    return _nearest([half + root, half - root], z)


def alpha(_tableau: Tableau, z: complex) -> complex:
    """Generalized alpha, (14): an eigenvalue of its map of (x, h v, h^2 s)."""
    rho = SPECTRAL_RADIUS
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + alpha_f - alpha_m
    beta = 0.25 * (gamma + 0.5) ** 2
    stiffness, damping = _oscillator(z)
    force = np.array([[-stiffness, -damping, 0.0]])  # a = -stiffness x - damping v
    # Unknown x_1, v_1, s_1; a_1 = force (x_1, v_1), a_0 = force (x_0, v_0).
    left, right = np.eye(3), np.zeros((3, 3))
    left[0, 2], left[1, 2] = -beta, -gamma
    right[0], right[1] = [1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1.0 - gamma]
    left[2] = (1.0 - alpha_m) * np.array([0.0, 0.0, 1.0]) - (1.0 - alpha_f) * force
    right[2] = alpha_f * force - alpha_m * np.array([[0.0, 0.0, 1.0]])
    first = 1 if stiffness == 0.0 else 0  # Of a damper alone the position is no part of the mode.
    step = np.linalg.solve(left[first:, first:], right[first:, first:])
    return _nearest(list(np.linalg.eigvals(step)), z)


def midpoint(_tableau: Tableau, z: complex) -> complex:
    """The variational midpoint rule, (15)."""
    return (1.0 + 0.5 * z) / (1.0 - 0.5 * z)


def _oscillator(z: complex) -> tuple[float, float]:
    """Stiffness and damping, in units of the step, of the equation x'' = -stiffness x - damping x' with that mode.

    A mode without oscillation has no partner that were known: one that decays is taken for a damper alone, one that
    grows for half of an unstable equilibrium without damping.
    """
    if abs(z.imag) > 1e-9 * abs(z.real):
        return abs(z) ** 2, -2.0 * z.real
    return (0.0, -z.real) if z.real <= 0.0 else (-(z.real**2), 0.0)


def _nearest(factors: list[complex], z: complex) -> complex:
    """Factor of a mode by a step: the largest if it exceeds both 1 and |exp(z)|, otherwise the nearest to exp(z)."""
    exact = cmath.exp(min(z.real, 300.0) + 1j * z.imag)
    largest = max(factors, key=abs)
    if abs(largest) > max(1.0, abs(exact)) * (1.0 + 1e-9):
        return complex(largest)
    return complex(min(factors, key=lambda factor: abs(factor - exact)))
