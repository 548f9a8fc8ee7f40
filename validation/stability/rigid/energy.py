"""Energy over 1e5 steps of each integrator, ours and the engines'."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

import symofros as sf
from symofros.tools import METHODS

from ...adapters.mujoco import motion as mujoco_motion
from ...reporting.findings import Finding
from ..reference import data, source
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, cell, decades, simulate

STEPS = 100_000
SHORT = 5_000
BOUND = 1e-3
MUJOCO = {"MuJoCo Euler": "Euler", "MuJoCo implicit": "implicit", "MuJoCo RK4": "RK4"}
# CVODE chooses its steps.
OURS = tuple(name for name, method in METHODS.items() if not method.family.multistep)
WHO = Grid.of("integrator [-]", (*OURS, *MUJOCO), ("euler", "semi_implicit_euler", "rk4", "variational"))
H = Grid("step h [s]", decades(1e-3, 0.1, 4), (1e-3, 1e-2))
MJCF = (
    '<mujoco><compiler angle="radian"/><option timestep="{h!r}" integrator="{name}" gravity="0 0 -9.81"/><worldbody>'
    '<body><joint type="hinge" axis="0 1 0"/><inertial pos="1 0 0" mass="1" diaginertia="1e-9 1e-9 1e-9"/></body>'
    "</worldbody></mujoco>"
)


@cache
def pendulum() -> sf.Model:
    """A point of 1 kg at 1 m, level where its angle is zero."""
    body = sf.RigidBody("point", sf.Joint("q", "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, (1, 0, 0)))
    return sf.compile(sf.System("pendulum", (body,)))


def swing(method: str, h: float, steps: int) -> sf.Trajectory:
    """Swing of the pendulum from the horizontal, at rest."""
    return simulate(pendulum(), [0.0], t_end=steps * h, method=method, dt=h, adaptive=False, every=10)


def excursion(run: sf.Trajectory) -> float:
    """Largest change of the energy over m g L, the scale of the energy exchanged in the swing."""
    return float(np.abs(run.energy - run.energy[0]).max() / 9.81)


def measure(steps: int) -> Subject:
    """All integrators over so many steps."""

    def run(h: float, who: float) -> Cell:
        name = WHO.label(who)
        if name not in MUJOCO:
            return cell(swing(name, h, steps), excursion)
        done = mujoco_motion.move(MJCF.format(h=h, name=MUJOCO[name]), np.zeros(1), np.zeros(1), steps * h, 1000)
        if done.warning:
            return Cell(math.nan, "diverged", done.warning)
        return Cell(float(np.abs(done.energy - done.energy[0]).max() / 9.81))

    return Subject(f"{steps:.0e} steps".replace("e+0", "e"), run)


def judge(maps: Maps) -> Verdict:
    """Verdict on which methods' energy drifts and which only oscillates."""
    early, late = maps.values()
    rows = {WHO.label(y): k for k, y in enumerate(late.y)}
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = {name: float(np.nanmedian(late.values[k] / early.values[k])) for name, k in rows.items()}
    factors = []
    for row in data("pendulum")["energy"]:
        if row["method"] != "explicit_euler" and row["h"] >= 5e-3:
            change = 9.81 * excursion(swing(row["method"], row["h"], round(100 / row["h"])))
            factors.append(max(change / row["max_dE_100s"], row["max_dE_100s"] / change))
    level = ["semi_implicit_euler", "variational"]
    findings = [
        Finding(
            f"{name}: error of {STEPS:.0e} steps over that of {SHORT:.0e}", ratio[name], 1.05, 0.95, "it does not drift"
        )
        for name in level
    ] + [
        Finding("rk4: the same", ratio["rk4"], STEPS / SHORT * 1.2, 5.0, "it drifts, at most in proportion"),
        Finding("factor between known and found energies after 100 s", max(factors), 2.0, reason="another program"),
    ]
    index = {name: late.values[k] for name, k in rows.items()}
    best = {
        f"{h:.3g} s": min(rows, key=lambda n, i=i: index[n][i] if math.isfinite(index[n][i]) else math.inf)  # type: ignore[misc]
        for i, h in ((0, late.x[0]), (len(late.x) - 1, late.x[-1]))
    }
    engines = " ".join(
        f"{name} multiplies its error by {ratio[name]:.1f}, to {index[name][0]:.0e} at {late.x[0]:g} s."
        for name in MUJOCO
        if name in rows
    )
    statement = (
        f"From {SHORT:.0e} to {STEPS:.0e} steps the error of semi-implicit Euler and of the variational method does "
        f"not grow (factors {ratio['semi_implicit_euler']:.2f} and {ratio['variational']:.2f}): it swings with the "
        f"motion. RK4's grows {ratio['rk4']:.0f} times and stays small at short steps, {index['rk4'][0]:.0e} of m g "
        f"L at {late.x[0]:g} s; explicit Euler meets the criterion at {int(np.sum(index['euler'] <= BOUND))} of "
        f"{len(late.x)} steps. {engines} Least after {STEPS:.0e} steps: "
        + ", ".join(f"{name} at {h}" for h, name in best.items())
        + "."
    )
    see = (
        "Rows that look alike in both maps do not drift; those that darken towards orange from the left map to the "
        "right one do. Errors fall to the left with each method's order."
    )
    return Verdict(statement, see, tuple(findings))


STUDY = ParameterStudy(
    "Who keeps energy over 1e5 steps?",
    "A pendulum swings from the horizontal; adaptive methods take fixed steps. MuJoCo with its own integrators.",
    H,
    WHO,
    "largest change of energy over m g L [-]",
    BOUND,
    (measure(SHORT), measure(STEPS)),
    judge,
    "variational for long conservative runs of trees, rk4 or dop853 with a step that the accuracy asks for; never "
    "explicit Euler. Implicit Euler takes energy out: it is for stiff models.",
    (source("pendulum"),),
)
