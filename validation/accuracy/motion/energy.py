"""Energy along free motion: kept if everything is, nearly kept at first order."""

from __future__ import annotations

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.figures import Chart, Curve, Figure, Mark, curves
from ...reporting.findings import Finding, Study, exponent
from ..beams import motion

PERIOD = 2 * np.pi / 3.516
# At an integrator's tolerance of 1e-12 over a hundred periods.
KEPT = 1e-9


def system(retain: str) -> sf.Model:
    """A beam that bends both ways and twists, on a free hub, with a body on its tip.

    One function a direction, with equal frequencies, so that the integrator's steps are not those of high modes.
    """
    beam = sf.Beam(
        "b",
        sf.Joint("hub", "revolute", axis=(0, 1, 2)),
        1.0,
        1.0,
        EI_z=1.0,
        EI_y=1.5,
        GJ=0.5,
        rhoJ=0.05,
        bend_y=1,
        bend_z=1,
        twist=1,
        family="polynomial",
        retain=retain,  # type: ignore[arg-type]
    )
    load = sf.RigidBody("load", sf.Joint("weld", "fixed", "b", "tip"), sf.Inertia(0.1, moments=(0.01,) * 3))
    functions = ("forward_dynamics", "kinetic_energy", "potential_energy")
    return sf.compile(sf.System("s", (beam, load), gravity=(0, 0, 0)), sf.Options(functions))


def error(m: sf.Model, deflection: float, periods: int) -> tuple[Array, Array]:
    """Time in periods of the first mode (n), and energy relative to its start (n)."""
    q0, v0 = np.array([0.0, deflection, -deflection, 2 * deflection]), np.array([1.0, 0.0, 0.0, 0.0])
    times = np.linspace(0.0, periods * PERIOD, 40 * periods + 1)
    q, v = motion(m, q0, v0, times, 1e-12)
    energy = m.kinetic_energy(q, v) + m.potential_energy(q)
    return times / PERIOD, np.abs(energy / energy[0] - 1.0)


def study(quick: bool) -> Study:
    """Measure the energy error along free motions with all terms and at first order."""
    periods = 6 if quick else 100
    kept, first = system("all"), system("first_order")
    time, all_error = error(kept, 0.1, periods)
    runs = {d: error(first, d, periods)[1] for d in (0.1, 0.05, 0.025)}
    largest = np.array([run[time <= 10].max() for run in runs.values()])
    slope = -exponent(np.array(list(runs)), largest)
    half = time < periods / 2
    growth = float(runs[0.05][~half].max() / runs[0.05][half].max())
    findings = (
        Finding(
            f"retain: all, {periods} periods: largest relative error of the energy",
            float(all_error.max()),
            KEPT,
            reason="the integrator's tolerance of 1e-12, gathered over the run",
        ),
        Finding(
            "first order: exponent of the error in the deflection",
            slope,
            3.0,
            1.9,
            "terms from the second degree on are dropped",
        ),
        Finding(
            "first order: error in the second half over that in the first",
            growth,
            1.5,
            reason="bounded: it does not drift",
        ),
    )
    answer = (
        f"With everything kept, energy is constant to {all_error.max():.0e} over {periods} periods, which is what the "
        f"integrator leaves. At first order it errs by {largest[1]:.1e} at 0.05 L, falling with the deflection to the "
        f"power {slope:.1f}, to and fro without drift. A check of energy must know which of the two it checks."
    )
    return Study("Is energy kept?", answer, (figure(time, all_error, runs, largest),), findings)


def figure(time: Array, kept: Array, runs: dict[float, Array], largest: Array) -> Figure:
    """Through time, and against deflection."""
    errors = {"retain: all, 0.1 L": kept, **{f"first order, {d:g} L": run for d, run in runs.items()}}
    through = curves(time[40::40], {name: envelope(error[1:]) for name, error in errors.items()}, "line")
    deflections = np.array(list(runs))
    square = largest[1] * (deflections / deflections[1]) ** 2
    against = (
        Curve("first order", deflections, largest, 1, "joined"),
        Curve("square of the deflection", deflections, square, 4, "dotted"),
    )
    periods, bound = "periods of the first mode  [1]", (Mark("bound for retain: all", KEPT),)
    start, worst = "deflection at the start over L  [1]", "largest relative error of ten periods  [1]"
    return Figure(
        "Left, the largest error of each period: first order stays level, eight decades above retain: all, which "
        "gathers nothing but the integrator's errors. Right, half the deflection leaves a quarter of the "
        "error or less.",
        (
            Chart("energy of a free motion", periods, "relative error of the energy  [1]", through, bound, log="y"),
            Chart("first order: error against deflection", start, worst, against, log="xy"),
        ),
    )


def envelope(error: Array) -> Array:
    """The largest error of each period (periods)."""
    return np.asarray(error.reshape(-1, 40).max(axis=1))
