"""Chains whose last body weighs up to 1e8 times, or 1e-8 of, the others: accelerations against many digits."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Literal, cast

import numpy as np

import symofros as sf

from ...adapters import factory_of
from ...adapters.exact import accelerations
from ...contract.interface import EngineFactory, States, TreeEngine, Unsupported
from ...contract.interface import Subject as Model
from ...mechanics.geometry import Array
from ...reporting.findings import Finding
from ..study import Cell, Grid, Maps, ParameterStudy, Subject, Verdict, cell, decades, simulate

BOUND = 1e-8
GRAVITY = 9.81
# Of each point, because engines want one; a number of few binary digits.
MOMENT = 1 / 64
RATIO = Grid("mass of the last link over the others' [-]", decades(1e-8, 1e8, 1), (1e-8, 1.0, 1e8))
LINKS = Grid("links [-]", (2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0), (2.0, 6.0))
ARTICULATED, FACTORS = "symofros, articulated bodies", "symofros, factors of M"
WAYS: dict[str, Literal["articulated", "factors"]] = {ARTICULATED: "articulated", FACTORS: "factors"}
DRIFT = "symofros, energy over 1 s"
PINOCCHIO, MUJOCO = "Pinocchio, accelerations", "MuJoCo, accelerations"
ENGINES = {PINOCCHIO: "pinocchio", MUJOCO: "mujoco"}
# Steps of DOP853 for a second.
MOST = 20000


def chain(links: int, ratio: float | sf.Expression) -> sf.System:
    """Points of 1 kg at the ends of rods of 1 m; the last has the mass "ratio"."""
    bodies, parent, frame = [], "world", None
    for i in range(links):
        mass = ratio if i == links - 1 else 1.0
        joint = sf.Joint(f"q{i}", "revolute", parent, frame, axis=(0, 1, 0))
        bodies.append(
            sf.RigidBody(f"b{i}", joint, sf.Inertia(mass, (1, 0, 0), (MOMENT,) * 3), (sf.Frame("end", (1, 0, 0)),))
        )
        parent, frame = f"b{i}", "end"
    parameters = () if isinstance(ratio, float) else (sf.Parameter("ratio", 1.0),)
    return sf.System(f"chain{links}", tuple(bodies), parameters=parameters)


@cache
def compiled(links: int, way: Literal["auto", "articulated", "factors"] = "auto") -> sf.Model:
    """Compiled model of the chain of links, with the mass ratio as a parameter."""
    return sf.compile(chain(links, sf.formula("ratio", "mass")), sf.Options(forward_dynamics=way))


@cache
def state(links: int) -> tuple[Array, Array]:
    """A bent chain in motion; the numbers have few binary digits, so that every precision sees the same."""
    rng = np.random.default_rng(links)
    return np.round(rng.uniform(-1, 1, links) * 64) / 64, np.round(rng.uniform(-1, 1, links) * 64) / 64


@cache
def exact(links: int, ratio: float) -> Array:
    """Accelerations by the truth of many digits (links)."""
    q, v = state(links)
    return accelerations(Model("chain", chain(links, ratio)), q, v, np.zeros(links))


def error(a: Array, links: int, ratio: float) -> Cell:
    """Relative to the largest acceleration."""
    expected = exact(links, ratio)
    if not np.isfinite(a).all():
        return Cell(math.nan, "singular", "accelerations are not finite")
    return Cell(float(np.abs(a - expected).max() / np.abs(expected).max()))


def own_engine(way: Literal["articulated", "factors"]) -> Callable[[float, float], Cell]:
    """The C, by either way of forward dynamics."""

    def run(ratio: float, links: float) -> Cell:
        n = int(links)
        a = compiled(n, way).with_parameters(ratio=ratio).forward_dynamics(*state(n), np.zeros(0))
        return error(a, n, ratio)

    return run


def other_engine(engine: str) -> Callable[[float, float], Cell]:
    """An engine's forward dynamics."""

    def run(ratio: float, links: float) -> Cell:
        n = int(links)
        factory = cast(EngineFactory, factory_of(engine))
        built = factory(Model("chain", chain(n, ratio)))
        if isinstance(built, Unsupported):
            raise ArithmeticError(f"{engine}: {built.reason}")
        tree = cast(TreeEngine, built)
        q, v = (x[None] for x in state(n))
        zero = np.zeros_like(v)
        states = States(q, v, zero, np.zeros((1, 0)), zero, zero)
        return error(tree.forward_dynamics(states)[0], n, ratio)

    return run


