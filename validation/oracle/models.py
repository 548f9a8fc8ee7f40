"""Small models that between them have everything a description may state.

What the generator would compute ahead, in double precision, and could not hold exactly (unit vectors, sines, quotients
of numbers) is made of run-time parameters: no rounding enters, and agreement to all digits can be asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import symofros as sf

from ..references import MODELS as REFERENCE

# Far more digits than an agreement by chance or in double precision could show; far fewer than are computed with.
EXACT = 30.0
# A constant axis is normalised in double precision when the code is generated, 16 digits; cancellation takes some.
ROUNDED = 14.0


@dataclass(frozen=True)
class Model:
    """A system for the oracle.

    Attributes:
        system: The description.
        digits: Digits that generator and oracle must agree to.
    """

    system: sf.System
    digits: float = EXACT


# Constructors turn text into formulas; their types say what they keep, not what they take.
_s: Any = sf

_VALUES = {"m": 1.5, "a": 0.25, "J": 0.375, "k": 2.75, "n1": 1.0, "n2": -2.0, "n3": 0.5}
_PAR = tuple(sf.Parameter(name, value) for name, value in _VALUES.items())
_SOLID = _s.Inertia("m", ("a", 0.125, "-a/2"), ("J", "2*J", "1.5*J", "J/8", 0, "-J/4"))
_ROUND = _s.Inertia("m", (0, "a", 0), ("J", "J", "J"))
_FLAT = _s.Inertia("m", ("a", 0, 0), ("J", 0, "J"))
_AXIS = ("n1", "n2", "n3")


def _joint(i: int, **stated: Any) -> sf.Joint:
    usual: dict[str, Any] = {
        "name": f"q{i}",
        "kind": "revolute",
        "parent": f"b{i - 1}" if i else "world",
        "position": ("a", 0, 0.5),
    }
    return sf.Joint(**{**usual, **stated})


def _chain(*bodies: tuple[dict[str, Any], sf.Inertia | None], **more: Any) -> sf.System:
    """Bodies in series."""
    listed = tuple(sf.RigidBody(f"b{i}", _joint(i, **stated), inertia) for i, (stated, inertia) in enumerate(bodies))
    return sf.System("s", listed, _PAR, **{"gravity": (1.0, -2.0, -9.5), **more})


def _with(system: sf.System, index: int, **more: Any) -> sf.System:
    """The system with fields of one body replaced."""
    return system.with_bodies(replace(system.bodies[index], **more))


def _branched() -> sf.System:
    """Two arms on a turntable, and a body fixed at an angle."""
    side = _s.Frame("side", (0, "a", 0), _s.Rotation.rpy("a", 0, "k"))
    stem = sf.RigidBody("stem", _s.Joint("turn", "revolute"), _FLAT, (side,))
    left = sf.RigidBody("left", _s.Joint("left", "revolute", "stem", "side", axis=(0, 1, 0)), _FLAT)
    lid = sf.RigidBody(
        "lid",
        _s.Joint("lid", "fixed", "left", position=("a", 0, 0), rotation=_s.Rotation.quaternion("n1", "a", "n2", "k")),
        _SOLID,
    )
    right = sf.RigidBody(
        "right",
        _s.Joint("right", "prismatic", "stem", axis=(0, 1, 0)),
        _s.Inertia("m", ("a", 0, 0), ("J", "2*J", "2*J", "J/4", 0, 0), "body"),
    )
    return sf.System("s", (stem, left, right, lid), _PAR)


def _forces() -> sf.System:
    friction = _s.Friction("J", "k", 0.125, "a"), _s.Friction("J", "k", "a", stribeck_velocity="m")
    return _chain(
        ({"elements": (_s.Spring("k", "a", "k/4"), _s.Damper("m", "a"), friction[0]), "actuated": True}, _ROUND),
        (
            {
                "axis": (0, 1, 0),
                "effort": ("u1*sin(q0) - k*abs(dq1) + t",),
                "actuated": True,
                "elements": (_s.Stop("k", "m", -0.0625, 0.03125), friction[1]),
            },
            _ROUND,
        ),
        inputs=[sf.Input("u1")],
        virtual_power=[_s.VirtualPower("p", {"dq0": "k*(q1 - q0)", "dq1": "-k*(q1 - q0)"})],
        potentials=[_s.Potential("v", "k*sin(q0)*q1^2 + t*q1")],
    )


def _loads() -> sf.System:
    """Each point and axes that a load can have."""
    force, torque = ("u1", "k*q0", "-t"), ("dq1", "m", "u1*q1")
    frame = _s.Frame("tip", ("a", 0.5, 0), _s.Rotation.axis_angle(_AXIS, "k"))
    system = _chain(({}, _ROUND), ({"kind": "prismatic", "axis": (0, 1, 0)}, _SOLID), inputs=[sf.Input("u1")])
    system = _with(system, 0, loads=(_s.Load(force, torque, "body", "world"), _s.Load(force, torque, "center_of_mass")))
    at_tip = (_s.Load(force, torque, "tip"), _s.Load(torque, force, "tip", "world"), _s.Load(force))
    return _with(system, 1, frames=(frame,), loads=(*at_tip, _s.Load(force, torque, "center_of_mass", "world")))


def _connected(system: sf.System, *names: str) -> sf.System:
    """A model with springs and dampers: "down" to the ground, "across" from tip to root, "short" of no length."""
    last = system.bodies[-1].name
    frame = _s.Frame("tip", ("a", 0.5, 0), _s.Rotation.rpy("a", 0, 0))
    system = _with(system, len(system.bodies) - 1, frames=(frame,))
    listed = (
        _s.Connection("down", ("world", None), (last, "tip"), "k", "a", "m"),
        _s.Connection("across", (last, "tip"), (system.bodies[0].name, None), "m", "J", "a"),
        _s.Connection("short", (last, None), ("world", None), "J", 0.0, "k"),
    )
    return replace(system, connections=tuple(item for item in listed if item.name in names))


_EULER = {
    "kind": "general",
    "coordinates": ("x", "y"),
    "moving_position": ("x*y", 0, "y^2"),
    "moving_rotation": _s.Rotation.rpy(0, "x", "x + a*y"),
}
_SPUN = _s.Rotation.matrix([["cos(2*s)", "-sin(2*s)", 0], ["sin(2*s)", "cos(2*s)", 0], [0, 0, 1]])

MODELS: dict[str, Model] = {
    "double pendulum": Model(REFERENCE["double_pendulum"]),
    "cart-pole": Model(REFERENCE["cart_pole"]),
    "axes by parameters": Model(
        _chain(({"axis": _AXIS}, _SOLID), ({"kind": "prismatic", "axis": ("a", 0, "k")}, _ROUND))
    ),
    "constant axes": Model(_chain(({"axis": (1, 2, 2)}, _SOLID), ({"axis": (2, -1, 2)}, _ROUND)), ROUNDED),
    "screw": Model(_chain(({"kind": "screw", "pitch": "a", "axis": (0, -1, 0)}, _SOLID), ({}, _ROUND))),
    "cylindrical": Model(_chain(({"kind": "cylindrical", "axis": (1, 0, 0)}, _ROUND), ({}, _FLAT))),
    "universal": Model(_chain(({"kind": "universal", "axis": (1, 0, 0), "axis2": ("n1", 0, "n3")}, _SOLID))),
    "planar": Model(_chain(({"kind": "planar"}, _SOLID), ({"axis": (0, 1, 0)}, _FLAT))),
    "general, by angles": Model(_chain((_EULER, _FLAT))),
    "general, by matrix": Model(
        _chain(
            (
                {
                    "kind": "general",
                    "coordinates": ("s",),
                    "moving_position": ("cos(s)", "a*sin(s)", "s/4"),
                    "moving_rotation": _SPUN,
                },
                _SOLID,
            ),
            ({"axis": (0, 1, 0)}, _ROUND),
        )
    ),
    "branches": Model(_branched()),
    "massless between": Model(_chain(({}, None), ({"axis": (0, 1, 0)}, None), ({"kind": "prismatic"}, _ROUND))),
    "rotors": Model(
        _chain(
            ({}, _ROUND),
            (
                {
                    "axis": (0, 1, 0),
                    "rotation": _s.Rotation.rpy("a", 0, "k"),
                    "armature": "J/8",
                    "rotors": (_s.Rotor("J/64", 40.0), _s.Rotor("J/32", "-k", _AXIS, "b1")),
                },
                _ROUND,
            ),
        ),
    ),
    "prescribed base": Model(
        _chain(
            (
                {
                    "kind": "general",
                    "coordinates": ("X", "Y"),
                    "moving_position": ("X", "Y", "X*Y"),
                    "prescribed": True,
                    "moving_rotation": _s.Rotation.axis_angle((0, 0, 1), "X"),
                    "rotors": (_s.Rotor("J/32", "k", (1, 0, 0), "b1", 1),),
                },
                _ROUND,
            ),
            ({"axis": (1, 0, 0), "rotors": (_s.Rotor("J/64", 8.0, (0, 0, 1)),)}, _SOLID),
        ),
    ),
    "joint forces": Model(_forces()),
    "loads": Model(_loads()),
    "connections": Model(_connected(_chain(({}, _ROUND), ({"axis": (0, 1, 0)}, _FLAT)), "down", "across", "short")),
    "ball": Model(
        _chain(
            ({"kind": "ball", "elements": (_s.Damper("k", "a", 1),), "effort": ("u1", "m*q0.wy", "q0.qx")}, _SOLID),
            inputs=[sf.Input("u1")],
            potentials=[_s.Potential("v", "k*q0.qx*q0.qw + m*q0.qz^2")],
        ),
    ),
    "ball on an arm": Model(_chain(({"axis": (0, 1, 0)}, _ROUND), ({"kind": "ball"}, _ROUND))),
    "free base with an arm": Model(
        _connected(
            _chain(
                ({"kind": "free", "actuated": True}, _SOLID),
                ({"axis": (0, 1, 0), "effort": ("-k*dq1",)}, _FLAT),
                potentials=[_s.Potential("v", "k*q0.px*q0.qy")],
            ),
            "across",
            "short",
        ),
    ),
}
