"""Voigt-Kelvin damping: logarithmic decrement and damping ratios against closed forms."""

from __future__ import annotations

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Mark
from ...reporting.findings import Finding, Study, near
from ..beams import FIRST, cantilever, motion

# Retardation time in units of sqrt(rhoA L^4/EI): the first mode has a damping ratio of about 0.02.
TAU = 0.0114
MODES = 6


def study(quick: bool) -> Study:
    """Compare a cantilever's logarithmic decrement and damping ratios with closed forms."""
    beam = cantilever(bend_y=MODES, family="clamped_free", damping=TAU, retain="zeroth_order")
    m = sf.compile(sf.System("s", (beam,), gravity=(0, 0, 0)))
    modes = sf.modes(m, np.zeros(MODES))
    # Over-damped modes come as two real eigenvalues: the frequency is the root of their product.
    K, M = -m.linearize(np.zeros(MODES), np.zeros(MODES), ())[0][MODES:, :MODES], m.mass_matrix(np.zeros(MODES))
    omegas = np.sort(np.sqrt(np.linalg.eigvals(K).real))
    oscillating = TAU * omegas / 2 < 1.0
    ratios = modes.damping[modes.eigenvalues.imag > 0.0]
    expected = TAU * omegas[oscillating] / 2
    start = np.zeros(MODES)
    start[0] = 0.01
    zeta = TAU * FIRST / 2
    damped = FIRST * np.sqrt(1 - zeta**2)
    periods = 4 if quick else 10
    # Extremes of the damped motion from rest are half a period apart, the first at the start.
    peaks = np.arange(periods + 1) * 2 * np.pi / damped
    times = np.union1d(np.linspace(0.0, peaks[-1], 60 * periods), peaks)
    q, _ = motion(m, start, np.zeros(MODES), times, 1e-10)
    heights = q[np.searchsorted(times, peaks), 0]
    decrement = float(np.log(heights[0] / heights[-1])) / periods
    closed = 2 * np.pi * zeta / np.sqrt(1 - zeta**2)
    findings = (
        near("logarithmic decrement of the first mode", decrement, closed, 1e-6, "2π ζ/√(1 − ζ²), ζ = τ ω₁/2"),
        Finding(
            "modes: largest relative error of the damping ratio",
            float(np.abs(ratios / expected - 1.0).max()),
            1e-8,
            reason="ζ = τ ω/2",
        ),
        near("number of modes that oscillate", float(len(ratios)), float(oscillating.sum()), 0.0, "those with τ ω < 2"),
        Finding(
            "other modes excited, over the first",
            float(np.abs(q[:, 1:]).max() / start[0]),
            1e-9,
            reason="damping in proportion to stiffness couples no modes",
        ),
        near("first frequency", float(omegas[0]), FIRST, 1e-8, "the cantilever's, M = 1"),
        Finding(
            "mass matrix of the modes: distance from 1",
            float(np.abs(M - np.eye(MODES)).max()),
            1e-9,
            reason="they are normalised to a mean square of one",
        ),
    )
    answer = (
        f"The first mode decays by {decrement:.6f} a period, where the closed form has {closed:.6f}. Damping ratios "
        f"are τ ω/2: they grow with frequency, so that of {MODES} modes {len(ratios)} oscillate at τ = {TAU:g}, and "
        "the others creep back. An explicit integrator sees them all: it needs steps below 2.785/(τ ω²)."
    )
    curve = Curve("first coordinate", times, q[:, 0] / start[0], 0)
    return Study("Is damping what was asked for?", answer, (figure(curve, zeta, omegas, ratios),), findings)


def figure(curve: Curve, zeta: float, omegas: Array, ratios: Array) -> Figure:
    """Decay, and ratios against frequency."""
    envelope = np.exp(-zeta * FIRST * np.asarray(curve.x))
    decay = (
        curve,
        Curve("exp(−ζ ω₁ t)", curve.x, envelope, 1, "dashed"),
        Curve("−exp(−ζ ω₁ t)", curve.x, -envelope, 1, "dashed"),
    )
    line = np.geomspace(omegas[0] / 1.2, omegas[-1] * 1.2, 50)
    growth = (
        Curve("τ ω/2", line, TAU * line / 2, 1, "dashed"),
        Curve("modes that oscillate", omegas[: len(ratios)], ratios, 0, "points"),
    )
    frequency, critical = "frequency ω √(ρA L⁴/EI)  [1]", (Mark("critical", 1.0),)
    return Figure(
        "The motion touches its exponential envelope at every extreme. At the right, the damping ratios of the modes "
        "lie on the line τ ω/2; what is above the red line does not oscillate.",
        (
            Chart("decay of the first mode", "time  [√(ρA L⁴/EI)]", "over the start  [1]", decay),
            Chart("damping ratio against frequency", frequency, "damping ratio  [1]", growth, critical, log="xy"),
        ),
    )