def drift(ratio: float, links: float) -> Cell:
    """Change of energy over a second of fall, relative to the potential energy exchanged."""
    n = int(links)
    m = compiled(n).with_parameters(ratio=ratio)
    run = simulate(m, *state(n), t_end=1.0, method="dop853", rtol=1e-12, atol=1e-14, max_steps=MOST)

    def change(done: sf.Trajectory) -> float:
        exchanged = max(float(np.ptp(done.potential_energy)), 1e-300)
        return float(np.abs(done.energy - done.energy[0]).max()) / exchanged

    return cell(run, change)


def judge(maps: Maps) -> Verdict:
    """Verdict on digits lost to mass ratios."""
    worst = {name: float(np.nanmax(runs.values)) for name, runs in maps.items()}
    heavy = {name: float(np.nanmax(runs.values[:, -1])) for name, runs in maps.items() if name != DRIFT}
    light = {name: float(np.nanmax(runs.values[:, 0])) for name, runs in maps.items()}
    slow = maps[DRIFT].count("interrupted")
    findings = (
        Finding(
            "symofros, articulated bodies: largest error of accelerations",
            worst[ARTICULATED],
            1e-7,
            reason="sixteen links, 1e8",
        ),
        Finding("symofros, factors: largest error of accelerations", worst[FACTORS], 1e-4, reason="sixteen links, 1e8"),
        Finding(
            "symofros, factors, over MuJoCo: ratio of largest errors",
            worst[FACTORS] / worst[MUJOCO],
            10.0,
            reason="both factor the mass matrix",
        ),
        Finding(
            "symofros, articulated bodies, over Pinocchio: ratio of largest errors",
            worst[ARTICULATED] / worst[PINOCCHIO],
            10.0,
            reason="neither forms the mass matrix",
        ),
        Finding(
            "articulated bodies over factors: ratio of our largest errors",
            worst[ARTICULATED] / worst[FACTORS],
            0.05,
            reason="what is large cancels link by link",
        ),
        Finding("symofros: largest change of energy in runs that end", worst[DRIFT], 1e-6, reason="tolerance 1e-12"),
    )
    statement = (
        "A heavy load on light links costs digits: the light links' accelerations are small differences of large "
        f"forces. Largest errors with a load of 1e8: by factors of the mass matrix ours {heavy[FACTORS]:.0e}, MuJoCo "
        f"{heavy[MUJOCO]:.0e}; by articulated bodies, which never form it, ours {heavy[ARTICULATED]:.0e}, Pinocchio "
        f"{heavy[PINOCCHIO]:.0e}. With a last link of 1e-8 they are {light[FACTORS]:.0e}, {light[MUJOCO]:.0e}, "
        f"{light[ARTICULATED]:.0e} and {light[PINOCCHIO]:.0e}. In motion energy is kept to {worst[DRIFT]:.0e} over a "
        "second, but tension makes the light links ring as the root of the ratio: "
        f"{slow} runs were cut at {MOST} steps."
    )
    see = (
        "From a ratio of one to the right, errors grow a decade of error a decade of load; by factors also with the "
        "number of links, two decades and more above articulated bodies. To the left nothing happens. In the last map "
        "red cells are runs that take too many steps."
    )
    return Verdict(statement, see, findings)


STUDY = ParameterStudy(
    "Which mass ratios can a chain bear?",
    "Points of 1 kg on rods of 1 m, hinged into a chain; the last is heavier or lighter. Accelerations of one bent "
    "posture in motion against the truth of many digits; and a second of fall.",
    RATIO,
    LINKS,
    "relative error [-]",
    BOUND,
    (
        *(Subject(name, own_engine(way)) for name, way in WAYS.items()),
        *(Subject(name, other_engine(engine)) for name, engine in ENGINES.items()),
        Subject(DRIFT, drift),
    ),
    judge,
    "up to 1e5 nothing: eight digits are left in any case. Beyond it choose articulated bodies, "
    "sf.Options(forward_dynamics='articulated'); in motion leave the light links out, or carry the load by a joint "
    "nearer to the base.",
    ("exact accelerations: the truth of engines, of many digits (validation/engines/truth)",),
)
