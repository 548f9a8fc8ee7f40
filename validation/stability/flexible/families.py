"""How many shape functions a family can bear: digits of a motion, by family and number."""

from __future__ import annotations

from functools import cache

import numpy as np

import symofros as sf

from ...accuracy.reference import data, source
from ...reporting.findings import Finding
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, refused

BOUND = 1e-6
FAMILIES = ("polynomial", "legendre", "spline", "clamped_free")
COUNT = Grid("shape functions [-]", tuple(float(n) for n in range(1, 15)), (1.0, 4.0, 7.0, 8.0), log=False)
FAMILY = Grid.of("family [-]", FAMILIES)
EXACT = "first frequency against the exact one"
KEPT = "round trip: forward after inverse dynamics"


@cache
def beam(family: str, count: int) -> sf.Model:
    """A cantilever with length, mass and stiffness one; evaluated once only, so not worth compiling."""
    stated = sf.Beam("b", sf.Joint("clamp", "fixed"), 1.0, 1.0, EI_z=1.0, bend_y=count, family=family)  # type: ignore[arg-type]
    functions = ("mass_matrix", "inverse_dynamics", "forward_dynamics", "inverse_dynamics_derivatives")
    return sf.compile(
        sf.System("cantilever", (stated,), gravity=(0, 0, 0)), sf.Options(functions, backend="interpreter")
    )


def frequency(m: sf.Model) -> float:
    """Relative error of the first frequency, from M and K as they are."""
    zero = np.zeros(m.nv)
    K, _ = m.inverse_dynamics_derivatives(zero, zero, zero)
    squares = np.linalg.eigvals(np.linalg.solve(m.mass_matrix(zero), (K + K.T) / 2))
    lowest = np.sqrt(np.abs(squares.real).min())
    return float(abs(lowest / 3.5160152685001513 - 1.0))


def trip(m: sf.Model) -> float:
    """Relative error of accelerations that are turned into forces and back."""
    zero, a = np.zeros(m.nv), np.ones(m.nv)
    M = m.mass_matrix(zero)
    back = np.linalg.solve(M, M @ a)
    return float(np.abs(back - a).max())


def measure(kind: str, count: float, family: float) -> Cell:
    """One family with so many functions."""
    try:
        m = beam(FAMILY.label(family), int(count))
    except sf.DescriptionError as error:
        return refused(error)
    return Cell(frequency(m) if kind == EXACT else trip(m))


def judge(maps: Maps) -> Verdict:
    """Digits lost, and where a family is refused."""
    kept, exact = maps[KEPT], maps[EXACT]
    rows = dict(zip(FAMILIES, kept.cells, strict=True))
    monomials = [c for c in rows["polynomial"] if c.ended != "refused"]
    turned_away = [float(n) for n, c in zip(kept.x, rows["polynomial"], strict=True) if c.ended == "refused"]
    first = min(turned_away, default=np.nan)
    said = next((c.note for c in rows["polynomial"] if c.ended == "refused"), "")
    known = {row_n + 1: row for row_n, row in enumerate(data("conditioning")["rows"])}
    conditions = {n: float(np.linalg.cond(beam("polynomial", n).mass_matrix(np.zeros(n)))) for n in (2, 4)}
    apart = max(abs(condition / known[n]["polynomial"] - 1) for n, condition in conditions.items())
    others = max(float(np.nanmax(kept.values[k])) for k, family in enumerate(FAMILIES) if family != "polynomial")
    best = float(np.nanmin(exact.values[FAMILIES.index("legendre")]))
    frequencies = exact.values[0][np.isfinite(exact.values[0])]
    losing = bool(len(frequencies) and frequencies[-1] > frequencies.min())
    findings = (
        Finding("polynomial: the number of functions that is refused", first, 8.0, 8.0, "condition 2e12"),
        Finding(
            "polynomial: condition of M against the known one, relative", apart, 1e-6, reason="known independently"
        ),
        Finding("other families: largest error of the round trip", others, 1e-11, reason="condition below 1e3"),
        Finding("legendre: smallest error of the first frequency", best, 1e-10, reason="it converges until rounding"),
    )
    statement = (
        f"Monomials lose a digit and a half with each function: the round trip errs by {monomials[-1].value:.0e} "
        f"with {int(first) - 1}, and {first:.0f} are refused: “{said}”. The other families keep {others:.0e} or "
        f"better with {int(kept.x[-1])}. In the first frequency legendre functions come down to {best:.0e}, "
        f"monomials to {frequencies.min():.0e}, and the last of them makes it {'worse' if losing else 'no worse'}."
    )
    see = (
        "Left, errors of the first frequency fall to the right until rounding takes over, which it does early with "
        "monomials; cantilever modes have it with one function. Right, only monomials get worse to the right, until "
        "they are refused."
    )
    return Verdict(statement, see, findings)


STUDY = ParameterStudy(
    "How many shape functions before digits are lost?",
    "A cantilever with each family of shape functions, at rest: its first frequency, and M a turned back into a.",
    COUNT,
    FAMILY,
    "relative error [-]",
    BOUND,
    tuple(Subject(kind, lambda count, family, kind=kind: measure(kind, count, family)) for kind in (EXACT, KEPT)),  # type: ignore[misc]
    judge,
    "legendre functions or splines in any number; clamped_free where the ends are a clamp and free. Monomials up to "
    "four.",
    (source("conditioning"),),
)
