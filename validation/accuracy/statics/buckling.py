"""Buckling: by a compressive load, by the beam's own weight, sideways."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.linalg

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Mark, curves
from ...reporting.findings import Finding, Study, exponent, near
from ..beams import cantilever, interpreted, squares, stiffness_and_mass
from ..reference import data, source

FAMILIES = ("legendre", "polynomial", "spline", "clamped_free")
COLORS = {"legendre": 0, "polynomial": 2, "spline": 1, "clamped_free": 5}
# What the reference calls them.
BASES = {"polynomial": "monomials", "spline": "cubic_bspline", "clamped_free": "cantilever_eigenmodes"}
EULER = np.pi**2 / 4
# Prandtl 1899; Timoshenko & Gere, Theory of Elastic Stability: P L^2/sqrt(EI GJ).
LATERAL = 4.0126
# Stiffness on edge, of a strip whose other two are one.
STIFF = 1e8


def critical(K: Array, softening: Array) -> float:
    """The smallest positive load P at which K - P softening is singular; NaN if there is none."""
    scale = 1.0 / np.sqrt(np.diag(K))
    both = np.outer(scale, scale)
    largest = float(scipy.linalg.eigvalsh(softening * both, K * both).max())
    return 1.0 / largest if largest > 1e-9 else np.nan


def euler(family: str, functions: int) -> float:
    """P L^2/EI of a load at the tip that keeps its direction."""
    load = sf.BeamLoad((sf.formula("-P", "load"), 0.0, 0.0), at=1.0, axes="world")
    m = interpreted(cantilever(bend_y=functions, family=family, loads=(load,)), parameters=["P"])
    (K, _), (loaded, _) = stiffness_and_mass(m), stiffness_and_mass(m, P=1.0)
    return critical(K, K - loaded)


def heavy(functions: int) -> sf.Model:
    """A beam under gravity "g" along its axis, positive if it hangs."""
    return interpreted(cantilever(bend_y=functions), parameters=["g"], gravity=("g", 0, 0))


def lateral(functions: int, retain: str = "all") -> float:
    """P L^2/sqrt(EI GJ) of a strip on edge under a load at its tip; NaN if it never tips over."""
    beam = cantilever(
        bend_y=functions,
        bend_z=2,
        twist=functions,
        EI_y=STIFF,
        GJ=1.0,
        rhoJ=1.0,
        retain=retain,
        family="polynomial",
        loads=(sf.BeamLoad((0.0, 0.0, sf.formula("P", "load")), at=1.0),),
    )
    m = interpreted(beam, functions=("dynamics", "mass_matrix", "inverse_dynamics_derivatives"), parameters=["P"])
    tipping = np.array(["bend_z" not in name for name in m.names.q])
    K, _ = stiffness_and_mass(m)
    # Bending on edge is linear as long as the strip stays upright.
    still = np.zeros(m.nv)
    force = m.with_parameters(P=1.0).dynamics(np.zeros(m.nq), still, ())[2]
    bent = np.asarray(np.linalg.solve(K, force), dtype=float)
    K1, _ = stiffness_and_mass(m, bent, P=1.0)
    # The stiffness falls linearly with the load.
    both = np.ix_(tipping, tipping)
    return critical(K[both], (K - K1)[both])


def study(quick: bool) -> Study:
    """Compare buckling loads of a column, a heavy column and a strip on edge with closed forms."""
    reference = data("buckling_cantilever")
    counts = np.arange(1.0, 6.0 if quick else 11.0)
    loads = {
        family: np.array([euler(family, int(n)) if n <= 7 or family != "polynomial" else np.nan for n in counts])
        for family in FAMILIES
    }
    findings = _euler(loads, reference["convergence_with_modes"])
    m = heavy(5)
    (K, _), (falling, _) = stiffness_and_mass(m), stiffness_and_mass(m, g=-1.0)
    greenhill = critical(K, K - falling)
    findings.append(
        near(
            "buckling under its weight, 5 functions",
            greenhill,
            reference["greenhill_self_weight"],
            1e-3,
            "Greenhill 1881: 7.8373",
        )
    )
    functions = np.arange(1.0, 5.0 if quick else 7.0)
    sideways = np.array([lateral(int(n)) for n in functions])
    findings.append(
        near(
            f"lateral buckling, {functions[-1]:g} functions a field",
            float(sideways[-1]),
            LATERAL,
            1e-3 if quick else 2e-5,
            "Prandtl 1899",
        )
    )
    flat = lateral(3, "first_order")
    findings.append(
        Finding(
            "lateral buckling at first order, 1 if it occurs",
            float(np.isfinite(flat)),
            0.0,
            0.0,
            "a quadratic strain energy has no coupling",
        )
    )
    power = exponent(counts[2:], loads["clamped_free"][2:] / EULER - 1.0)
    answer = (
        f"Five polynomials give Euler's load to {loads['legendre'][4] / EULER - 1:.0e}, five splines to "
        f"{loads['spline'][4] / EULER - 1:.0e}, five cantilever modes to {loads['clamped_free'][4] / EULER - 1:.0e}, "
        f"converging as n^-{power:.1f}. A beam on its own foot falls over at ρA g L³/EI = {greenhill:.4f}. A strip on "
        f"edge tips over at {sideways[-1]:.4f} √(EI GJ)/L² with retain: all; first order has a quadratic strain energy "
        "and never does."
    )
    return Study(
        "Does it buckle when it should?",
        answer,
        (axial(counts, loads, quick, reference), strip(functions, sideways)),
        tuple(findings),
        (source("buckling_cantilever"),),
    )


def _euler(loads: Mapping[str, Array], known: Mapping[str, Mapping[str, float]]) -> list[Finding]:
    """Findings on Euler's load, against π²/4 and against a Ritz solution.

    Args:
        loads: Loads by family, of 1, 2, ... functions.
        known: Those of a Ritz solution, by number of functions and basis.
    """
    findings = [
        near(f"Euler's load, {family}, 5 functions", float(loads[family][4]), EULER, 1e-3, "π²/4")
        for family in FAMILIES
    ]
    for family, basis in BASES.items():
        worst = max(
            (abs(loads[family][n - 1] / known[str(n)][basis] - 1.0), n)
            for n in range(1, min(len(loads[family]), 7) + 1)
        )
        findings.append(
            near(
                f"Euler's load, {family}, {worst[1]} functions, against a Ritz solution",
                float(loads[family][worst[1] - 1]),
                known[str(worst[1])][basis],
                1e-8,
                "the farthest of all numbers of functions",
            )
        )
    return findings


def axial(counts: Array, loads: dict[str, Array], quick: bool, reference: dict[str, Any]) -> Figure:
    """Loads and weight along the axis."""
    errors = {family: np.maximum(load / EULER - 1.0, 1e-15) for family, load in loads.items()}
    convergence = curves(counts, errors, "joined", COLORS)
    m, weights = heavy(8), np.linspace(-10.0, 10.0, 20 if quick else 201)
    squared = np.array([squares(*stiffness_and_mass(m, g=float(g)))[0] for g in weights])
    rows = [row for row in reference["gravity_frequencies_hanging_positive"] if row["gamma"] <= 10.0]
    frequencies = (
        Curve("our beam", weights, np.sqrt(np.where(squared >= 0.0, squared, np.nan)), 0),
        Curve("exact", [row["gamma"] for row in rows], [row["omega"][0] for row in rows], 0, "points"),
    )
    weight, frequency = "weight ρA g L³/EI, positive if it hangs  [1]", "first frequency ω₁ √(ρA L⁴/EI)  [1]"
    greenhill, tenth = (Mark("Greenhill: −7.8373", -7.8373, "x"),), (Mark("0.1 %", 1e-3),)
    return Figure(
        "Left: every family comes from above and reaches 0.1 % with five functions; cantilever modes are the slowest. "
        "Right: what hangs is stiffened by its weight, what stands is softened, and falls over where the curve "
        "reaches zero.",
        (
            Chart("Euler's load", "number of functions  [1]", "relative error  [1]", convergence, tenth, log="y"),
            Chart("first frequency under its weight", weight, frequency, frequencies, greenhill),
        ),
    )


def strip(functions: Array, loads: Array) -> Figure:
    """Figure of the lateral buckling load of a strip on edge against the number of functions."""
    x, y = "number of functions a field  [1]", "critical load P L²/√(EI GJ)  [1]"
    marks, drawn = (Mark("4.0126 (Prandtl)", LATERAL),), curves(functions, {"retain: all": loads})
    return Figure(
        "The cubic part of the strain energy couples bending and twist: the load falls to Prandtl's within four "
        "functions a field.",
        (Chart("lateral buckling of a strip on edge", x, y, drawn, marks),),
    )
