"""Frequencies of a spinning cantilever against the tables, and what becomes of them without foreshortening."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.optimize

from ...adapters.exudyn.ancf import spinning_frequencies
from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Kind, Mark
from ...reporting.findings import Finding, Study, near
from ..beams import FIRST, spinning, spinning_squares
from ..reference import data, source

PLANES = {"flap": ("bend_z", "flap"), "lag": ("bend_y", "chord")}
LINES: dict[int, Kind] = {8: "joined", 10: "dashed"}
SPEED = "speed η = Ω √(ρA L⁴/EI)  [1]"
FREQUENCY = "first frequency ω₁ √(ρA L⁴/EI)  [1]"
# What a Ritz solution with polynomials of these degrees gives is 9.8e-6 and 2.4e-7, at the highest speed.
BOUNDS = {8: 2e-5, 10: 5e-7}
# Half a unit of the last decimal that is printed, and what the computed table differs by.
PRINTED = 0.5e-4 + 1e-6


def study(quick: bool) -> Study:
    """Compare frequencies of a spinning cantilever, with and without foreshortening, with tables and Exudyn."""
    reference = data("spinning_cantilever")
    etas = np.linspace(0.0, 12.0, 13 if quick else 97)
    worst = {n: errors(n, reference["table"]) for n in BOUNDS}
    critical = {delta: divergence(delta) for delta in (0.0, 1.0)}
    flap = spinning("bend_z", 10)
    published = max(
        np.abs(np.sqrt(spinning_squares(flap, int(eta), 0.0)[:3]) - row).max()
        for eta, row in reference["published_wright_delta0"].items()
    )
    apart = engine((3.0, 12.0) if quick else (0.5, 3.0, 6.0, 9.0, 12.0))
    findings = [*_findings(worst, float(published), critical, apart), *_above_divergence()]
    slow = next(row["chord"][0] for row in reference["table"] if (row["delta"], row["eta"]) == (0, 1))
    answer = (
        f"Eight functions follow the first three frequencies up to η = 12 to "
        f"{max(float(e.max()) for e in worst[8].values()):.1e}, ten to "
        f"{max(float(e.max()) for e in worst[10].values()):.1e}. Without foreshortening flap does not stiffen at all, "
        f"and lag loses its stiffness at η = {critical[0.0]:.4f}, the frequency at rest; long before it diverges "
        f"such a model is wrong, by {1 - np.sqrt(FIRST**2 - 1) / slow:.0%} at η = 1. Above it flies away, at a rate of "
        f"{growth(6.0):.2f} at η = 6, where a foreshortened beam only gets stiffer; of order zero it is as at rest."
    )
    return Study(
        "Does a beam stiffen as it should when it spins?",
        answer,
        (frequencies(etas, reference["table"]), accuracy(worst)),
        tuple(findings),
        (source("spinning_cantilever"),),
    )


def _findings(
    worst: Mapping[int, Mapping[tuple[str, int], Array]],
    published: float,
    critical: Mapping[float, float],
    apart: float,
) -> list[Finding]:
    """Findings on errors of frequencies, on speeds of divergence, and on the difference from Exudyn.

    Args:
        worst: Errors by number of functions, then by plane and hub.
        published: Largest distance from the published table.
        critical: Speed of divergence without foreshortening, by hub.
        apart: Largest relative difference from Exudyn's.
    """
    findings = [
        Finding(
            f"{plane}, {n} Legendre functions: largest relative error of three frequencies, η ≤ 12",
            max(float(e.max()) for (p, _), e in errors_of_n.items() if p == plane),
            BOUNDS[n],
            reason="twice what a Ritz solution in this basis gives",
        )
        for n, errors_of_n in worst.items()
        for plane in PLANES
    ]
    findings.append(
        Finding(
            "flap, 10 functions: largest distance from the published table",
            published,
            PRINTED,
            reason="its printed decimals",
        )
    )
    findings += [
        near(
            f"speed of divergence without foreshortening, hub ratio {delta:g}",
            speed,
            FIRST,
            1e-3,
            "the first frequency at rest, whatever the hub",
        )
        for delta, speed in critical.items()
    ]
    findings.append(
        Finding(
            "against Exudyn, 16 ANCF cables: largest relative difference of three frequencies",
            apart,
            5e-4,
            reason="its elements' error, 2.3e-4 at the highest speed",
        )
    )
    return findings


def errors(modes: int, table: list[dict[str, Any]]) -> dict[tuple[str, int], Array]:
    """Largest relative error of the first three frequencies for each plane and hub ratio, at speeds 0 to 12."""
    largest = {}
    for plane, (direction, column) in PLANES.items():
        m = spinning(direction, modes)
        for delta in (0, 1):
            rows = [row for row in table if row["delta"] == delta]
            computed = np.array([np.sqrt(spinning_squares(m, row["eta"], delta)[:3]) for row in rows])
            expected = np.array([row[column][:3] for row in rows])
            largest[plane, delta] = np.abs(computed / expected - 1.0).max(axis=1)
    return largest


def engine(etas: tuple[float, ...]) -> float:
    """Largest relative difference from Exudyn's frequencies, both planes, hub ratio 1."""
    models = [spinning(direction, 10) for direction, _ in PLANES.values()]
    worst = 0.0
    for eta in etas:
        for m, expected in zip(models, spinning_frequencies(1.0, 1e7, eta, 1.0), strict=True):
            frequencies = np.sqrt(spinning_squares(m, eta, 1.0)[:3])
            worst = max(worst, float(np.abs(frequencies / expected - 1.0).max()))
    return worst


