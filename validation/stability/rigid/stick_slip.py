"""Stick-slip: a block that a spring drags over a table, friction smoothed over a speed."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ...reporting.findings import Finding
from ..study import (
    Cell,
    Grid,
    Limit,
    Map,
    Maps,
    ParameterStudy,
    Subject,
    Verdict,
    cell,
    decades,
    simulate,
)

STATIC, DYNAMIC, SPRING, PULL = 4.0, 2.0, 100.0, 0.05
END = 4.0
BOUND = 0.1
SMOOTH = Grid("minimum velocity v₀ of the friction [m/s]", decades(1e-5, 1e-1, 2), (1e-4, 1e-2))
H = Grid("step h [s]", decades(3e-5, 3e-2, 3), (1e-4, 1e-3, 1e-2))
# Where smoothing by itself keeps the criterion [m/s].
SHARP = 1e-4
METHODS = ("rk4", "semi_implicit_euler", "implicit_euler")


@cache
def block() -> sf.Model:
    """1 kg; the other end of the spring moves steadily."""
    table = sf.Friction(DYNAMIC, STATIC, sf.formula("v0", "speed"))
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True, elements=(table,))
    parameters = (sf.Parameter("v0", 1e-3),)
    return sf.compile(sf.System("block", (sf.RigidBody("block", joint, sf.Inertia(1.0)),), parameters=parameters))


def exact(times: Array) -> Array:
    """Position (n) with friction that falls at once from static to dynamic, piece by piece.

    Stuck until the spring pulls with `STATIC`; then its stretch swings about DYNAMIC/k until the block has stopped.
    """
    omega = math.sqrt(SPRING)
    # Stretch e = PULL t - x: e'' = -omega^2 (e - DYNAMIC/k), e(0) = STATIC/k, e'(0) = PULL; ends where e' = PULL again.
    amplitude, phase = (STATIC - DYNAMIC) / SPRING, PULL / omega
    slip = 2 * (math.pi - math.atan2(amplitude, phase)) / omega
    # By symmetry the block stops with the stretch as far below the middle as it began above.
    stick = 2 * amplitude / PULL
    first = STATIC / (SPRING * PULL)
    x = np.zeros_like(times)
    for i, t in enumerate(times):
        if t < first:
            continue
        periods, rest = divmod(t - first, slip + stick)
        jump = PULL * (slip + stick)
        moved = jump
        if rest < slip:
            stretch = DYNAMIC / SPRING + amplitude * math.cos(omega * rest) + phase * math.sin(omega * rest)
            moved = STATIC / SPRING + PULL * rest - stretch
        x[i] = periods * jump + moved
    return x


def jump() -> float:
    """Distance that the block slips in each stick-slip period [m]."""
    omega = math.sqrt(SPRING)
    amplitude, phase = (STATIC - DYNAMIC) / SPRING, PULL / omega
    return PULL * (2 * (math.pi - math.atan2(amplitude, phase)) / omega + 2 * amplitude / PULL)


def measure(method: str) -> Callable[[float, float], Cell]:
    """A function that evaluates one cell of the map, by smoothing speed and step: distance in slips."""
    return lambda v0, h: cell(dragged(v0, method=method, dt=h, adaptive=False), distance)


def dragged(v0: float, **settings: Any) -> sf.Trajectory:
    """Motion of the block, dragged by its spring, with friction smoothed at speeds below v0 [m/s]."""
    m = block().with_parameters(v0=v0)
    return simulate(m, [0.0], t_end=END, output=0.01, u={m.names.u[0]: f"{SPRING}*({PULL}*t - x)"}, **settings)


def distance(run: sf.Trajectory) -> float:
    """Mean distance from the exact motion, over the distance of one slip."""
    return float(np.abs(run.q[:, 0] - exact(run.t)).mean() / jump())


def limit(bound: float) -> Limit:
    """H F/(m v0) = bound: the slope of friction at rest against the stability of the method."""
    v = np.array([SMOOTH.values[0], SMOOTH.values[-1]])
    return Limit(f"{bound:.3g} m v₀/F", v, lambda v: bound * v / STATIC)


LIMITS = {"rk4": 2.7853, "semi_implicit_euler": 2.0}


def reach(runs: Map) -> list[tuple[float, float]]:
    """(v0, longest step below which every run is good), where there is one."""
    lines = zip(runs.x, runs.good.T, strict=True)
    return [(float(v0), float(runs.y[int(np.argmin(line)) - 1])) for v0, line in lines if line[0] and not line.all()]


def judge(maps: Maps) -> Verdict:
    """Verdict on the accuracy lost to chatter and to smoothing."""
    rk4, implicit = maps["rk4"], maps["implicit_euler"]
    below = 0
    for name, bound in LIMITS.items():
        runs = maps[name]
        safe = (runs.y[:, None] <= bound * runs.x / STATIC) & (runs.x <= SHARP)
        below += int((safe & ~runs.good).sum())
    edges = reach(rk4)
    ratios = [h / (LIMITS["rk4"] * v0 / STATIC) for v0, h in edges]
    finest = rk4.values[0]
    blunt = [float(v0) for v0, error in zip(rk4.x, finest, strict=True) if error > BOUND]
    adaptive = steady(1e-4)
    stopped = sum(runs.stopped for runs in maps.values())
    findings = (
        Finding(
            "explicit runs below the closed form, v₀ at most 0.1 mm/s, that miss the criterion",
            float(below),
            0.0,
            reason="the closed form is on the safe side",
        ),
        Finding(
            "rk4: smallest factor between the edge and the closed form",
            min(ratios, default=np.nan),
            100.0,
            1.0,
            "chatter is bounded: it costs little at first",
        ),
        Finding(
            "rodas4, adaptive, v₀ = 0.1 mm/s: mean distance [slips]", adaptive[0], 0.05, reason="what smoothing leaves"
        ),
        Finding(
            "break-away force over the static friction stated",
            break_away(1e-4) / STATIC,
            1.0 + 1e-12,
            1.0 - 1e-12,
            "maximum of the smoothed curve",
        ),
    )
    statement = (
        "Two errors meet. Smoothing lets the block creep until it breaks away, at the static friction but late: v₀ of "
        f"{min(blunt, default=np.inf):.1e} m/s and more miss at the shortest step; what is late falls as v₀^(2/3). "
        "Sharp friction makes the rest stiff: beyond h = "
        f"2.785 m v₀/F RK4 chatters about rest. Chatter stays bounded, so nothing diverges ({stopped} of "
        f"{sum(f.values.size for f in maps.values())} runs stop) and the criterion is missed only "
        f"{min(ratios, default=np.nan):.0f} to {max(ratios, default=np.nan):.0f} times later: {rk4.wrong} RK4 runs "
        "come to their end and are wrong. Implicit Euler with fixed steps meets the criterion in "
        f"{int(implicit.good.sum())} runs against {int(rk4.good.sum())}, irregularly; adaptive rodas4 is right to "
        f"{adaptive[0]:.1e} slips at v₀ = 0.1 mm/s with {adaptive[1]:.0f} steps for {END:g} s."
    )
    see = (
        "Good runs fill a wedge: its right edge is smoothing, the slanted one chatter, which runs along the dashed "
        "closed form and above it. Implicit Euler reaches further, with holes."
    )
    return Verdict(statement, see, findings)


def break_away(v0: float) -> float:
    """The largest friction at any speed [N]."""
    m = block().with_parameters(v0=v0)
    v = np.linspace(0.0, 30 * v0, 16001)[:, np.newaxis]
    return float(np.abs(m.generalized_force(np.zeros_like(v), v, np.zeros(1))).max())


def steady(v0: float) -> tuple[float, int]:
    """Adaptive rodas4: mean distance in slips, and steps."""
    run = dragged(v0, method="rodas4", rtol=1e-6, atol=1e-9)
    return distance(run), run.statistics.steps


STUDY = ParameterStudy(
    "How sharp may friction be, for which step?",
    f"A block of 1 kg is dragged by a spring of {SPRING:g} N/m that moves with {PULL} m/s, static friction "
    f"{STATIC:g} N, dynamic {DYNAMIC:g} N, for {END:g} s; the exact motion has friction that jumps.",
    SMOOTH,
    H,
    "mean distance from the exact motion over one slip [-]",
    BOUND,
    tuple(Subject(name, measure(name), (limit(LIMITS[name]),) if name in LIMITS else ()) for name in METHODS),
    judge,
    "adaptive rodas4 with v₀ a hundredth of the speeds that matter; with fixed explicit steps v₀ of F h/(2.8 m) at "
    "least, and look at the speed in the plot: chatter is not reported.",
    ("exact motion piece by piece; linear stability theory",),
)
