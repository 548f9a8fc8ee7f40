"""Beams in motion, from stiff to limp: one beam with its stated error against four joined end to end."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ..attack import Attack, Mechanism, Scene, Verdict, compared, decades, refused, undecided
from .beam_statics import NAMES, beam

# Stated errors are right within 2.2 in a swing of about one period, to the safe side; beyond, the phase runs away in
# proportion to the time. What carries no note may err by three times one per cent each period, with a floor for the
# modes of higher order that the coarse model lacks.
FACTOR, NOTED, FLOOR = 3.0, 0.01, 0.05
# First frequency of a cantilever over sqrt(EI/(rho L^4)).
_FIRST = 3.516
_PARTS = 4


@cache
def cantilever(parts: int) -> Mechanism:
    """The cantilever as so many beams; L is the length of all."""
    parameters = tuple(sf.Parameter(name, 1.0) for name in (*NAMES, "rho"))
    bodies = tuple(
        beam(
            f"beam{i}",
            sf.Joint(f"root{i}", "fixed", f"beam{i - 1}", "tip") if i else sf.Joint("root0", "fixed"),
            f"L/{parts}",
            3 if parts == 1 else 2,
            tip=i == parts - 1,
        )
        for i in range(parts)
    )
    return Mechanism(sf.System(f"cantilever{parts}", bodies, parameters, gravity=(0, 0, 0)))


_loads = st.one_of(st.just(0.0), st.builds(lambda m, e: m * 10.0**e, st.integers(1, 9), st.integers(-4, 0)))
_scenes = st.fixed_dictionaries(
    {
        "L": decades(-3, 3),
        "EI": decades(-3, 6),
        "rho": decades(-3, 3),
        "P": st.one_of(st.just(0.0), st.floats(-2.0, 1.2).map(lambda x: round(x, 3))),
        "F": _loads,
        "w": _loads,
        # Periods of the first mode.
        "span": st.sampled_from([0.5, 1.0, 2.0]),
        "method": st.sampled_from(["dopri5", "rk4", "rodas4", "generalized_alpha"]),
        # Over the first period, of methods with fixed steps.
        "step": st.sampled_from([0.001, 0.01, 0.1]),
    }
)


def _values(scene: Scene) -> dict[str, float]:
    L, EI = scene["L"], scene["EI"]
    force = EI / L**2
    P = scene["P"] * np.pi**2 / 4.0 * force
    return {
        "L": L,
        "EI": EI,
        "P": P,
        "F": scene["F"] * force,
        "w": scene["w"] * force / L,
        "rho": scene["rho"],
    }


def judge(scene: Scene) -> Verdict:
    """A swing from rest under sudden loads: the tips of both models at the same instants."""
    values = _values(scene)
    period = 2.0 * np.pi / _FIRST * float(np.sqrt(scene["rho"] * scene["L"] ** 4 / scene["EI"]))
    t_end = scene["span"] * period
    times = np.linspace(0.0, t_end, 9)
    fixed = scene["method"] in ("rk4", "generalized_alpha")
    stepping = {"dt": scene["step"] * period} if fixed else {"rtol": 1e-6, "atol": 1e-9 * scene["L"]}
    par = cantilever(1).par(**values)
    run = sf.simulate(
        cantilever(1).model, t_end=t_end, par=par, method=scene["method"], output=times, max_steps=20_000, **stepping
    )
    stated = max((bending.error for bending in run.bendings), default=0.0)
    beams_only = all("second-order theory" in note for note in run.outcome.notes)
    if not run.outcome.ok or not beams_only:
        return refused(run.outcome)
    fine = sf.simulate(
        cantilever(_PARTS).model,
        t_end=t_end,
        par=par,
        method="rodas4",
        rtol=1e-5,
        atol=1e-5 * scene["L"] * max(scene["F"] / 3.0 + scene["w"] / 8.0, 1e-9),  # Of the deflection.
        output=times,
        max_steps=4000,
    )
    bound = FACTOR * max(stated, NOTED) * max(1.0, 2.0 * scene["span"]) + FLOOR
    if fine.outcome.kind == "beyond theory":  # Parts of a beam bend less than the beam.
        errs = max(bending.error for bending in fine.bendings)
        return compared("error that four beams state", errs, bound, f"a run with a stated error of {stated:.3g}")
    if not fine.outcome.ok or fine.outcome.notes:
        return undecided(f"four beams: {fine.outcome}")
    tip, _ = run.frames["beam0.tip"]
    tip_of_four, _ = fine.frames[f"beam{_PARTS - 1}.tip"]
    largest = float(np.linalg.norm(tip_of_four - tip_of_four[0], axis=1).max())
    error = float(np.linalg.norm(tip - tip_of_four, axis=1).max()) / largest if largest else 0.0
    return compared("error of the tip's motion", error, bound, f"a run with a stated error of {stated:.3g}")


ATTACK = Attack(
    "beam_runs",
    "a run of a beam errs by no more than three times the error that it states, each period",
    "four beams joined end to end",
    _scenes,
    lambda scene: cantilever(1).at(**_values(scene)),
    judge,
)
