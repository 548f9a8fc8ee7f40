"""A beam that spins above its first frequency, with and without foreshortening."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import symofros as sf

from ...reporting.findings import Finding
from ..reference import data, source
from ..study import Cell, Grid, Limit, Maps, ParameterStudy, Subject, Verdict, cell, simulate

END = 30.0
BOUND = 10.0
MODELS: dict[str, dict[str, Any]] = {
    "foreshortened, first order": {},
    "without foreshortening": {"retain": "all", "foreshortening": False},
    "zeroth order": {"retain": "zeroth_order"},
}
WITHOUT = "without foreshortening"
CRITICAL = 3.51601526850015
ETA = Grid(
    "speed η = Ω √(ρA L⁴/EI) [-]",
    (*(0.5 * k for k in range(7)), 3.25, 3.4, 3.6, 3.75, *(0.5 * k for k in range(8, 17))),
    (1.0, 3.0, 4.0, 8.0),
    log=False,
)
HUB = Grid("hub radius r/L [-]", (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0), (0.0, 1.0), log=False)


@cache
def beam(name: str) -> sf.Model:
    """On a hub of radius "r" whose turn is given, bending in the plane of rotation; all its constants are one."""
    hub = sf.RigidBody("hub", sf.Joint("turn", "revolute", prescribed=True))
    root = sf.Joint("root", "fixed", "hub", position=(sf.formula("r", "radius"), 0.0, 0.0))
    blade = sf.Beam("b", root, 1.0, 1.0, EI_z=1.0, bend_y=2, family="clamped_free", **MODELS[name])
    return sf.compile(sf.System("spin", (hub, blade), gravity=(0, 0, 0), parameters=(sf.Parameter("r", 0.0),)))


def run(name: str, eta: float, hub: float) -> sf.Trajectory:
    """Let go from a thousandth of its length, in its first mode."""
    m = beam(name).with_parameters(r=hub)
    start = np.zeros(m.nq)
    start[0] = 1e-3
    return simulate(m, start, t_end=END, u={"turn": f"{eta!r}*t"}, method="dop853", rtol=1e-9, atol=1e-15, output=0.05)


def measure(name: str) -> Callable[[float, float], Cell]:
    """Largest deflection over that at the start."""
    return lambda eta, hub: cell(run(name, eta, hub), lambda done: float(np.abs(done.q).max() / done.q[0, 0]))


def rate(eta: float) -> float:
    """Growth without foreshortening, from the last tenth of a run that stays small [1/s]."""
    done = run(WITHOUT, eta, 0.0)
    grown = np.abs(done.q[:, 0]) / np.abs(done.q[0, 0])
    seen = np.flatnonzero((grown > 1e2) & (grown < 1e6))
    return float(np.polyfit(done.t[seen], np.log(grown[seen]), 1)[0]) if len(seen) > 2 else float("nan")


def judge(maps: Maps) -> Verdict:
    """The speed of divergence and the rate of growth."""
    without = maps[WITHOUT]
    missed = without.miss("x", lambda hub: CRITICAL)
    known = {row["eta"]: row["growth_rate"] for row in data("spin")["rows"] if row["eta"] in (4.0, 6.0)}
    rates = {eta: rate(eta) for eta in known}
    apart = max(abs(rates[eta] / known[eta] - 1.0) for eta in known)
    stiff, ruthless = maps["foreshortened, first order"], maps["zeroth order"]
    edges = [low for _, low, _ in without.edge("x")], [high for _, _, high in without.edge("x")]
    findings = (
        Finding(
            "without foreshortening: factor by which η = 3.516 misses the edge of the map",
            missed,
            1.01,
            reason="the first frequency at rest, whatever the hub",
        ),
        Finding(
            "rates of growth at η = 4 and 6 against the known ones, relative", apart, 1e-3, reason="√(η² - 3.516²)"
        ),
        Finding("foreshortened: share of the map that is bounded", float(stiff.good.mean()), 1.0, 1.0, "it stiffens"),
        Finding("zeroth order: the same", float(ruthless.good.mean()), 1.0, 1.0, "it neither stiffens nor softens"),
    )
    statement = (
        "Without foreshortening the softening term of rotation is kept and the stiffening one lost: between η = "
        f"{max(edges[0], default=0.0):g} and {min(edges[1], default=0.0):g}, for every hub, the beam begins to fly "
        f"away, at a rate of {rates[6.0]:.2f} /s at η = 6, where a real one only gets stiffer. {without.wrong} of "
        f"{without.values.size} such runs come to their end with deflections up to {np.nanmax(without.values):.0e} "
        f"times the first; {without.stopped} stop. With foreshortening all {stiff.values.size} stay bounded; zeroth "
        "order, too, at the frequency of rest."
    )
    see = (
        "Only the map without foreshortening has an edge, upright on the dashed line at the first frequency: it "
        "does not depend on the hub."
    )
    return Verdict(statement, see, findings)


def limits(name: str) -> tuple[Limit, ...]:
    """Where the wrong model diverges."""
    return (
        (Limit("η = 3.516", np.array([CRITICAL, CRITICAL]), lambda _: np.array([-1.0, 3.0])),)
        if name == WITHOUT
        else ()
    )


STUDY = ParameterStudy(
    "What becomes of a beam that spins above its first frequency?",
    f"A beam on a turning hub, let go from 0.001 L in the plane of rotation for {END:g} units of time √(ρA L⁴/EI).",
    ETA,
    HUB,
    "largest deflection over that at the start [-]",
    BOUND,
    tuple(Subject(name, measure(name), limits(name)) for name in MODELS),
    judge,
    "foreshortening, which is the default; or retain: zeroth_order where rotation is slow. Foreshortening off with "
    "first order is for studies, and a warning says so.",
    (source("spin"),),
)
