"""The error that a beam states of itself, against exact rods: the elastica by collocation, Exudyn's beams."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_bvp

import symofros as sf

from ...adapters.exudyn.ancf import Strip, static_tip, swing
from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Kind, Mark
from ...reporting.findings import Finding, Study
from ..beams import cantilever, interpreted
from .elastica import FUNCTIONS, STRETCH
from .princeton import STEPS, rod_tips, strip_model

# Errors between which the estimate is asked to be right, and within which factor.
SMALLEST, LARGEST, FACTOR = 0.01, 0.5, 2.0
LIMITS = (Mark("limit", LARGEST), Mark("note", SMALLEST))
CRITICAL = np.pi**2 / 4.0
# Compressive loads over the critical one, each with transverse loads beside it.
COLUMNS = (-2.0, 0.5, 0.75, 0.9, 0.95)
PAST = (1.02, 1.05, 1.2)
# At the turning point of a sudden swing inertia carries half of the load: the error is half of that at rest, (26b) of
# docs/theory/beams.md; a tenth beside it as at rest.
FACTOR_IN_MOTION = 2.2
# End of a swing, past its first peak, in units of sqrt(rhoA L^4/EI).
SWING = 0.9
# Directions of the load on the strip, from the stiff way to the soft [degrees].
ANGLES = (30.0, 60.0, 80.0)


class Loads(NamedTuple):
    """Loads on a cantilever of length and stiffness one.

    Attributes:
        P: Compressive force at the tip.
        F: Transverse force at the tip.
        w: Transverse force a length.
    """

    P: float = 0.0
    F: float = 0.0
    w: float = 0.0


class Judged(NamedTuple):
    """One beam at rest.

    Attributes:
        slope: Largest slope [rad].
        estimate: Error that it states.
        error: Distance of its tip from the exact one, over the exact displacement.
    """

    slope: float
    estimate: float
    error: float


def elastica_tip(loads: Loads) -> Array:
    """Position of the exact tip (2,): theta'' = -(N_y cos theta - N_x sin theta), clamped and free, by collocation."""

    def rate(s: Array, y: Array) -> Array:
        force = loads.F + loads.w * (1.0 - s)
        turned = -loads.P * np.sin(y[0]) - force * np.cos(y[0])
        return np.vstack([y[1], turned, np.cos(y[0]), np.sin(y[0])])

    def ends(root: Array, tip: Array) -> Array:
        return np.array([root[0], tip[1], root[2], root[3]])

    s = np.linspace(0.0, 1.0, 41)
    solution = solve_bvp(rate, ends, s, np.zeros((4, len(s))), tol=1e-9, max_nodes=20000)
    if not solution.success:
        raise ArithmeticError(f"the elastica under {loads} was not found: {solution.message}")
    tip: Array = solution.y[2:, -1]
    return tip


def beam() -> sf.Model:
    """Our cantilever under such loads."""
    at_tip = sf.BeamLoad((sf.formula("-P", "load"), sf.formula("F", "load"), 0.0), at=1.0, axes="world")
    spread = sf.BeamLoad((0.0, sf.formula("w", "load"), 0.0), axes="world")
    stated = cantilever(bend_y=5, loads=(at_tip, spread), retain="all")
    return interpreted(stated, functions=FUNCTIONS, parameters=list(Loads._fields))


def moving_beam() -> sf.Model:
    """The same, compiled to be simulated; the swing's slopes lie in its first modes."""
    tip = sf.BeamLoad((0.0, sf.formula("F", "load"), 0.0), at=1.0, axes="world")
    spread = sf.BeamLoad((0.0, sf.formula("w", "load"), 0.0), axes="world")
    stated = cantilever(bend_y=3, loads=(tip, spread))
    return sf.compile(
        sf.System("s", (stated,), gravity=(0, 0, 0), parameters=(sf.Parameter("F", 0.0), sf.Parameter("w", 0.0)))
    )


def judged(m: sf.Model, loads: Loads) -> Judged:
    """Our beam against the elastica."""
    m = m.with_parameters(**loads._asdict())
    rest = sf.equilibrium(m, beam_limit=np.inf)
    p, _ = m.frame_pose("tip", rest.q)
    return _compared(rest, p[:2] - (1.0, 0.0), elastica_tip(loads) - (1.0, 0.0))


