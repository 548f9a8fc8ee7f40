"""A ball that bounces ever lower: instants of its bounces, located within steps and looked for once a step."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.findings import Finding
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, cell, simulate

GRAVITY, HEIGHT, STEP = 9.81, 1.0, 1e-2
BOUND = 1e-5
BOUNCE = Grid("number of the bounce [-]", (1.0, 2.0, 3.0, 5.0, 8.0, 13.0, 21.0, 34.0), (1.0, 5.0, 34.0))
RESTITUTION = Grid("coefficient of restitution e [-]", (0.2, 0.4, 0.6, 0.8, 0.9, 0.95), (0.2, 0.9), log=False)
LOCATED, ADAPTIVE = "located, rk4 of 10 ms", "located, dopri5"
METHODS = {LOCATED: "rk4", ADAPTIVE: "dopri5"}
ONCE = "looked for once in 1 ms"
SHORT = 1e-3


@cache
def ball() -> sf.Model:
    """1 kg that moves along z, and a floor that engages at a strike."""
    body = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(1.0))
    floor = sf.Closure("floor", ("world", None), ("ball", None), ("z",))
    touch, switch = sf.Parameter("touch", 0), sf.Switch("floor", sf.formula("touch"))
    return sf.compile(sf.System("bouncing", (body,), (touch,), constraints=(floor,), switches=(switch,)))


def instant(n: float, e: float) -> float:
    """Instant of the n-th bounce from HEIGHT at rest [s]."""
    fall = math.sqrt(2 * HEIGHT / GRAVITY)
    return fall * (1 + 2 * sum(e**k for k in range(1, round(n))))


def accumulation(e: float) -> float:
    """Instant from which on the ball lies [s]."""
    return math.sqrt(2 * HEIGHT / GRAVITY) * (1 + e) / (1 - e)


@cache
def bounced(name: str, e: float) -> sf.Trajectory:
    """Motion until after the accumulation."""
    strike = sf.Event("z", "falling", action={"touch": 1}, restitution=e, rests="lam.floor.z")
    given = {"method": METHODS[name], "dt": STEP, "adaptive": name == ADAPTIVE}
    return simulate(ball(), [HEIGHT], t_end=1.02 * accumulation(e), events={"strike": strike}, **given)


@cache
def stepped(e: float) -> Array:
    """Instants at which semi-implicit Euler finds the ball below the floor, and turns its speed [s]."""
    z, v, found = HEIGHT, 0.0, []
    for k in range(round(1.02 * accumulation(e) / SHORT)):
        v -= GRAVITY * SHORT
        z += v * SHORT
        if z < 0.0 and v < 0.0:
            found.append((k + 1) * SHORT)
            z, v = 0.0, -e * v
    return np.array(found)


def measure(name: str) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of the map; of a ball that lies by its last strike."""

    def run(n: float, e: float) -> Cell:
        exact = instant(n, e)
        if name == ONCE:
            found = stepped(e)
            return Cell(abs(float(found[min(round(n), len(found)) - 1]) - exact) / exact)
        run = bounced(name, e)
        strikes = [event.t for event in run.events if event.name == "strike"]
        return cell(run, lambda _: abs(strikes[min(round(n), len(strikes)) - 1] - exact) / exact)

    return run


def judge(maps: Maps) -> Verdict:
    """Verdict on what locating is worth, and on what becomes of a ball whose bounces accumulate."""
    exact = ends = 0.0
    for name in METHODS:
        one = maps[name]
        for i, n in enumerate(one.x):
            for j, e in enumerate(one.y):
                lies = sum(event.name == "strike" for event in bounced(name, float(e)).events) < n
                exact, ends = (exact, max(ends, one.values[j, i])) if lies else (max(exact, one.values[j, i]), ends)
    runs = [bounced(name, float(e)) for name in METHODS for e in maps[name].y]
    silent = sum(not any("persists" in note for note in run.outcome.notes) for run in runs)
    once = maps[ONCE]
    findings = (
        Finding("bounces that are located: error of their instants, relative", exact, 1e-10, reason="closed form"),
        Finding(
            "bounces that are taken as rest: error of their instants, relative",
            ends,
            2e-5,
            reason="the stated threshold",
        ),
        Finding("runs whose bounces accumulate without a note", float(silent), 0.0, reason="silence means right"),
        Finding(
            "looked for once a step: smallest error of a late bounce",
            float(once.values[:, -1].min()),
            1.0,
            1e-4,
            "a step",
        ),
    )
    statement = (
        f"Located within the step, instants of bounces are those of the closed form to {exact:.0e}, by rk4 with "
        f"{1e3 * STEP:g} ms as by dopri5, whatever e. Bounces closer than a millionth of the run are taken as rest, "
        f"with a note; the last is then off by {ends:.0e} at most. Looked for once in {1e3 * SHORT:g} ms they are off "
        f"by {once.values[:, 0].max():.0e} at the first bounce and by up to {once.values.max():.0e} later."
    )
    see = (
        "Blue is the closed form. What looks for contact once a step is orange everywhere, and worse with each bounce."
    )
    return Verdict(statement, see, findings)


STUDY = ParameterStudy(
    "When does a bouncing ball bounce, and when does it lie?",
    f"A ball falls from {HEIGHT:g} m onto a floor and bounces, each time with e times the speed, until bounces "
    "accumulate.",
    BOUNCE,
    RESTITUTION,
    "error of the instant of the bounce, relative [-]",
    BOUND,
    (*(Subject(name, measure(name)) for name in METHODS), Subject(ONCE, measure(ONCE))),
    judge,
    "events with `restitution` and `rests`: located by any method; a step that looks once finds late, and each error "
    "is carried into the next bounce.",
    ("closed form of bounces from a height",),
)
