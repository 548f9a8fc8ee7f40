"""Bennett's linkage: five conditions of which the rank is three beside the manifold and less by one on it."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import symofros as sf

from ...mechanics.geometry import Array
from ..attack import Attack, Mechanism, Scene, Verdict, refused
from ..motion import claim_verdict

# Twists of the links; lengths are their sines, which makes the linkage move.
ALPHA, BETA = 0.6, 1.1
# Error of the angle over its way.
STRAYED = 0.03
_ADAPTIVE = ("dopri5", "dop853", "rodas4", "ida")


def _link(name: str, parent: str, twist: float) -> sf.RigidBody:
    length = float(np.sin(twist))
    end = sf.Frame("end", (length, 0, 0), sf.Rotation.rpy(twist, 0, 0))
    solid = sf.Inertia(1.0, (0.5 * length, 0, 0), (0.02, 0.1, 0.1))
    joint = sf.Joint(f"{name}_angle", "revolute", parent, "end" if parent != "world" else None)
    return sf.RigidBody(name, joint, solid, (end,))


@cache
def bennett() -> Mechanism:
    """Three links that move, the fourth at rest: the axes of its ends, and of no weight."""
    # The frame before the last joint, seen from the first one's: x back along the fourth link, turned by its twist.
    length = float(np.sin(BETA))
    pivot = sf.Frame("pivot", (-length, 0, 0), sf.Rotation.rpy(-BETA, 0, 0))
    bodies = (
        sf.RigidBody("ground", frames=(pivot,)),
        _link("a", "world", ALPHA),
        _link("b", "a", BETA),
        _link("c", "b", ALPHA),
    )
    loop = sf.Closure("loop", ("ground", "pivot"), ("c", "end"), ("x", "y", "z"), ("x", "y"))
    return Mechanism(sf.System("bennett", bodies, gravity=(0, 0, 0), constraints=(loop,)))


def angles(first: Array) -> Array:
    """The joints' angles (..., 3) at angles of the first: tan(a/2) tan(b/2) is constant, opposite ones add to 0."""
    ratio = np.sin(0.5 * (ALPHA + BETA)) / np.sin(0.5 * (BETA - ALPHA))
    half = 0.5 * np.asarray(first)
    second = 2.0 * np.arctan2(ratio * np.cos(half), np.sin(half))
    return np.stack([np.asarray(first), np.unwrap(np.atleast_1d(second)).reshape(second.shape), -np.asarray(first)], -1)


def _slopes(first: float) -> Array:
    h = 1e-5
    return np.asarray((angles(np.array(first + h)) - angles(np.array(first - h))) / (2.0 * h))


_scenes = st.fixed_dictionaries(
    {
        "method": st.sampled_from(["rk4", "dopri5", "dop853", "rodas4", "generalized_alpha", "ida"]),
        "step": st.sampled_from([1e-3, 2e-3, 5e-3, 1e-2]),
        "speed": st.sampled_from([1.0, 3.0, 0.1]),
        "angle": st.sampled_from([1.0, 0.3, 2.5, -1.0]),
        "span": st.sampled_from([1.0, 4.0]),
        # Off the manifold by so much, as records of files are.
        "off": st.sampled_from([0.0, 1e-9, 1e-7]),
    }
)


def judge(scene: Scene) -> Verdict:
    """The first angle at the end against that of one freedom, whose energy is constant."""
    model = bennett().model
    q = angles(np.array(scene["angle"]))
    v = scene["speed"] * _slopes(scene["angle"])
    gap = float(np.abs(model.constraint(q)).max())
    if gap > 1e-9:
        raise AssertionError(f"the linkage is not closed: {gap:.3g}")
    options: dict[str, Any] = {} if scene["method"] in _ADAPTIVE else {"dt": scene["step"]}
    start = q + scene["off"] * np.array([1.0, -1.0, 1.0])
    run = sf.simulate(model, start, v, scene["span"], method=scene["method"], max_steps=100_000, **options)
    if not run.outcome.ok:
        return refused(run.outcome)

    def rate(_: float, y: Array) -> list[float]:
        slope = _slopes(float(y[0]))
        return [float(np.sqrt(twice_T / (slope @ model.mass_matrix(angles(y[0])) @ slope)))]

    twice_T = float(v @ model.mass_matrix(q) @ v)
    exact = solve_ivp(rate, (0.0, scene["span"]), [scene["angle"]], rtol=1e-11, atol=1e-12).y[0, -1]
    error = abs(float(run.q[-1, 0]) - float(exact)) / (scene["speed"] * scene["span"])
    return claim_verdict(run.outcome, "error of the first angle", error, STRAYED)


ATTACK = Attack(
    "overconstrained_runs",
    "a run of a linkage with redundant conditions errs by less than three hundredths of its way, or says so; if it is "
    "right it says nothing",
    "its one freedom in closed form, at constant energy",
    _scenes,
    lambda _: bennett().system,
    judge,
)
