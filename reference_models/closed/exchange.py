"""The paper's task (its introduction): one arm takes hold of a station, the other exchanges a part there.

The two-armed manipulator of `two_arms` without a payload; two parts that float free unless something holds them: the
worn one at its worksite, the spare one in a rack. Each may be held by the hand, and by two places of the station; each
of these seven constraints holds where its parameter is 1, at the pose of the moment in which it engages.
"""

from __future__ import annotations

from typing import Literal

import symofros as sf

from ..rigid.station import two_arm_bodies
from .two_arms import HOLD, PICK, hand, mount

# Joint angles of the right arm where its hand is at a place [rad], q1 to q7.
WORKSITE = PICK
STOWAGE = (0.2, 0.4, 0.5, -1.0, 0.3, 0.1, 0.2)
RACK = (-0.2, -0.5, 0.8, -1.6, 0.4, 0.0, 0.0)
# Part -> its mass [kg], where it is at first, and where it may be put.
PARTS = {"worn": (200.0, "worksite", "stowage"), "spare": (180.0, "rack", "worksite")}
_AXES: tuple[Literal["x", "y", "z"], ...] = ("x", "y", "z")


def exchange() -> sf.System:
    """Six springs, a trunk, two arms, two free parts of six speeds each; seven constraints of six conditions."""
    places = {"point": (HOLD, 1.0), "worksite": (WORKSITE, -1.0), "stowage": (STOWAGE, -1.0), "rack": (RACK, -1.0)}
    poses = {name: hand(angles, side) for name, (angles, side) in places.items()}
    station = sf.RigidBody(
        "station", None, frames=tuple(sf.Frame(name, p, sf.Rotation.matrix(R)) for name, (p, R) in poses.items())
    )
    parts = tuple(_part(name, mass, first) for name, (mass, first, _) in PARTS.items())
    held = [_held("stabilised", ("station", "point"), ("spdm_left_link7", "end"))]
    for name, (_, *sites) in PARTS.items():
        handle = (name, f"{name}_handle")
        held.append(_held(f"{name}_in_hand", ("spdm_right_link7", "end"), handle))
        held += [_held(f"{name}_at_{site}", ("station", site), handle) for site in sites]
    at_first = {f"{name}_at_{first}" for name, (_, first, _) in PARTS.items()}
    return sf.System(
        "exchange",
        (station, *mount(), *two_arm_bodies("mount", None), *parts),
        tuple(sf.Parameter(f"{one.name}_on", float(one.name in at_first)) for one in held),
        gravity=(0.0, 0.0, 0.0),
        constraints=tuple(held),
        switches=tuple(sf.Switch(one.name, f"{one.name}_on", "moment") for one in held),  # type: ignore[arg-type]
    )


def _part(name: str, mass: float, place: str) -> sf.RigidBody:
    """A box of half a metre to a metre, with a handle at one side."""
    inertia = sf.Inertia(mass, (0.4, 0.0, 0.0), (0.15 * mass, 0.175 * mass, 0.175 * mass))
    joint = sf.Joint(name, "free", "station", place)
    return sf.RigidBody(name, joint, inertia, (sf.Frame(f"{name}_handle"), sf.Frame(f"{name}_center", (0.4, 0, 0))))


def _held(name: str, where: tuple[str, str], what: tuple[str, str]) -> sf.Closure:
    return sf.Closure(name, where, what, _AXES, _AXES)
