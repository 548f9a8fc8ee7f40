"""Geometrically exact rods in motion: spin-up without a floor, energy of a soft pendulum through large angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import symofros as sf

from ... import references
from ...reporting.figures import Chart, Figure, Mark, curves
from ...reporting.findings import Finding, Study
from ..reference import data, source
from . import spinup

# Largest distance of the spin-up's tip from the exact inextensible rod, by number of functions [m].
SPIN_UP = {1: 0.25, 2: 0.03, 3: 5e-3, 4: 3e-4, 5: 1.5e-5, 6: 6e-7}
# Change of the energy of a swing over what its weight exchanges.
ENERGY = 1e-9


def spun_up(functions: int, end: float) -> float:
    """Largest distance of the tip from the exact rod, up to an instant [m]."""
    known = data("spin_up")["exact_inextensible_rod"]
    t = np.array([instant for instant in known["t"] if instant <= end])
    exact = np.stack([known["tip_x"], known["tip_y"]], axis=-1)[: len(t)]
    times = np.union1d([0.0], t)
    moved = spinup.tip(times, functions, family="legendre", theory="strain")
    return float(np.abs(moved[np.searchsorted(times, t)] - exact).max())


def swing(end: float) -> tuple[float, float]:
    """Change of the energy of the undamped soft pendulum over what its weight exchanges, and its largest bend [rad]."""
    stated = references.MODELS["soft_pendulum"]
    bodies = [replace(body, damping=0.0) if isinstance(body, sf.Beam) else body for body in stated.bodies]
    functions = ("forward_dynamics", "kinetic_energy", "potential_energy")
    m = sf.compile(replace(stated, bodies=tuple(bodies)), sf.Options(functions))
    run = sf.simulate(m, t_end=end, method="dopri5", rtol=1e-11, atol=1e-12)
    stored = m.potential_energy(run.q)
    energy = m.kinetic_energy(run.q, run.v) + stored
    return float(np.ptp(energy) / np.ptp(stored)), run.bendings[0].slope


def study(quick: bool) -> Study:
    """Compare the spin-up of strain-based rods with the exact rod, and measure energy drift of a soft pendulum."""
    end = 8.0 if quick else 20.0
    errors = {n: spun_up(n, end) for n in SPIN_UP if n < (5 if quick else 7)}
    drift, slope = swing(2.0 if quick else 10.0)
    findings = [
        Finding(f"{n} functions: largest distance from the exact rod [m]", error, SPIN_UP[n], reason="convergence")
        for n, error in errors.items()
    ]
    findings.append(
        Finding("soft pendulum: change of energy over what is exchanged", drift, ENERGY, reason="the stepping's own")
    )
    last = max(errors)
    answer = (
        f"The error of the spin-up falls by a factor of about ten with each function, to {errors[last]:.1g} m of 8 m "
        f"with {last}: the floor of second-order theory, 2.1 mm, is gone. A soft pendulum that bends by {slope:.1f} "
        f"rad as it swings keeps its energy to {drift:.0e}."
    )
    figure = Figure(
        "A straight line on a logarithmic scale: the error of the rod's motion falls exponentially with its functions, "
        "through what second-order theory can't go below.",
        (
            Chart(
                "spin-up: largest error of the tip",
                "functions  [1]",
                "error  [m]",
                curves(np.array(list(errors)), {"rod by its strains": np.array(list(errors.values()))}),
                (Mark("second order", spinup.FLOOR),),
                log="y",
            ),
        ),
    )
    return Study("Does a rod by its strains have a floor?", answer, (figure,), tuple(findings), (source("spin_up"),))
