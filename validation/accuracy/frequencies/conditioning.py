"""Conditioning of the modal mass matrix of each family, and the digits that it costs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Figure, Mark, curves
from ...reporting.findings import Finding, Study, near
from ..beams import FIRST, cantilever, interpreted, squares, stiffness_and_mass
from ..reference import data, source

COLORS = {"polynomial": 2, "spline": 1, "legendre": 0, "clamped_free": 5}


def study(quick: bool) -> Study:
    """Measure condition numbers of M and errors of the first frequency by family and number of functions."""
    counts = np.arange(1.0, 9.0 if quick else 17.0)
    numbers = {family: np.full(len(counts), np.nan) for family in COLORS}
    errors = {family: np.full(len(counts), np.nan) for family in COLORS}
    trips = {family: np.full(len(counts), np.nan) for family in COLORS}
    refused = 0
    for family in COLORS:
        for i, n in enumerate(range(1, len(counts) + 1)):
            try:
                m = interpreted(cantilever(bend_z=n, family=family))
            except sf.DescriptionError:
                refused = n
                break
            K, M = stiffness_and_mass(m)
            numbers[family][i] = np.linalg.cond(M)
            trips[family][i] = round_trip(M)
            errors[family][i] = abs(np.sqrt(squares(K, M)[0]) / FIRST - 1.0)
    findings = [*_findings(numbers, errors, refused), *_kept(trips, errors)]
    answer = (
        f"Monomials lose a digit and a half with every further one: {numbers['polynomial'][3]:.0e} with four, "
        f"{numbers['polynomial'][6]:.0e} with seven, where accelerations turned into forces and back err by "
        f"{trips['polynomial'][6]:.0e}, and are refused with {refused}, in words that name another family. "
        f"Splines stay at {numbers['spline'][-1]:.0f}, legendre grows as (2n + 3)/5 and is diagonal, "
        "cantilever modes have the identity."
    )
    return Study(
        "How many functions before the digits go?",
        answer,
        (figure(counts, numbers, errors),),
        tuple(findings),
        (source("conditioning"),),
    )


def _findings(numbers: Mapping[str, Array], errors: Mapping[str, Array], refused: int) -> list[Finding]:
    """Findings on condition numbers, errors of the first frequency, and the number of functions refused."""
    rows = data("conditioning")["rows"]
    findings = [
        near(
            f"{family}: condition number with {n} functions",
            float(numbers[family][n - 1]),
            rows[n - 1][family],
            tolerance,
            "computed independently",
        )
        for family, n, tolerance in (
            ("polynomial", 4, 1e-6),
            ("polynomial", 7, 1e-3),
            ("spline", 8, 1e-6),
            ("clamped_free", 8, 1e-6),
        )
    ]
    findings += [
        Finding(
            "polynomial: the number of functions that is refused",
            float(refused),
            8.0,
            8.0,
            "condition 2e12: four digits are left",
        ),
        near(
            "legendre: condition number with 8 functions",
            float(numbers["legendre"][7]),
            19 / 5,
            1e-9,
            "diagonal 1/(2k + 5), tip value one",
        ),
        Finding(
            "clamped_free: first frequency at rest, relative error",
            float(np.nanmax(errors["clamped_free"])),
            1e-8,
            reason="its functions are the modes",
        ),
    ]
    return findings


def round_trip(M: Array) -> float:
    """Largest error of unit accelerations that are turned into forces by M and back by a solve."""
    a = np.ones(len(M))
    return float(np.abs(np.linalg.solve(M, M @ a) - a).max())


def _kept(trips: Mapping[str, Array], errors: Mapping[str, Array]) -> list[Finding]:
    """Findings on round-trip errors of all families but monomials, and on the least frequency error of legendre."""
    others = max(float(np.nanmax(trip)) for family, trip in trips.items() if family != "polynomial")
    best = float(np.nanmin(errors["legendre"]))
    return [
        Finding("other families: largest error of the round trip", others, 1e-11, reason="condition below 1e3"),
        Finding("legendre: smallest error of the first frequency", best, 1e-10, reason="it converges until rounding"),
    ]


def figure(counts: Array, numbers: dict[str, Array], errors: dict[str, Array]) -> Figure:
    """Figure of condition numbers and of errors of the first frequency against the number of functions."""
    x, refused = "number of functions  [1]", (Mark("refused", 1e12),)
    condition, first = (
        curves(counts, {family: np.maximum(y, 1e-17) for family, y in drawn.items()}, "joined", COLORS)
        for drawn in (numbers, errors)
    )
    return Figure(
        "Left: only monomials climb, and stop short of the red line, where they are refused; the other families can "
        "have any number of functions. Right: the first frequency falls to rounding with polynomials and stays there; "
        "cantilever modes are exact at rest, splines converge with the fourth power.",
        (
            Chart("condition number of M", x, "condition number  [1]", condition, refused, log="y"),
            Chart("first frequency at rest", x, "relative error  [1]", first, log="y"),
        ),
    )
