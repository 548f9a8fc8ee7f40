"""Rolling discs of any size, tilt and step: energy, and finer runs."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ..attack import Attack, Mechanism, Scene, Verdict, decades, inertia
from ..motion import against_finer

_PARAMETERS = tuple(sf.Parameter(name, 1.0) for name in ("r", "m"))


@cache
def disc() -> Mechanism:
    """A thin disc on the plane z = 0."""
    mass_properties = inertia("m", (0, 0, 0), ("m*r^2/4", "m*r^2/4", "m*r^2/2"))
    body = sf.RigidBody("disc", sf.Joint("pose", "free"), mass_properties)
    contact = sf.Rolling("contact", ("disc", None), sf.formula("r"))
    return Mechanism(sf.System("disc", (body,), _PARAMETERS, constraints=(contact,)))


_scenes = st.fixed_dictionaries(
    {
        "r": decades(-4, 4),
        "m": decades(-6, 6),
        # Tilt of the axle from the vertical: near zero the disc lies flat.
        "tilt": st.sampled_from([1.2, 0.7, 0.3, 0.1, 1.5]),
        # Over sqrt(g/r).
        "spin": st.sampled_from([0.0, 1.0, 5.0, -3.0, 20.0]),
        "turn": st.sampled_from([0.0, 0.5, -2.0, 5.0]),
        "method": st.sampled_from(["rk4", "dopri5", "semi_implicit_euler", "rodas4", "generalized_alpha"]),
        # Over sqrt(r/g).
        "step": decades(-3, 0),
        "span": st.sampled_from([1.0, 3.0]),
    }
)


def judge(scene: Scene) -> Verdict:
    """A run from a rolling start."""
    model, par, r = disc().model, disc().par(**scene), scene["r"]
    unit, tilt = float(np.sqrt(r / 9.81)), scene["tilt"]
    q = np.array([0, 0, r * np.sin(tilt), np.sin(tilt / 2), 0, 0, np.cos(tilt / 2)])
    spin, turn = scene["spin"] / unit, scene["turn"] / unit
    wish = np.array([0, 0, 0, 0, turn * np.sin(tilt), turn * np.cos(tilt) + spin])
    held = tuple(name for name in model.names.v[3:])
    at = sf.assemble(model, q, wish, held=held, par=par)
    options = {"dt": scene["step"] * unit} if scene["method"] not in ("dopri5", "rodas4") else {}
    run = sf.simulate(
        model, at.q, at.v, scene["span"] * unit, par=par, method=scene["method"], max_steps=4000, **options
    )
    return against_finer(model, run, par, min(1.0, r))


ATTACK = Attack(
    "rolling_runs",
    "a run without a note keeps its energy and errs by less than three tenths",
    "energy, the eighth-order method at 1e-10",
    _scenes,
    lambda scene: disc().at(**scene),
    judge,
)
