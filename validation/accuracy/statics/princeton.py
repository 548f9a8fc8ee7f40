"""The Princeton beam: an aluminium strip bent both ways and twisted, against Exudyn's geometrically exact beam."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import symofros as sf

from ...adapters.exudyn.ancf import Strip, princeton
from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Kind, Mark, curves
from ...reporting.findings import Finding, Study, exponent

# Dowell & Traybar 1975: loads of one, two and three pounds.
LOADS = (4.448, 8.896, 13.345)
# Of the load, one equilibrium after another.
STEPS = (0.25, 0.5, 0.75, 1.0)
ORDERS = ("all", "first_order")
# Up to here a second-order theory is asked for five per cent, and up to a tenth of the length for one.
SMALL, MODERATE = 0.10, 0.21


def strip_model(retain: str) -> sf.Model:
    """Our strip, on edge along y, under a load on its tip with components "Fy" and "Fz" that keep their directions."""
    strip = Strip()
    load = sf.BeamLoad((0.0, sf.formula("Fy", "load"), sf.formula("Fz", "load")), at=1.0, axes="world")
    beam = sf.Beam(
        "b",
        sf.Joint("root", "fixed"),
        strip.length,
        0.1,
        EI_z=strip.EI_z,
        EI_y=strip.EI_y,
        GJ=strip.GJ,
        rhoJ=1e-6,
        bend_y=3,
        bend_z=3,
        twist=3,
        family="legendre",
        loads=(load,),
        retain=retain,  # type: ignore[arg-type]
    )
    stated = sf.System(
        "strip", (beam,), gravity=(0, 0, 0), parameters=(sf.Parameter("Fy", 0.0), sf.Parameter("Fz", 0.0))
    )
    return sf.compile(stated, sf.Options(("dynamics", "rest_stiffness", "frame_pose"), ("tip",)))


def beam_tips(m: sf.Model, load: float, angles: Array) -> tuple[Array, Array]:
    """Displacement of the tip (n, 3) [m] and twist of its section (n) [rad] at rest; NaN where there is no rest."""
    places, twists = np.full((len(angles), 3), np.nan), np.full(len(angles), np.nan)
    for k, angle in enumerate(angles.tolist()):
        q = m.neutral()
        try:
            for share in STEPS:
                force = share * load
                loaded = m.with_parameters(Fy=force * np.cos(angle), Fz=force * np.sin(angle))
                q = sf.equilibrium(loaded, q, iterations=20, beam_limit=np.inf).q
        except sf.EquilibriumError:
            continue
        p, R = loaded.frame_pose("tip", q)
        places[k], twists[k] = p - (Strip().length, 0.0, 0.0), twist(R)
    return places, twists


def rod_tips(load: float, angles: Array) -> tuple[Array, Array]:
    """The same by Exudyn."""
    tips = [princeton(load, angle) for angle in angles.tolist()]
    return np.array([p for p, _ in tips]), np.array([twist(R) for _, R in tips])


def twist(R: Array) -> float:
    """Rotation of the section's z axis about the undeformed beam's axis [rad]."""
    return float(np.arctan2(R[2, 1], R[1, 1]))


def study(quick: bool) -> Study:
    """Compare deflection and twist of the Princeton strip with Exudyn's geometrically exact beam."""
    angles = np.radians(np.linspace(0.0, 90.0, 4 if quick else 13))
    loads = LOADS[1:2] if quick else LOADS
    m = {retain: strip_model(retain) for retain in ORDERS}
    reference = {load: rod_tips(load, angles) for load in loads}
    tips_of_loads = {load: beam_tips(m["all"], load, angles) for load in loads}
    # A small to a large load at 60 degrees, where both bendings and the twist are at work.
    at, growing = np.radians([60.0]), np.geomspace(0.5, 9.0, 5 if quick else 15)
    rod = [rod_tips(float(load), at) for load in growing]
    sizes = np.array([np.linalg.norm(p[0]) for p, _ in rod])
    deflection = np.array([np.linalg.norm(p[0, 1:]) for p, _ in rod]) / Strip().length
    errors, turned = {}, {}
    for retain in ORDERS:
        tips = [beam_tips(m[retain], float(load), at) for load in growing]
        errors[retain] = (
            np.array([np.linalg.norm(p[0] - q[0]) for (p, _), (q, _) in zip(tips, rod, strict=True)]) / sizes
        )
        turned[retain] = np.array([t[0] / w[0] for (_, t), (_, w) in zip(tips, rod, strict=True)])
    whole, small, moderate = errors["all"], deflection <= SMALL, deflection <= MODERATE
    low = deflection <= 0.05
    lost = first_load_without_equilibrium(m["all"], float(at[0]))
    at_loss = float(np.linalg.norm(rod_tips(lost, at)[0][0, 1:]) / Strip().length)
    findings = _findings(deflection, whole, turned, at_loss)
    answer = (
        f"Up to a deflection of {SMALL:g} L the tip is where Exudyn's geometrically exact beam has it to "
        f"{whole[small].max():.1%} of its displacement, up to {MODERATE:g} L to {whole[moderate].max():.1%}. Bending "
        f"twists the strip, which is followed with everything kept, to {np.abs(turned['all'][low] - 1).max():.0%} "
        f"up to 0.05 L, and unknown to first order. Under a load at 60° of {lost:.1f} N the "
        "second-order strip finds no rest any more: its cubic strain energy has no bottom there. "
        "A rod by its strains (`theory: strain`) does."
    )
    figures = (around(angles, loads, reference, tips_of_loads), growth(deflection, errors))
    return Study(
        "Bent both ways and twisted, where does second order fail?",
        answer,
        figures,
        findings,
        ("Princeton beam: Dowell & Traybar 1975; Exudyn, 32 geometrically exact elements",),
    )


