"""Stiff beams: explicit steps against the closed form, undamped and with Kelvin-Voigt damping."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.optimize import brentq

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.findings import Finding
from ..reference import data, source
from ..study import (
    Cell,
    Grid,
    Limit,
    Maps,
    ParameterStudy,
    Subject,
    Verdict,
    cell,
    decades,
    longest,
    simulate,
)

# Semi-implicit Euler's energy swings by up to 1/(1 - (h ω/2)²) below its limit; beyond it 3000 steps grow without end.
BOUND = 1e3
STEPS = 3000
# A strip of steel on edge: 1 m x 20 mm x 1 mm, 7850 kg/m^3, 210 GPa.
RHO_A, EI = 7850 * 20e-6, 210e9 * 20e-3 * 1e-9 / 12
IMAGINARY = {"rk4": 2 * np.sqrt(2.0), "semi_implicit_euler": 2.0}
STABLE = "rodas4, fixed steps"
MODES = Grid("bending modes [-]", (1.0, 2.0, 3.0, 4.0, 5.0), (1.0, 2.0), log=False)
H = Grid("step h [s]", decades(2e-3, 1.0, 10), (0.04, 0.05, 0.08, 0.1, 0.3, 0.5, 0.7))
RETARDATION = Grid("retardation time c [s]", decades(1e-4, 1.0, 4), (1e-3, 1e-2, 1e-1))
H_DAMPED = Grid("step h [s]", decades(1e-3, 1.0, 8), (1e-3, 3e-3, 1e-2, 3e-2, 6e-2, 0.12, 0.3))


@cache
def strip(modes: int) -> sf.Model:
    """Clamped, with its exact modes and a retardation time "c"."""
    beam = sf.Beam(
        "strip",
        sf.Joint("clamp", "fixed"),
        1.0,
        RHO_A,
        EI_z=EI,
        bend_y=modes,
        family="clamped_free",
        damping=sf.formula("c", "damping"),
    )
    return sf.compile(sf.System(f"strip_{modes}", (beam,), gravity=(0, 0, 0), parameters=(sf.Parameter("c", 0.0),)))


@cache
def frequencies(modes: int) -> Array:
    """Natural frequencies of the strip's model (modes) [rad/s]."""
    m = strip(modes)
    frequencies: Array = sf.modes(m, np.zeros(modes)).frequencies
    return frequencies