def divergence(delta: float) -> float:
    """The speed at which lag without foreshortening has no stiffness left."""
    m = spinning("bend_y", 5, foreshortening=False, retain="all")
    return float(scipy.optimize.brentq(lambda eta: float(spinning_squares(m, eta, delta)[0]), 3.0, 4.0))


def growth(eta: float) -> float:
    """Growth rate of lag without foreshortening, over sqrt(EI/(rho A L^4)); NaN where lag is stable."""
    m = spinning("bend_y", 5, foreshortening=False, retain="all")
    squared = float(spinning_squares(m, eta, 0.0)[0])
    return float(np.sqrt(-squared)) if squared < 0.0 else np.nan


def _above_divergence() -> list[Finding]:
    """Findings on lag at speeds above the first frequency: η up to 8, hub radii up to twice the length."""
    places = [(eta, delta) for eta in (4.0, 6.0, 8.0) for delta in (0.0, 0.5, 1.0, 2.0)]
    stiff, ruthless = spinning("bend_y", 5), spinning("bend_y", 5, retain="zeroth_order")
    least = min(float(spinning_squares(stiff, *place)[0]) for place in places)
    moved = max(abs(float(spinning_squares(ruthless, *place)[0]) / FIRST**2 - 1.0) for place in places)
    return [
        *(
            near(f"without foreshortening: rate of growth at η = {eta:g}", growth(eta), known, 1e-3, "√(η² − 3.516²)")
            for eta, known in ((eta, float(np.sqrt(eta**2 - FIRST**2))) for eta in (4.0, 6.0))
        ),
        Finding(
            "foreshortened, η up to 8: least square of the first frequency over that at rest",
            least / FIRST**2,
            np.inf,
            1.0,
            "it stiffens",
        ),
        Finding(
            "zeroth order, η up to 8: relative change of the square",
            moved,
            1e-3,
            reason="it neither stiffens nor softens",
        ),
    ]


def frequencies(etas: Array, table: list[dict[str, Any]]) -> Figure:
    """The first frequency against speed, two planes."""
    charts = []
    for plane, (direction, column) in PLANES.items():
        curves = []
        for delta in (0, 1):
            rows = [row for row in table if row["delta"] == delta]
            curves.append(Curve(f"foreshortened, r/L = {delta}", etas, first(direction, etas, delta), delta))
            exact = np.array([row[column][0] for row in rows])
            curves.append(Curve(f"table, r/L = {delta}", [row["eta"] for row in rows], exact, delta, "points"))
        without = first(direction, etas, 0.0, foreshortening=False, retain="all")
        curves.append(Curve("without foreshortening", etas, without, 4, "dashed"))
        marks = (Mark("diverges", FIRST, "x"),) if plane == "lag" else ()
        charts.append(Chart(f"{plane}, first frequency", SPEED, FREQUENCY, tuple(curves), marks))
    return Figure(
        "The curves of the foreshortened beam run through the points of the tables in both planes; the dashed curve "
        "without foreshortening stays flat in flap and falls to zero in lag, where the model diverges.",
        tuple(charts),
    )


def first(direction: str, etas: Array, delta: float, **changed: object) -> Array:
    """The first frequency against speed; NaN where the beam diverges."""
    m = spinning(direction, 8, **changed)
    squared = np.array([spinning_squares(m, float(eta), delta)[0] for eta in etas])
    return np.sqrt(np.where(squared >= 0.0, squared, np.nan))


def accuracy(worst: dict[int, dict[tuple[str, int], Array]]) -> Figure:
    """The errors behind the points."""
    curves = tuple(
        Curve(f"{plane}, r/L = {delta}, {n} functions", np.arange(13.0), np.maximum(error, 1e-16), color, kind)
        for n, kind in LINES.items()
        for color, ((plane, delta), error) in enumerate(worst[n].items())
    )
    marks = tuple(Mark(f"bound with {n} functions", bound) for n, bound in BOUNDS.items())
    chart = Chart(
        "largest relative error of the first three frequencies", SPEED, "relative error  [1]", curves, marks, log="y"
    )
    return Figure(
        "Errors grow with speed, because a fast beam bends in ever shorter waves near the root; two more functions "
        "gain one and a half decades, and everything stays below its bound.",
        (chart,),
    )
