"""A seven-joint arm whose two long links bend in both planes and twist, every parameter at run time."""

from __future__ import annotations

from typing import Any

import symofros as sf

_AXES = ((0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0))
_BEAMS = (1, 3)
_SECTION = {"EI_z": 4000.0, "EI_y": 4000.0, "GJ": 3000.0, "rhoJ": 0.002}


def flexible_arm(bending: int = 3, twist: int = 1) -> sf.System:
    """The arm.

    Source: ours, to have a measure of generation and compilation: an industrial arm's layout, links of slender tube.

    Args:
        bending: Shape functions of each beam in each plane.
        twist: Shape functions of each beam in twist.
    """
    bodies: list[sf.Body] = []
    parameters: dict[str, float] = {}
    parent: str = "world"
    frame: str | None = None
    for i, axis in enumerate(_AXES):
        joint = sf.Joint(f"q{i + 1}", "revolute", parent, frame, axis=axis, actuated=True)
        name = f"link{i + 1}"
        if i in _BEAMS:
            values = {"L": 0.8, "rhoA": 3.0, "tau": 0.001, **_SECTION}
            named = {key: f"{key}{i + 1}" for key in values}
            stated: dict[str, Any] = {key: named[key] for key in _SECTION} | {"damping": named["tau"]}
            stated |= {"bend_y": bending, "bend_z": bending, "twist": twist}
            length, rhoA = sf.formula(named["L"]), sf.formula(named["rhoA"])
            bodies.append(sf.Beam(name, joint, length, rhoA, **stated, frames=(sf.Frame("end"),)))
        else:
            values = {"m": 4.0 / (i + 1), "c": 0.1, "J": 0.04 / (i + 1), "a": 0.2}
            named = {key: f"{key}{i + 1}" for key in values}
            m, c, J, a = (sf.formula(named[key]) for key in values)
            end = sf.Frame("end", (a, 0.0, 0.0))
            bodies.append(sf.RigidBody(name, joint, sf.Inertia(m, (c, 0.0, 0.0), (J, J, J)), (end,)))
        parameters |= {named[key]: value for key, value in values.items()}
        parent, frame = name, "end"
    return sf.System("flexible_arm", tuple(bodies), tuple(sf.Parameter(*item) for item in parameters.items()))
