"""A cantilever under a dead load at its tip: linear theory, second-order theory, elastica."""

from __future__ import annotations

import numpy as np
import scipy.optimize
import scipy.special

import symofros as sf

from ...adapters.exudyn.ancf import static_tip
from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Mark, curves
from ...reporting.findings import Finding, Study, near
from ..beams import cantilever, interpreted
from ..reference import data, source

# Relative error of the tip's deflection, in per cent, whose beginning is looked for.
# EA of Exudyn's beam, which stretches, in units of EI/L^2.
STRETCH = 1e6
LEVELS = {"0.01": "1 %", "0.05": "5 %", "0.1": "10 %"}
FUNCTIONS = ("dynamics", "rest_stiffness", "frame_pose")


def exact(alpha: float) -> tuple[float, float]:
    """Deflection and shortening of the tip over L under P = alpha EI/L^2: the elastica in elliptic integrals."""

    def load(k: float) -> float:
        return float(scipy.special.ellipk(k * k) - scipy.special.ellipkinc(np.arcsin(1 / (k * np.sqrt(2))), k * k)) ** 2

    k = scipy.optimize.brentq(lambda k: load(k) - alpha, np.sqrt(0.5) + 1e-15, 1 - 1e-12, xtol=1e-16)
    turn = np.arcsin(1 / (k * np.sqrt(2)))
    second = scipy.special.ellipe(k * k) - scipy.special.ellipeinc(turn, k * k)
    return 1 - 2 * float(second) / np.sqrt(alpha), 1 - float(np.sqrt(2 * (2 * k * k - 1) / alpha))


def second_order() -> sf.Model:
    """The beam under a load P; two functions hold the cubic that it bends to exactly."""
    load = sf.BeamLoad((0.0, sf.formula("P", "load"), 0.0), at=1.0, axes="world")
    return interpreted(cantilever(bend_y=2, loads=(load,), retain="all"), functions=FUNCTIONS, parameters=["P"])


def tip(m: sf.Model, alpha: float) -> tuple[float, float]:
    """Deflection and shortening of our tip at equilibrium."""
    m = m.with_parameters(P=alpha)
    p, _ = m.frame_pose("tip", sf.equilibrium(m, beam_limit=np.inf).q)
    return float(p[1]), float(1.0 - p[0])


def study(quick: bool) -> Study:
    """Compare deflections of the second-order beam under a tip load with the elastica."""
    m, reference = second_order(), data("elastica_tip_load")
    alphas = np.geomspace(0.05, 3.0, 25 if quick else 50)
    beam = np.array([tip(m, float(alpha)) for alpha in alphas])
    rod = np.array([exact(float(alpha)) for alpha in alphas])
    table = reference["table"]
    distance = max(abs(exact(row["alpha"])[0] - row["tip_y"]) for row in table if row["alpha"] <= 5)
    begins = {name: float(np.interp(float(name), beam[:, 0] / rod[:, 0] - 1, rod[:, 0])) for name in LEVELS}
    findings = [Finding("elastica in elliptic integrals against the table", distance, 1e-9, reason="the same curve")]
    findings += [
        near(
            f"deflection over L at which the error reaches {label}",
            begins[name],
            reference["thresholds_on_linear_theory"][name]["tip_y_over_L"],
            1e-2 if quick else 2e-3,
            "the known theory's, read off between loads",
        )
        for name, label in LEVELS.items()
    ]
    answer = (
        f"The deflection errs by 1 % at {begins['0.01']:.3f} L, 5 % at {begins['0.05']:.3f} L and 10 % at "
        f"{begins['0.1']:.3f} L. It is linear theory's deflection: what second order adds is the shortening, right to "
        "5 % up to 0.17 L, which linear theory lacks altogether. Beyond 0.1 L take a rod by its strains "
        "(`theory: strain`) for more than a per cent; beyond 0.3 L believe nothing but trends of second order."
    )
    cable = np.array([static_tip(1.0, 1.0, STRETCH, (0.0, a)) for a in alphas.tolist()])
    cable = np.stack([cable[:, 1], 1.0 - cable[:, 0]], axis=-1)
    findings.append(
        Finding(
            "Exudyn, 16 ANCF cables: largest distance from the elastica over L",
            float(np.abs(cable - rod).max()),
            2e-4,
            reason="it is exact in bending",
        )
    )
    figures = (shapes(alphas, beam, rod, cable), growth(beam, rod))
    return Study("How far may it bend?", answer, figures, tuple(findings), (source("elastica_tip_load"),))


def shapes(alphas: Array, beam: Array, rod: Array, cable: Array) -> Figure:
    """Deflection and shortening against load."""
    x, names = "load P L²/EI  [1]", ("our beam (as linear theory)", "our beam")
    deflection, shortening = (
        (
            Curve("elastica", alphas, rod[:, k], 0),
            Curve("Exudyn", alphas[::4], cable[::4, k], 5, "points"),
            Curve(name, alphas, beam[:, k], 1, "dashed"),
        )
        for k, name in enumerate(names)
    )
    linear = Curve("linear theory", alphas, 0 * alphas, 4, "dotted")
    marks = Mark("1 %", 0.098), Mark("5 %", 0.214)
    return Figure(
        "The beam follows the elastica through its first tenth of a length, then bends too far, because load and axis "
        "stay as they were; its shortening, which linear theory does not have, follows as far.",
        (
            Chart("deflection of the tip", x, "deflection over L  [1]", deflection, marks),
            Chart("shortening of the tip", x, "shortening over L  [1]", (*shortening, linear)),
        ),
    )


def growth(beam: Array, rod: Array) -> Figure:
    """Errors against deflection."""
    errors = dict(zip(("deflection", "shortening"), np.abs(beam / rod - 1.0).T, strict=True))
    x, marks = "deflection of the tip over L  [1]", (Mark("1 %", 0.01), Mark("5 %", 0.05))
    drawn = curves(rod[:, 0], errors)
    return Figure(
        "Both errors are straight lines of slope two: half the deflection, a quarter of the error. Read off where the "
        "red lines are crossed: 1 % at 0.10 L, 5 % at 0.21 L.",
        (Chart("error against deflection", x, "relative error  [1]", drawn, marks, log="xy"),),
    )
