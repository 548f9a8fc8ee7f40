"""Redundant closures of a four-bar, fitting and misfitting."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

import symofros as sf

from ...references import MODELS
from ...reporting.findings import Finding
from ..reference import data, source
from ..study import (
    Cell,
    Grid,
    Maps,
    ParameterStudy,
    Subject,
    Verdict,
    cell,
    decades,
    refused,
    simulate,
)
from . import four_bars
from .four_bars import AXIS, BAR, END_OF_BAR

END = 0.5
BOUND = 1e-6
# Closures as they are often stated, and a crank too many; all but the first are redundant.
PIN, BALL, HINGE, CRANK = "2 rows: pin", "3 rows: ball", "5 rows: hinge", "a third crank"
IN_PLANE, ALL = ("x", "z"), ("x", "y", "z")
ROWS = {PIN: (IN_PLANE, ()), BALL: (ALL, ()), HINGE: (ALL, IN_PLANE), CRANK: (IN_PLANE, ())}
RANKS = {PIN: (2, 2), BALL: (3, 2), HINGE: (5, 2), CRANK: (4, 3)}
KIND = Grid.of("how the loop is closed [-]", tuple(ROWS))
MISFIT = Grid("misfit d [m]", decades(1e-16, 1e-2, 1), (1e-16, 1e-13, 1e-9, 1e-4))


@cache
def linkage(kind: str) -> sf.Model:
    """One four-bar; d offsets the rocker's pivot along the hinge axis, or lengthens the third crank."""
    translations, rotations = ROWS[kind]
    d = sf.formula("d", "misfit")
    pivot = (1.0, 0.0 if kind == CRANK else d, 0.0)
    rocker = sf.RigidBody("rocker", sf.Joint("a1", "revolute", position=pivot, axis=AXIS), BAR, END_OF_BAR)
    middle = sf.Frame("middle", (0.5, 0, 0))
    coupler = sf.RigidBody(
        "coupler", sf.Joint("b1", "revolute", "crank0", "end", axis=AXIS), BAR, (*END_OF_BAR, middle)
    )
    bodies = [four_bars.crank(0), coupler, rocker]
    closures = [sf.Closure("loop", ("rocker", "end"), ("coupler", "end"), translations, rotations)]  # type: ignore[arg-type]
    if kind == CRANK:
        end = (sf.Frame("end", (sf.formula("1 + d", "length"), 0, 0)),)
        bodies.append(sf.RigidBody("third", sf.Joint("a2", "revolute", position=(0.5, 0, 0), axis=AXIS), BAR, end))
        closures.append(sf.Closure("more", ("third", "end"), ("coupler", "middle"), ("x", "z")))
    stated = sf.System("redundant", tuple(bodies), parameters=(sf.Parameter("d", 0.0),), constraints=tuple(closures))
    return sf.compile(stated)


def move(kind: str, misfit: float, stabilisation: str) -> sf.Trajectory:
    """Assembled from upright with the first crank held, then half a second of fall."""
    m = linkage(kind).with_parameters(d=misfit)
    q, v = four_bars.state(m, *four_bars.START)
    start = sf.assemble(m, q, v, held=("a0",))
    return simulate(m, start.q, start.v, END, dt=1e-3, stabilisation=stabilisation)


def off(run: sf.Trajectory) -> float:
    """Angle of the first crank from that of a mechanism that closes as `PIN` does [rad]."""
    return float(abs(run["a0"][-1] - exact(run.model.nv == 4)))


@cache
def exact(third: bool) -> float:
    """Where the first crank should be: all cranks turn alike, the coupler moves along with their ends."""
    if not third:
        return float(four_bars.exact(1, (0.0, END))[0, -1])
    alone = simulate(
        linkage(CRANK), *four_bars.state(linkage(CRANK), *four_bars.START), END, method="dop853", rtol=1e-12, atol=1e-12
    )
    return float(alone["a0"][-1])