def strip_judged(m: sf.Model, load: float, degrees: float) -> Judged | None:
    """Our strip against Exudyn's geometrically exact beam; None where it has no rest."""
    angle = np.radians(degrees)
    q = m.neutral()
    try:
        for share in STEPS:
            loaded = m.with_parameters(Fy=share * load * np.cos(angle), Fz=share * load * np.sin(angle))
            rest = sf.equilibrium(loaded, q, iterations=20, beam_limit=np.inf)
            q = rest.q
    except sf.EquilibriumError:
        return None
    p, _ = loaded.frame_pose("tip", q)
    exact, _ = rod_tips(load, np.array([angle]))
    return _compared(rest, p - (Strip().length, 0.0, 0.0), exact[0])


def _compared(rest: sf.Equilibrium, moved: Array, exact: Array) -> Judged:
    (bending,) = rest.bendings
    return Judged(bending.slope, bending.error, float(np.linalg.norm(moved - exact) / np.linalg.norm(exact)))


def swung(m: sf.Model, force: float, weight: float) -> Judged:
    """Our beam's first swing from rest under sudden loads, against Exudyn's cables; over the largest displacement."""
    t, exact = swing(force, weight, SWING)
    loaded = m.with_parameters(F=force, w=weight)
    run = sf.simulate(loaded, t_end=float(t[-1]), dt=1e-3, output=t, beam_limit=np.inf)
    p, _ = run.frames["tip"]
    (bending,) = run.bendings
    apart = np.linalg.norm(p[:, :2] - (1.0, 0.0) - exact, axis=1).max()
    return Judged(bending.slope, bending.error, float(apart / np.linalg.norm(exact, axis=1).max()))


def refused(m: sf.Model, loads: Loads) -> bool:
    """Whether the beam says that it has no rest there."""
    try:
        sf.equilibrium(m.with_parameters(**loads._asdict()))
    except sf.BeamTheoryError:
        return True
    return False


def families(m: sf.Model, count: int) -> dict[str, list[Judged]]:
    """Beams under growing loads of each kind."""
    kinds: dict[str, tuple[Callable[[float], Loads], tuple[float, float]]] = {
        "force at the tip": (lambda F: Loads(F=F), (0.1, 2.8)),
        "weight": (lambda w: Loads(w=w), (0.3, 8.0)),
    }
    for share in COLUMNS:
        name = f"{'tension' if share < 0 else 'column'}, P = {share:g} of the critical load"

        def column(F: float, P: float = share * CRITICAL) -> Loads:
            return Loads(P=P, F=F)

        # The slope grows as 1/(1 - share).
        kinds[name] = column, (0.12 * (1.0 - share), 3.0 * (1.0 - share) ** 1.3)
    return {
        name: [judged(m, load(float(size))) for size in np.geomspace(*span, count)]
        for name, (load, span) in kinds.items()
    }


def worst_factor(points: Sequence[Judged]) -> float:
    """The largest factor between estimate and error where either is between SMALLEST and LARGEST."""
    factors = [
        max(one.estimate / one.error, one.error / one.estimate)
        for one in points
        if SMALLEST <= one.error <= LARGEST or SMALLEST <= one.estimate <= LARGEST
    ]
    return max(factors)


