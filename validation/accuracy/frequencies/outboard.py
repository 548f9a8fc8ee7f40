"""A mass carried outboard stiffens a beam that spins: against a Ritz solution by quadrature."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.special

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure
from ...reporting.findings import Finding, Study
from ..beams import spinning, spinning_squares

MASSES = (0.0, 0.3, 1.0, 3.0)
FUNCTIONS = 8
DELTA = 0.5


def ritz(eta: Array, mass: float) -> Array:
    """Squares of the first flap frequency (n) with a point mass at the tip, by 60 Gauss points; no code of ours.

    K = int phi'' phi''^T, M = int phi phi^T + m phi(1) phi(1)^T and, with the tension
    T = eta^2 (int_x^1 (delta + s) ds + m (delta + 1)), G = int T phi' phi'^T.
    """
    x, w = np.polynomial.legendre.leggauss(60)
    x, w = (x + 1) / 2, w / 2
    # Powers from two to nine, made well-conditioned by Jacobi's polynomials.
    polynomials = [np.poly1d([1, 0, 0]) * scipy.special.jacobi(k, 0, 4)(np.poly1d([2, -1])) for k in range(FUNCTIONS)]
    phi, slope, bend = (np.array([p.deriv(order)(x) for p in polynomials]) for order in (0, 1, 2))
    tip = np.array([p(1.0) for p in polynomials])
    tension = DELTA * (1 - x) + (1 - x**2) / 2 + mass * (DELTA + 1)
    K, M = bend * w @ bend.T, phi * w @ phi.T + mass * np.outer(tip, tip)
    G = slope * (w * tension) @ slope.T
    return np.array([scipy.linalg.eigvalsh(K + e * e * G, M)[0] for e in eta.tolist()])


def squares_of(etas: Array, mass: float, **changed: object) -> Array:
    """The same by our beam with a rigid body welded to its tip."""
    carried = [sf.RigidBody("load", sf.Joint("weld", "fixed", "b", "tip"), sf.Inertia(mass))] if mass else []
    m = spinning("bend_z", FUNCTIONS, *carried, **changed)
    return np.array([spinning_squares(m, float(eta), DELTA)[0] for eta in etas])


def study(quick: bool) -> Study:
    """Compare first flap frequencies of a beam with a tip mass with a Ritz solution, against the speed."""
    etas = np.linspace(0.0, 6.0, 7 if quick else 25)
    measured = {mass: squares_of(etas, mass) for mass in MASSES}
    expected = {mass: ritz(etas, mass) for mass in MASSES}
    without = squares_of(etas, MASSES[2], foreshortening=False, retain="all")
    findings = [
        Finding(
            f"mass ratio {mass:g}: largest relative error of the first flap frequency's square",
            float(np.abs(measured[mass] / expected[mass] - 1.0).max()),
            1e-9,
            reason="the same basis, by quadrature",
        )
        for mass in MASSES
    ]
    slopes = {mass: float((squares[-1] - squares[0]) / etas[-1] ** 2) for mass, squares in measured.items()}
    ratio = {mass: float(np.sqrt(squares[-1] / squares[0])) for mass, squares in measured.items()}
    findings.append(
        Finding(
            "without foreshortening, mass ratio 1: change of the frequency with speed, relative",
            float(np.abs(without / without[0] - 1.0).max()),
            1e-8,
            reason="nothing is pulled back, so nothing stiffens",
        )
    )
    answer = (
        f"At η = 6 a bare beam's flap frequency is {ratio[0.0]:.2f} times that at rest, with its own mass on the tip "
        f"{ratio[1.0]:.2f} times, with three times its mass {ratio[3.0]:.2f} times: the mass pulls the whole length "
        f"taut. The square rises by {slopes[0.0]:.2f} and {slopes[3.0]:.2f} times that of the speed. A model whose tip "
        "is not foreshortened loses all of it."
    )
    return Study(
        "What does a mass carried outboard do?", answer, (figure(etas, measured, expected, without),), tuple(findings)
    )


def figure(etas: Array, measured: dict[float, Array], expected: dict[float, Array], without: Array) -> Figure:
    """Frequencies, and how much they grow."""
    some = slice(None, None, max(1, len(etas) // 6))
    x = "speed η = Ω √(ρA L⁴/EI)  [1]"
    curves, growth = [], []
    for color, (mass, squares) in enumerate(measured.items()):
        frequency, exact = np.sqrt(squares), np.sqrt(expected[mass])
        curves += [
            Curve(f"m/ρAL = {mass:g}", etas, frequency, color),
            Curve(f"quadrature, {mass:g}", etas[some], exact[some], color, "points"),
        ]
        growth.append(Curve(f"m/ρAL = {mass:g}", etas, frequency / frequency[0], color))
    growth.append(Curve("1, without foreshortening", etas, np.sqrt(without / without[0]), 4, "dashed"))
    charts = (
        Chart(f"first flap frequency, r/L = {DELTA:g}", x, "ω₁ √(ρA L⁴/EI)  [1]", tuple(curves)),
        Chart("growth with speed", x, "over that at rest  [1]", tuple(growth)),
    )
    return Figure(
        "A mass lowers the frequency at rest and raises the share that speed adds: all curves rise to much the same "
        "height, those that start lower rise more. The dashed line, whose tip is not pulled back, does not rise.",
        charts,
    )
