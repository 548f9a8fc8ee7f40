"""How many functions a tolerance needs at a speed, in cantilever modes and in polynomials."""

from __future__ import annotations

import numpy as np

from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Kind, curves
from ...reporting.findings import Finding, Study
from ..beams import spinning, spinning_squares
from ..reference import data, source

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)
KINDS: dict[str, Kind] = {"clamped_free": "joined", "legendre": "dashed"}
# Errors that are compared with known ones are larger than the exact values' own digits allow.
SMALLEST = 1e-6
MARGIN = 1.05
MOST = 14


def study(quick: bool) -> Study:
    """Determine how many functions keep the first flap frequency within a tolerance, against the speed."""
    rows = data("modes_needed")["rows"]
    table = {(row["delta"], row["eta"]): np.array(row["flap"]) for row in data("spinning_cantilever")["table"]}
    worst = {n: 0.0 for n in ((1, 3) if quick else (1, 2, 3, 4, 5, 8))}
    for n in worst:
        m = spinning("bend_z", n, family="clamped_free")
        for row in rows:
            if (row["delta"], row["eta"]) in table:
                exact = table[row["delta"], row["eta"]][: min(n, 3)]
                error = np.sqrt(spinning_squares(m, row["eta"], row["delta"])[:3]) / exact - 1.0
                known = np.array(row[f"n{n}"])
                seen = known > SMALLEST
                worst[n] = max(worst[n], float(np.max(error[seen] / known[seen], initial=0.0)))
    etas = np.arange(1.0, 13.0, 3.0 if quick else 1.0)
    exact = np.array([table[0, eta][0] for eta in etas.tolist()])
    tried = range(1, 7 if quick else MOST + 1)
    errors = {family: np.array([first(n, family, etas, exact) for n in tried]) for family in KINDS}
    needed = {(family, tolerance): least(errors[family], tolerance) for family in KINDS for tolerance in TOLERANCES}
    findings = tuple(
        Finding(
            f"cantilever modes, {n}: largest error over the known one, three frequencies, η ≤ 12",
            ratio,
            MARGIN,
            reason="a Ritz solution computed independently; 5 % for its digits",
        )
        for n, ratio in worst.items()
    )
    fast = len(etas) - 1
    answer = (
        f"At η = {etas[fast]:g}, r/L = 0 the first flap frequency needs "
        + ", ".join(
            f"{at_least(needed['clamped_free', t][fast], len(tried))} cantilever modes or "
            f"{at_least(needed['legendre', t][fast], len(tried))} polynomials for {100 * t:g} %"
            for t in TOLERANCES
        )
        + ". Cantilever modes serve slow beams and coarse tolerances; polynomials win otherwise."
    )
    return Study(
        "How many functions does a tolerance need?",
        answer,
        (figure(etas, needed, errors),),
        findings,
        (source("modes_needed"),),
    )


def first(functions: int, family: str, etas: Array, exact: Array) -> Array:
    """Relative error of the first flap frequency at each speed, hub ratio 0."""
    m = spinning("bend_z", functions, family=family)
    frequencies = np.array([np.sqrt(spinning_squares(m, float(eta), 0.0)[0]) for eta in etas])
    return np.asarray(np.abs(frequencies / exact - 1.0))


def least(errors: Array, tolerance: float) -> Array:
    """The least number of functions within the tolerance at each speed; NaN if none of those tried is."""
    within = errors <= tolerance
    return np.where(within.any(axis=0), within.argmax(axis=0) + 1.0, np.nan)


def at_least(count: float, most: int) -> str:
    """A number of functions, or that it is more than were tried."""
    return f"{count:.0f}" if np.isfinite(count) else f"more than {most}"


def figure(etas: Array, needed: dict[tuple[str, float], Array], errors: dict[str, Array]) -> Figure:
    """Errors, and what they mean for the choice."""
    x, title = "speed η = Ω √(ρA L⁴/EI)  [1]", "cantilever modes, first flap frequency, r/L = 0"
    modes = [n for n in (1, 2, 3, 5) if n <= len(errors["clamped_free"])]
    worth = curves(etas, {f"{n} mode{'s' * (n > 1)}": errors["clamped_free"][n - 1] for n in modes})
    choice = tuple(
        Curve(f"{family}, {100 * tolerance:g} %", etas, needed[family, tolerance], color, kind)
        for family, kind in KINDS.items()
        for color, tolerance in enumerate(TOLERANCES)
    )
    return Figure(
        "Left, what a number of cantilever modes is worth: the error climbs with the speed, and each mode lowers it by "
        "less than the one before. Right, the number needed for a tolerance; dashed are polynomials, which need "
        "fewer as soon as the tolerance is fine. A curve ends where none of those tried is enough.",
        (
            Chart(title, x, "relative error  [1]", worth, log="y"),
            Chart("functions needed", x, "number of functions  [1]", choice),
        ),
    )