def measure(stabilisation: str) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of the map, by misfit and kind."""

    def run(misfit: float, kind: float) -> Cell:
        try:
            return cell(move(KIND.label(kind), misfit, stabilisation), off)
        except sf.AssemblyError as error:
            return refused(error)

    return run


def judge(maps: Maps) -> Verdict:
    """Ranks, accelerations, and where misfits are refused."""
    wrong_ranks, spread, apart = _at_one_state()
    projected = maps["projection"]
    silent = sum(runs.wrong for runs in maps.values())
    rows_good = {kind: projected.good[k] for k, kind in enumerate(ROWS)}
    refusals = {
        kind: [x for x, c in zip(projected.x, projected.cells[k], strict=True) if c.ended == "refused"]
        for k, kind in enumerate(ROWS)
    }
    first = {kind: min(sizes, default=np.inf) for kind, sizes in refusals.items()}
    findings = (
        Finding("kinds of closure whose number of rows and rank are not as they should be", float(wrong_ranks), 0.0),
        Finding(
            "accelerations with redundant rows against those without [rad/s²]",
            spread,
            1e-10,
            reason="multipliers of least norm move nothing",
        ),
        Finding(
            "Bricard's mechanism, 5 rows of rank 4: accelerations against the known ones [rad/s²]",
            apart,
            1e-10,
            reason="least norm, computed independently",
        ),
        Finding(
            "two rows: share of the map that is good", float(rows_good[PIN].mean()), 1.0, 1.0, "an offset is harmless"
        ),
        Finding(
            "smallest misfit that is refused [m]",
            min(first.values()),
            1e-6,
            1e-13,
            "above what the assembly may leave, 1e-12",
        ),
        Finding(
            "runs that come to their end and are wrong", float(silent), 0.0, reason="a misfit is refused or reported"
        ),
    )
    statement = (
        "Rows that repeat others are found by their rank and cost nothing: with 3, 5 and 4 rows of rank 2, 2 and "
        f"3, accelerations differ from those of the pin by {spread:.0e} rad/s², and every run that fits is good. "
        f"Redundant rows must fit, though: an offset d is harmless with two rows, and from {first[BALL]:.0e} m "
        f"(ball), {first[HINGE]:.0e} m (hinge) and {first[CRANK]:.0e} m (third crank) on the mechanism is refused "
        f"at assembly, in words that name the closure. {silent} runs are silently wrong."
    )
    see = (
        "The top three rows turn from good to refused where the misfit passes what rounding excuses; the bottom row "
        "does not, because nothing in it is redundant."
    )
    return Verdict(statement, see, findings)


def _at_one_state() -> tuple[int, float, float]:
    """Kinds with wrong ranks; how far accelerations are apart with redundant rows, and from the known ones."""
    wrong_ranks, spread = 0, 0.0
    for kind, (rows, rank) in RANKS.items():
        m = linkage(kind)
        q, v = four_bars.state(m, 1.0, 0.5)
        assembled = sf.assemble(m, q, v)
        wrong_ranks += (m.nc, assembled.rank) != (rows, rank)
        if kind in (BALL, HINGE):
            a, b = (each.forward_dynamics(q, v, np.zeros(0)) for each in (m, linkage(PIN)))
            spread = max(spread, float(np.abs(a - b).max()))
    known = data("bricard")
    bricard = sf.compile(MODELS["bricard"])
    rest, still = bricard.neutral(), np.zeros(bricard.nv)
    wrong_ranks += (bricard.nc, sf.assemble(bricard, rest).rank) != (known["rows"], known["rank"])
    accelerations = bricard.forward_dynamics(rest, still, np.zeros(bricard.nu))
    apart = float(np.abs(accelerations - known["accelerations"]).max())
    return wrong_ranks, spread, apart


STUDY = ParameterStudy(
    "What do redundant closures do, and what if they do not quite fit?",
    f"A four-bar closed by a pin, a ball, a hinge, or with a crank too many, assembled and let fall for {END} s; a "
    "misfit d offsets a pivot along the axis, or lengthens the third crank.",
    MISFIT,
    KIND,
    "angle of the first crank from the exact one [rad]",
    BOUND,
    tuple(Subject(kind, measure(kind)) for kind in ("projection", "baumgarte")),
    judge,
    "state as few directions as the loop needs; where rows repeat each other, make their dimensions one and the same "
    "parameter. `sf.assemble` gives the rank, `model.nc` the number of rows.",
    ("rank of a planar loop's closures: 2 of 3, 2 of 5", source("bricard")),
)
