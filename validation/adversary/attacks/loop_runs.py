"""Runs of closed loops of any size, near their singular postures too: closed records, energy, finer runs."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ...mechanics.geometry import Array
from ..attack import (
    Attack,
    Mechanism,
    Scene,
    Verdict,
    along,
    compared,
    decades,
    inertia,
    refused,
    worst,
)
from ..motion import against_finer, claimed_good

# Residual of the loop over its size that records may have: what projection leaves.
CLOSED = 1e-6
_PARAMETERS = tuple(sf.Parameter(name, 1.0) for name in ("L", "a", "m"))


def _bar(name: str, joint: sf.Joint, length: str, mass: str) -> sf.RigidBody:
    j = f"({mass})*({length})^2/12"
    mass_properties = inertia(mass, (f"{length}/2", 0, 0), (f"{j}/100", j, j))
    return sf.RigidBody(name, joint, mass_properties, (sf.Frame("end", along(length)),))


@cache
def four_bar() -> Mechanism:
    """Crank a L, coupler L, rocker L on a ground of length L."""
    axis = (0, -1, 0)
    bodies = (
        _bar("crank", sf.Joint("q1", "revolute", axis=axis), "a*L", "m"),
        _bar("coupler", sf.Joint("q2", "revolute", "crank", "end", axis=axis), "L", "m"),
        _bar("rocker", sf.Joint("q3", "revolute", position=along("L"), axis=axis), "L", "2*m"),
    )
    loop = sf.Closure("loop", ("rocker", "end"), ("coupler", "end"), ("x", "z"))
    return Mechanism(sf.System("four_bar", bodies, _PARAMETERS, constraints=(loop,)))


_scenes = st.fixed_dictionaries(
    {
        "L": decades(-4, 4),
        "m": decades(-6, 6),
        # Crank over the other bars: at one the bars fold onto a line.
        "a": st.sampled_from([0.5, 0.9, 0.99, 0.9999, 1.0]),
        "angle": st.sampled_from([1.2, 0.3, 0.01, -1.0, 2.5, 3.1]),
        # Turns of the crank, over sqrt(g/L).
        "speed": st.sampled_from([0.0, 1.0, -3.0, 10.0]),
        "method": st.sampled_from(["rk4", "dopri5", "semi_implicit_euler", "generalized_alpha", "rodas4"]),
        # Step over sqrt(L/g).
        "step": decades(-3, 0),
        "records": st.sampled_from([7, 3, 40]),
        # Span of time over sqrt(L/g).
        "span": st.sampled_from([1.0, 3.0]),
    }
)


def judge(scene: Scene) -> Verdict:
    """A run with an interval of output: records on the loop, from which one can go on; energy; a finer run."""
    model, par, L = four_bar().model, four_bar().par(**scene), scene["L"]
    unit = float(np.sqrt(L / 9.81))
    angle, speed = scene["angle"], scene["speed"] / unit
    guess = np.array([angle, -angle + 0.3, 1.2 * angle])
    at = sf.assemble(model, guess, [speed, -speed, speed], held=("q1",), par=par)
    t_end = scene["span"] * unit
    output = np.linspace(0.0, t_end, scene["records"])
    options = {"dt": scene["step"] * unit} if scene["method"] not in ("dopri5", "rodas4") else {}
    run = sf.simulate(
        model, at.q, at.v, t_end, par=par, method=scene["method"], output=output, max_steps=4000, **options
    )
    if not claimed_good(run):
        return refused(run.outcome)
    return worst(_closed(model, run, par, L), against_finer(model, run, par, 1.0, (at.q, at.v)))


def _closed(model: sf.Model, run: sf.Trajectory, par: Array, L: float) -> Verdict:
    gap = float(np.abs(model.constraint(run.q, par=par)).max())
    verdict = compared("gap of the loop in a record", gap, CLOSED * L, f"'{run.outcome}'")
    try:
        sf.simulate(model, run.q[-1], run.v[-1], 1e-9, par=par, dt=1e-9)
    except sf.AssemblyError as error:
        return compared("records that no run goes on from", 1.0, 0.0, str(error).partition("\n")[0])
    return verdict


ATTACK = Attack(
    "loop_runs",
    "a run without a note keeps its loops in every record, its energy, and errs by less than three tenths",
    "the constraint at the records, energy, the eighth-order method at 1e-10",
    _scenes,
    lambda scene: four_bar().at(**scene),
    judge,
)
