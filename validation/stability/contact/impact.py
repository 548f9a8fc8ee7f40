"""A ball that a stiff floor throws back: steps against the time of the impact, ours and MuJoCo's."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np

import symofros as sf

from ...adapters.mujoco import motion as mujoco_motion
from ...reporting.findings import Finding
from ..study import Cell, Grid, Limit, Map, Maps, ParameterStudy, Subject, Verdict, cell, decades, simulate

HEIGHT, RADIUS, END = 0.05, 0.1, 0.4
BOUND = 0.01
# Energies off by 5 % are noted: 2.5 % of the speed, met between steps of the grid.
NOTED = 0.03
STIFFNESS = Grid("stiffness of the floor over the mass k/m [1/s²]", decades(1e3, 1e8, 3), (1e4, 1e6))
H = Grid("step h [s]", decades(1e-5, 1e-1, 4), (1e-4, 1e-3, 1e-2))
METHODS = ("rk4", "semi_implicit_euler", "implicit_euler")
MUJOCO = "MuJoCo Euler"
# Steps h sqrt(k/m) up to which free swings on the floor stay bounded.
LIMITS = {"semi_implicit_euler": 2.0, MUJOCO: 2.0, "rk4": 2.0 * math.sqrt(2.0)}
MJCF = (
    '<mujoco><option timestep="{h!r}" integrator="Euler" gravity="0 0 0"/><worldbody><geom type="plane" size="1 1 1" '
    'friction="0 0 0" condim="1" solref="-{k!r} 0" solimp="0.9999 0.9999 0.001 0.5 2"/><body pos="0 0 {z!r}">'
    '<joint type="slide" axis="0 0 1"/><geom type="sphere" size="{r!r}" mass="1" friction="0 0 0" condim="1" '
    'solref="-{k!r} 0" solimp="0.9999 0.9999 0.001 0.5 2"/></body></worldbody></mujoco>'
)


@cache
def ball() -> sf.Model:
    """1 kg that moves along z without gravity; a linear floor without losses, of stiffness k."""
    joint = sf.Joint("z", "prismatic", axis=(0, 0, 1))
    floor = sf.Contact("floor", ("ball", None), ("world", None), sf.formula("k"), exponent=1.0, radius=RADIUS)
    body = sf.RigidBody("ball", joint, sf.Inertia(1.0))
    system = sf.System("ball", (body,), (sf.Parameter("k", 1e4),), gravity=(0, 0, 0), connections=(floor,))
    return sf.compile(system)


def thrown(method: str, k: float, h: float) -> sf.Trajectory:
    """Motion of the ball, which falls at 1 m/s from HEIGHT above the floor, by steps of h."""
    start = [RADIUS + HEIGHT]
    model = ball().with_parameters(k=k)
    return simulate(model, start, [-1.0], t_end=END, dt=h, method=method, adaptive=False, output=[0.0, END])


def off(speed: float) -> float:
    """Share by which the ball is faster or slower than the 1 m/s that it came with."""
    return abs(speed - 1.0)


def measure(method: str) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of the map."""
    return lambda k, h: cell(thrown(method, k, h), lambda run: off(float(run.v[-1, 0])))


def by_mujoco(k: float, h: float) -> Cell:
    """The same floor as a soft constraint of MuJoCo, by `solref` of a stiffness and no damping."""
    text = MJCF.format(h=h, k=k, z=RADIUS + HEIGHT, r=RADIUS)
    done = mujoco_motion.move(text, np.zeros(1), np.array([-1.0]), END, 1)
    return Cell(math.nan, "diverged", done.warning) if done.warning else Cell(off(float(done.v[0])))


def limit(bound: float) -> Limit:
    """H sqrt(k/m) = bound."""
    x = np.array([STIFFNESS.values[0], STIFFNESS.values[-1]])
    return Limit(f"h √(k/m) = {bound:.3g}", x, lambda k: bound / np.sqrt(k))


def said(runs: Map) -> tuple[int, int]:
    """Number of runs to the end that are off by more than NOTED: those that bear a note, and all."""
    wrong = [c for row in runs.cells for c in row if c.ended == "finished" and c.value > NOTED]
    return sum(bool(c.note) for c in wrong), len(wrong)


def coarsest(runs: Map) -> float:
    """Largest h sqrt(k/m) up to which every run is good."""
    steps = np.sqrt(runs.x)[np.newaxis, :] * runs.y[:, np.newaxis]
    bad = steps[~runs.good]
    return float(steps[steps < bad.min()].max(initial=0.0)) if bad.size else float(steps.max())


def judge(maps: Maps) -> Verdict:
    """Verdict on the steps that an impact takes, and on whether runs say where they are too long."""
    reach = {name: coarsest(one) for name, one in maps.items()}
    counts = {name: said(maps[name]) for name in METHODS}
    noted, wrong = (sum(pair[i] for pair in counts.values()) for i in (0, 1))
    worst = {name: float(np.nanmax(one.values)) for name, one in maps.items()}
    findings = (
        Finding(
            "rk4: every run with h √(k/m) up to this is good",
            reach["rk4"],
            LIMITS["rk4"],
            0.1,
            "its error is of second order where the force has a kink; past the limit of stability none is good",
        ),
        Finding(
            "our runs off by more than 3 % that bear no note", float(wrong - noted), 0.0, reason="silence means right"
        ),
    )
    statement = (
        f"An impact lasts π √(m/k). RK4 keeps the speed to 1 % where its step is below {reach['rk4']:.2g} √(m/k), "
        f"semi-implicit Euler below {reach['semi_implicit_euler']:.2g}, implicit Euler below "
        f"{reach['implicit_euler']:.2g}, MuJoCo's Euler below {reach[MUJOCO]:.2g}. Past the limits of stability an "
        f"explicit step throws the ball back too fast: up to {worst['rk4']:.0e} times by RK4, "
        f"{worst['semi_implicit_euler']:.0e} by semi-implicit Euler, {worst[MUJOCO]:.0e} in MuJoCo. Of our {wrong} "
        f"runs that end {NOTED:.0%} off or more {noted} say so in a note."
    )
    see = (
        "The edge between blue and orange runs along h √(k/m) = constant: ten steps an impact, whatever the stiffness."
    )
    return Verdict(statement, see, findings)


STUDY = ParameterStudy(
    "Which step does a stiff contact take?",
    f"A ball of 1 kg meets a linear floor without losses at 1 m/s, without gravity, and leaves it; after {END:g} s its "
    "speed is compared. MuJoCo has the same stiffness by `solref`, without damping.",
    STIFFNESS,
    H,
    "speed after the impact less 1 m/s, over 1 m/s [-]",
    BOUND,
    (
        *(Subject(name, measure(name), (limit(LIMITS[name]),) if name in LIMITS else ()) for name in METHODS),
        Subject(MUJOCO, by_mujoco, (limit(LIMITS[MUJOCO]),)),
    ),
    judge,
    "adaptive dopri5 or rodas4, which find the impact's length by themselves; with fixed steps of rk4 a stiffness of "
    "at most m/(10 h)², for a depth v √(m/k) that the scene can bear.",
    ("motion of a mass on a spring in closed form; linear stability theory",),
)