def growth(run: sf.Trajectory) -> float:
    """Largest energy of the second half over the energy at the start."""
    with np.errstate(over="ignore", invalid="ignore"):
        ratio = float(np.max(run.energy[len(run) // 2 :]) / run.energy[0])
    # Kinetic and potential energy may both overflow while speeds do not yet.
    return ratio if np.isfinite(ratio) else np.inf


def ring(modes: int, method: str, h: float, c: float = 0.0) -> sf.Trajectory:
    """All modes deflected by a millimetre."""
    m = strip(modes).with_parameters(c=c)
    return simulate(m, np.full(modes, 1e-3), t_end=STEPS * h, method=method, dt=h, adaptive=False, every=10)


def measure(method: str) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of the map, by number of modes and step."""
    return lambda modes, h: cell(ring(int(modes), method, h), growth)


def damped(method: str) -> Callable[[float, float], Cell]:
    """Three modes, by retardation time and step."""
    return lambda c, h: cell(ring(3, method, h, c), growth)


def rk4_factor(z: Array) -> float:
    """Largest |R(z)| of RK4."""
    return float(np.abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24).max())


def roots(c: float, omega: float) -> Array:
    """Roots of s^2 + c omega^2 s + omega^2 = 0, the characteristic equation of a damped mode."""
    return np.roots([1.0, c * omega**2, omega**2]).astype(complex)


def closed_form(c: float, modes: int = 3) -> float:
    """The longest RK4 step at which no mode grows: |R(h s)| = 1."""
    steps = [
        brentq(lambda h, w=w: rk4_factor(h * roots(c, w)) - 1.0, 1.0 / max(w, c * w**2), 4.0 / min(w, 1e9))
        if rk4_factor(4.0 / w * roots(c, w)) > 1.0
        else np.inf
        for w in frequencies(modes)
    ]
    return float(min(steps))


def held(run: sf.Trajectory) -> bool:
    """Whether a run completes with an energy of at most BOUND times that at the start, in its second half."""
    return run.outcome.ok and growth(run) <= BOUND


def judge(maps: Maps) -> Verdict:
    """The edge against 2.83/omega_max."""
    known = data("steel_strip")["omega_bending"]
    apart = float(np.abs(frequencies(5) / np.array(known) - 1).max())
    reached = {
        method: longest(lambda h, m=method: held(ring(2, m, h)), 0.5 * bound / w, 2 * bound / w) * w  # type: ignore[misc]
        for method, bound in IMAGINARY.items()
        for w in (float(frequencies(2)[-1]),)
    }
    findings = (
        [
            Finding(
                f"{method}: h ω_max at the edge over {bound:.4f}",
                reached[method] / bound,
                1.005,
                0.995,
                "linear stability theory; growth over 3000 steps shows the edge to a part in a thousand",
            )
            for method, bound in IMAGINARY.items()
        ]
        + [
            Finding(
                f"{method}: factor by which {bound:.3f}/ω_max misses the edge of the map",
                maps[method].miss("y", lambda n, b=bound: b / float(frequencies(int(n))[-1])),  # type: ignore[misc]
                1.01,
                reason="the grid can't tell them apart",
            )
            for method, bound in IMAGINARY.items()
        ]
        + [
            Finding("frequencies against the known ones, relative", apart, 1e-3, reason="Euler-Bernoulli theory"),
            Finding(
                f"{STABLE}: share of the map that holds", float(maps[STABLE].good.mean()), 1.0, 1.0, "it is L-stable"
            ),
        ]
    )
    rk4 = maps["rk4"]
    first, last = (float(frequencies(n)[-1]) for n in (1, 5))
    statement = (
        f"Explicit steps hold up to h = 2.828/ω_max with RK4 (found {reached['rk4']:.4f}) and 2/ω_max with "
        f"semi-implicit Euler (found {reached['semi_implicit_euler']:.4f}), where ω_max is the highest frequency of "
        f"the model, not the one of interest: five modes instead of one raise it from {first:.2f} to {last:.0f} "
        f"rad/s and shorten RK4's longest step from {2.8284 / first:.2f} to {2.8284 / last:.4f} s. Of RK4's "
        f"{rk4.values.size} runs {rk4.wrong} grow and come to their end, {rk4.stopped} stop as diverged. {STABLE} "
        "hold everywhere."
    )
    see = (
        "Each map is cut by the dashed closed form, which falls as the square of the number of modes: blue below, "
        "where energy stays, red above. The last map has no edge."
    )
    return Verdict(statement, see, tuple(findings))


def judge_damped(maps: Maps) -> Verdict:
    """The edge against the exact stability boundary."""
    runs = maps["rk4"]
    missed = runs.miss("y", closed_form)
    heavy = float(RETARDATION.values[-3])
    edge = longest(lambda h: held(ring(3, "rk4", h, heavy)), closed_form(heavy) / 2, closed_form(heavy) * 2)
    omega = float(frequencies(3)[-1])
    best = max(RETARDATION.values, key=closed_form)
    findings = (
        Finding(
            "rk4: factor by which |R(h s)| = 1 misses the edge of the map",
            missed,
            1.01,
            reason="the grid can't tell them apart",
        ),
        Finding(
            "rk4, overdamped: h c ω² at the edge over 2.785",
            edge * heavy * omega**2 / 2.7853,
            1.005,
            0.99,
            "the fast root is -c ω² but for terms of 1/(c ω)²",
        ),
        Finding(
            "implicit_euler: share of the map that holds",
            float(maps["implicit_euler"].good.mean()),
            1.0,
            1.0,
            "it is L-stable",
        ),
    )
    statement = (
        "Damping that grows with the frequency helps RK4 only a little and then hurts: the longest step is "
        f"{closed_form(RETARDATION.values[0]):.4f} s with c = {RETARDATION.values[0]:g} s, {closed_form(best):.4f} "
        f"s at best (c = {best:.2g} s), and from c = 2/ω_max = {2 / omega:.2g} s on it falls as 2.785/(c ω_max²), "
        f"to {closed_form(RETARDATION.values[-1]):.1e} s with c = {RETARDATION.values[-1]:g} s. Of RK4's "
        f"{runs.values.size} runs {runs.stopped} diverge. Implicit Euler holds in "
        f"{maps['implicit_euler'].good.mean():.0%}."
    )
    see = (
        "The dashed boundary is level on the left, where modes swing, and falls with slope one on the right, where "
        "the highest mode creeps; the measured edge follows it in every column."
    )
    return Verdict(statement, see, findings)


def line(bound: float) -> Limit:
    """bound/omega_max over the number of modes."""
    return Limit(
        f"{bound:.3g}/ω_max",
        np.array(MODES.values),
        lambda modes: np.array([bound / frequencies(int(n))[-1] for n in modes]),
    )


def stiff() -> ParameterStudy:
    """The study of step lengths on an undamped beam."""
    return ParameterStudy(
        "How long may an explicit step be on a stiff beam?",
        f"A clamped strip of steel, 1 m x 20 mm x 1 mm, rings for {STEPS} steps from a millimetre in every mode.",
        MODES,
        H,
        "energy over that at the start [-]",
        BOUND,
        (
            *(Subject(method, measure(method), (line(bound),)) for method, bound in IMAGINARY.items()),
            Subject(STABLE, measure("rodas4")),
        ),
        judge,
        "fewer modes where the answer allows (the accuracy report says how many), or rodas4, generalized_alpha or "
        "implicit_euler, whose steps follow the motion and not the stiffest mode.",
        (source("steel_strip"),),
    )


def kelvin_voigt() -> ParameterStudy:
    """The study of step lengths on a beam with Kelvin-Voigt damping."""
    c = np.array(RETARDATION.values)
    boundary = Limit("|R(h s)| = 1", c, lambda values: np.array([closed_form(x) for x in values]))
    return ParameterStudy(
        "Does damping let steps be longer?",
        f"The strip with three modes and Kelvin-Voigt damping of retardation time c, {STEPS} steps.",
        RETARDATION,
        H_DAMPED,
        "energy over that at the start [-]",
        BOUND,
        (Subject("rk4", damped("rk4"), (boundary,)), Subject("implicit_euler", damped("implicit_euler"))),
        judge_damped,
        "rodas4 or implicit_euler for damped beams; or leave out the modes that creep: they are quasi-static.",
        (source("steel_strip"), "boundary: stability function of RK4 at the roots of s² + c ω² s + ω² = 0"),
    )


STUDY = stiff()
DAMPED_STUDY = kelvin_voigt()