def study(quick: bool) -> Study:
    """Compare the stated error of beams with their error against exact rods, at rest and in swings."""
    m, strip = beam(), strip_model("all")
    points = families(m, 6 if quick else 16)
    forces = np.geomspace(1.5, 11.0, 4 if quick else 12)
    for degrees in ANGLES[1:2] if quick else ANGLES:
        tried = [strip_judged(strip, float(force), degrees) for force in forces]
        points[f"Princeton strip, load at {degrees:g}°"] = [one for one in tried if one is not None]
    moving, sizes = moving_beam(), np.geomspace(0.16, 1.2, 3 if quick else 8)
    swings = {
        "swing under a force at the tip": [swung(moving, float(size), 0.0) for size in sizes],
        "swing under weight": [swung(moving, 0.0, 2.6 * float(size)) for size in sizes],
    }
    bound = "(24) to (26) of docs/theory/beams.md: the leading term and a calibrated end"
    name = f"largest factor between estimate and error, errors from {SMALLEST:.0%} to {LARGEST:.0%}"
    findings = [Finding(f"{kind}: {name}", worst_factor(some), FACTOR, reason=bound) for kind, some in points.items()]
    reason = "the estimate of a state at rest; inertia carries a part of the load"
    findings += [
        Finding(f"{kind}: {name}", worst_factor(some), FACTOR_IN_MOTION, reason=reason) for kind, some in swings.items()
    ]
    past = [refused(m, Loads(P=share * CRITICAL, F=F)) for share in PAST for F in (1e-3, 1e-2, 0.1)]
    findings.append(
        Finding("columns past their critical load that are not refused", float(past.count(False)), 0.0, 0.0)
    )
    mixed = [Loads(F=1.0), Loads(F=2.0), Loads(P=0.5 * CRITICAL, F=0.3), Loads(P=0.9 * CRITICAL, F=0.1)]
    cable = max(
        float(np.linalg.norm(static_tip(1.0, 1.0, STRETCH, (-some.P, some.F)) - elastica_tip(some))) for some in mixed
    )
    findings.append(
        Finding(
            "Exudyn, 16 ANCF cables: largest distance from the elastica over L", cable, 1e-3, reason="two exact rods"
        )
    )
    plain = max(worst_factor(points[kind]) for kind in ("force at the tip", "weight"))
    answer = (
        f"Under transverse loads the estimate is right to {plain - 1:.0%} from {SMALLEST:.0%} to {LARGEST:.0%}, from "
        f"the largest slope alone; under axial loads and in the twisted strip within a factor of "
        f"{max(worst_factor(some) for some in points.values()):.1f}; in a sudden swing, to the safe side, within "
        f"{max(worst_factor(some) for some in swings.values()):.1f}. Columns past their critical load, whose "
        f"second-order equilibria lie on the wrong side, are refused."
    )
    return Study(
        "What does the estimate of a beam's error say?",
        answer,
        (calibration(points | swings), amplification(points)),
        tuple(findings),
        ("the elastica by collocation; Exudyn, 16 ANCF cables and 32 geometrically exact elements",),
    )


def calibration(points: dict[str, list[Judged]]) -> Figure:
    """Estimate against error."""
    line = np.geomspace(1e-3, 2.0, 20)
    bounds = (
        Curve("exact", line, line, 11),
        Curve("factor of two", line, 2 * line, 10, "dotted"),
        Curve("factor of two, low", line, line / 2, 10, "dotted"),
    )
    drawn, marks = (*bounds, *_kinds(points, "error", "estimate", "points")), LIMITS
    title, x = "what the beam states against what it errs by", "error of the tip over its displacement  [1]"
    return Figure(
        "Points on the middle line are estimated exactly; the dotted lines are a factor of two away. From the note at "
        "1 % to the limit at 50 % all at rest lie between them; swings lie above the line, on the safe side.",
        (Chart(title, x, "estimated error  [1]", drawn, marks, log="xy", range_y=(1e-3, 2.0)),),
    )


def amplification(points: dict[str, list[Judged]]) -> Figure:
    """Error against slope."""
    drawn, marks = _kinds(points, "slope", "error", "joined"), LIMITS
    y = "error of the tip over its displacement  [1]"
    return Figure(
        "Without axial loads all beams lie on one curve of slope two, whatever bends them: the largest slope tells the "
        "error. Compression lifts the curve by (A + 3)/4, with A the elastic stiffness over what the load leaves "
        "of it.",
        (Chart("error against slope", "largest slope  [rad]", y, drawn, marks, log="xy"),),
    )


def _kinds(points: dict[str, list[Judged]], x: str, y: str, style: Kind) -> tuple[Curve, ...]:
    """A curve for each kind of load."""
    return tuple(
        Curve(kind, [getattr(one, x) for one in some], [getattr(one, y) for one in some], k % 10, style, k // 5)
        for k, (kind, some) in enumerate(points.items())
    )
