"""How fast each family's frequencies converge with the number of functions."""

from __future__ import annotations

import numpy as np

from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Kind
from ...reporting.findings import Finding, Study, exponent
from ..beams import spinning, spinning_squares
from ..reference import data, source

ETA, DELTA = 12, 1
# Family -> most functions it is asked for; monomials are refused beyond seven.
COUNTS = {"legendre": 14, "polynomial": 7, "spline": 20, "clamped_free": 20, "hermite": 2}
# Below this, rounding and the table's own digits are all that is seen.
FLOOR = 1e-11
COLORS = {"legendre": 0, "polynomial": 2, "spline": 1, "clamped_free": 5, "hermite": 4}
KINDS: dict[str, Kind] = {"hermite": "points"}


def study(quick: bool) -> Study:
    """Measure convergence rates of a spinning beam's first frequency in the number of functions of each family."""
    table = data("spinning_cantilever")["table"]
    exact = next(np.array(row["flap"]) for row in table if (row["delta"], row["eta"]) == (DELTA, ETA))
    errors = {family: relative(family, counts(family, quick), exact) for family in COUNTS}
    powers = {}
    for family in ("spline", "clamped_free"):
        n, error = errors[family]
        late = n >= 6
        powers[family] = exponent(n[late] + (1.0 if family == "spline" else 0.0), error[late, 0])
    n, error = errors["legendre"]
    falling = (n >= 4) & (error[:, 0] > FLOOR)
    gain = -float(np.polyfit(n[falling], np.log10(error[falling, 0]), 1)[0])
    shared = max(
        abs(errors["polynomial"][1][k, 0] - errors["legendre"][1][list(n).index(m), 0])
        for k, m in enumerate(errors["polynomial"][0])
        if m in n
    )
    findings = (
        Finding(
            "cubic splines: exponent in the number of spans, first frequency",
            powers["spline"],
            6.0,
            3.5,
            "h^4 for eigenvalues by cubic splines; seen before the limit is reached it may be steeper",
        ),
        Finding(
            "cantilever modes: exponent in their number, first frequency",
            powers["clamped_free"],
            5.0,
            3.0,
            "the modes' bending moment has no slope at the root under a centrifugal load",
        ),
        Finding(
            "Legendre: decades an added function gains, first frequency", gain, 2.0, 0.6, "exponential convergence"
        ),
        Finding(
            "polynomial against Legendre: largest difference of the errors",
            float(shared),
            1e-9,
            reason="they span the same space",
        ),
    )
    answer = (
        f"A spinning beam's first frequency at η = {ETA}, r/L = {DELTA} converges as n^-{powers['clamped_free']:.1f} "
        f"in cantilever modes, as n^-{powers['spline']:.1f} in cubic splines, and exponentially in polynomials: each "
        f"further one gains {gain:.1f} decades. Cantilever modes are a good start and a poor finish: they satisfy "
        "boundary conditions at the root that the spinning beam does not have."
    )
    return Study(
        "How many functions, and which?", answer, (figure(errors),), findings, (source("spinning_cantilever"),)
    )


def counts(family: str, quick: bool) -> list[int]:
    """Numbers of functions that are tried."""
    if family == "hermite":
        return [2]
    most = min(COUNTS[family], 10) if quick else COUNTS[family]
    return [n for n in range(1, most + 1) if n <= (4 if quick else 12) or n % 2 == 0]


def relative(family: str, tried: list[int], exact: Array) -> tuple[Array, Array]:
    """The numbers of functions (k) and relative errors of frequencies 1 and 3 (k, 2); NaN where there are too few."""
    errors = np.full((len(tried), 2), np.nan)
    for i, n in enumerate(tried):
        frequencies = np.sqrt(spinning_squares(spinning("bend_z", n, family=family), ETA, DELTA))
        for column, mode in enumerate((0, 2)):
            if n > mode:
                errors[i, column] = abs(frequencies[mode] / exact[mode] - 1.0)
    return np.array(tried, dtype=float), errors


def figure(errors: dict[str, tuple[Array, Array]]) -> Figure:
    """Two frequencies."""
    charts = []
    for column, mode in enumerate((1, 3)):
        drawn = tuple(
            Curve(family, n, np.maximum(error[:, column], 1e-15), COLORS[family], KINDS.get(family, "joined"))
            for family, (n, error) in errors.items()
            if np.isfinite(error[:, column]).any()
        )
        title = f"flap frequency {mode}, η = {ETA}, r/L = {DELTA}"
        charts.append(Chart(title, "number of functions  [1]", "relative error  [1]", drawn, log="y"))
    return Figure(
        "The polynomials fall ever faster, which is exponential convergence; splines and cantilever modes bend over "
        "to a power law. The families legendre, polynomial and hermite span the same space and lie on the same curve.",
        tuple(charts),
    )