def _findings(deflection: Array, whole: Array, turned: Mapping[str, Array], lost: float) -> tuple[Finding, ...]:
    """Findings on deflection and twist of the strip under loads at 60 degrees, and on its loss of equilibrium.

    Args:
        deflection: Deflections over the length.
        whole: Errors with all terms, over the displacements.
        turned: Twists over Exudyn's, by order.
        lost: First deflection over the length at which no rest is found.
    """
    small, moderate, low = deflection <= SMALL, deflection <= MODERATE, deflection <= 0.05
    return (
        Finding(
            "retain: all, deflection up to 0.10 L: largest error over the displacement",
            float(whole[small].max()),
            0.015,
            reason="1 % of second-order theory in one plane, and the coupling's",
        ),
        Finding(
            "retain: all, deflection up to 0.21 L: largest error over the displacement",
            float(whole[moderate].max()),
            0.08,
            reason="5 %, likewise",
        ),
        Finding(
            "retain: all: exponent of the error in the deflection, from 0.05 to 0.21 L",
            -exponent(deflection[~low & moderate], whole[~low & moderate]),
            2.6,
            1.6,
            "second order errs by the square",
        ),
        Finding(
            "retain: all: largest relative error of the twist, deflection up to 0.05 L",
            float(np.abs(turned["all"][low] - 1.0).max()),
            0.05,
            reason="cubic strain energy gives it",
        ),
        Finding(
            "first order: twist over Exudyn's",
            float(np.abs(turned["first_order"]).max()),
            1e-9,
            reason="its strain energy is quadratic",
        ),
        Finding(
            "retain: all, load at 60°: deflection over L, in Exudyn, where our equilibrium is lost",
            lost,
            0.5,
            0.25,
            "beyond what second order claims",
        ),
    )


def first_load_without_equilibrium(m: sf.Model, angle: float) -> float:
    """The load from which our strip has no equilibrium, to half a newton [N]."""
    for load in np.arange(9.0, 20.0, 0.5).tolist():
        if np.isnan(beam_tips(m, load, np.array([angle]))[1][0]):
            return float(load)
    return np.nan


Tips = dict[float, tuple[Array, Array]]


def around(angles: Array, loads: tuple[float, ...], reference: Tips, tips: Tips) -> Figure:
    """Displacement and twist against the load's direction."""
    x, degrees = "angle of the load, from the stiff way to the soft  [°]", np.degrees(angles)
    sides: tuple[tuple[str, Tips, Kind], ...] = (("retain: all", tips, "line"), ("Exudyn", reference, "points"))
    soft, turned = [], []
    for k, load in enumerate(loads):
        for name, (places, twists), kind in ((name, side[load], kind) for name, side, kind in sides):
            soft.append(Curve(f"{name}, {load:g} N", degrees, places[:, 2], k, kind))
            turned.append(Curve(f"{name}, {load:g} N", degrees, np.degrees(twists), k, kind))
    turned.append(Curve("first order, any load", degrees, 0.0 * degrees, 4, "dashed"))
    return Figure(
        "Left, curves and points part as the load grows and turns to the soft way; a curve has a gap where our strip "
        "finds no rest. Right, a strip that is bent both ways twists: with everything kept by the right angle while "
        "the deflection is small, by too much later; at first order, dashed, not at all.",
        (
            Chart("tip, the soft way", x, "displacement  [m]", tuple(soft)),
            Chart("twist of the tip", x, "angle  [°]", tuple(turned)),
        ),
    )


def growth(deflection: Array, errors: dict[str, Array]) -> Figure:
    """Error against deflection."""
    x, y = "deflection of the tip over L  [1]", "error over the displacement  [1]"
    drawn = curves(deflection, {"retain: all": errors["all"], "first order": errors["first_order"]})
    marks = Mark("1 %", 0.01), Mark("5 %", 0.05)
    return Figure(
        "The error rises with the square of the deflection and crosses 1 % near a tenth of the length, as under a load "
        "in one plane. First order, which lacks the twist, puts the tip somewhat better: keeping everything that a "
        "second-order theory has is no step towards the exact beam when the deflection is large.",
        (Chart("load at 60°: error of the tip's place", x, y, drawn, marks, log="xy"),),
    )
