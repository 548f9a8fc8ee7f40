"""Rigid trees of any scale: the residual that our accelerations leave in Pinocchio's equations of motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ...adapters.pinocchio import tree as pinocchio
from ...contract.interface import States, Subject, Unsupported
from ...inputs.sampling import sample
from ...mechanics.assembly import assemble
from ..attack import Attack, Scene, Verdict, compared, decades, refused, undecided

# Share of the terms of a row that rounding may leave: half of the digits.
SHARE = 1e-8
_STATES = 4
_KINDS = ("revolute", "prismatic", "ball", "universal")
_AXES = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (1.0, 2.0, -0.5))

_bodies = st.fixed_dictionaries(
    {
        "kind": st.sampled_from(_KINDS),
        "parent": st.integers(0, 3),
        "mass": decades(-9, 9),
        "length": decades(-2, 2),
        # Square of the radius of gyration over that of the length.
        "gyration": decades(-6, 0),
        "axis": st.integers(0, len(_AXES) - 1),
        "offset": st.integers(0, 2),
    }
)
_scenes = st.fixed_dictionaries(
    {
        "bodies": st.lists(_bodies, min_size=1, max_size=4),
        "scale": decades(-6, 6),
        "speed": decades(-3, 3),
        "gravity": st.sampled_from([9.81, 0.0]),
        "way": st.sampled_from(["factors", "articulated"]),
        "seed": st.integers(0, 9),
    }
)


def system(scene: Scene) -> sf.System:
    """The tree."""
    bodies: list[sf.RigidBody] = []
    for i, one in enumerate(scene["bodies"]):
        parent = bodies[min(one["parent"], i) - 1].name if one["parent"] and i else "world"
        length = one["length"] * scene["scale"]
        more: dict[str, Any] = {"axis2": (0.2, -1.0, 0.5)} if one["kind"] == "universal" else {}
        place = (0.0, length, 0.5 * length) if bodies else (0.0, 0.0, 0.0)
        joint = sf.Joint(f"q{i}", one["kind"], parent, position=place, axis=_AXES[one["axis"]], **more)
        j = one["mass"] * one["gyration"] * length**2
        center = (one["offset"] * length, 0.0, 0.5 * one["offset"] * length)
        bodies.append(sf.RigidBody(f"b{i}", joint, sf.Inertia(one["mass"], center, (j, 1.5 * j, 2.0 * j))))
    return sf.System("tree", tuple(bodies), gravity=(0.0, 0.0, -scene["gravity"]))


def judge(scene: Scene) -> Verdict:
    """Our accelerations, by either way, put into Pinocchio's Newton-Euler."""
    stated = system(scene)
    engine = pinocchio.build(Subject("tree", stated))
    if isinstance(engine, Unsupported):
        return undecided(engine.reason)
    options = sf.Options(("forward_dynamics",), backend="interpreter", forward_dynamics=scene["way"])
    model, assembly = sf.compile(stated, options), assemble(stated)
    states = sample(assembly, model.nu, _STATES, scene["seed"], first=1)
    lengths = [one["length"] * scene["scale"] for one in scene["bodies"]]
    q, v = states.q.copy(), scene["speed"] * states.v
    for mover in assembly.movers:
        if mover.kind == "prismatic":
            q[:, mover.q] *= sum(lengths)
            v[:, mover.v] *= sum(lengths)
    states = replace(states, q=q, v=v)
    a = model.forward_dynamics(q, v, states.u)
    if not np.all(np.isfinite(a)):
        return refused("not a number: M has no factors in doubles")
    left = engine.inverse_dynamics(_with(states, a))
    M = engine.mass_matrix(states)
    root = np.sqrt(np.einsum("nii->ni", M))
    # Forces of row i are at most sqrt(M_ii) times the root of the masses times their largest acceleration.
    total = sum(one["mass"] for one in scene["bodies"])
    spin = 4.0 * np.abs(v).max(axis=1) if not all(m.kind == "prismatic" for m in assembly.movers) else 0.0 * v[:, 0]
    fastest = scene["gravity"] + 6.0 * sum(lengths) * spin**2
    terms = root * ((root * np.abs(a)).sum(axis=1) + np.sqrt(total) * fastest)[:, None]
    share = float(np.max(np.where(np.abs(left) <= 1e-300, 0.0, np.abs(left) / np.maximum(terms, 1e-300))))
    return compared("residual over the terms of its row", share, SHARE, f"accelerations by {scene['way']}")


def _with(states: States, a: np.ndarray) -> States:
    return replace(states, a=a, applied=np.zeros_like(a), passive=np.zeros_like(a))


ATTACK = Attack(
    "rigid_trees",
    "accelerations solve the equations of motion: each row is met to half of the digits of its terms",
    "Pinocchio: Newton-Euler and composite bodies",
    _scenes,
    system,
    judge,
)
