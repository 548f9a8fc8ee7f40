"""Units of entries, as data: docstrings, which state them to people, are gone under `python -OO`.

One row a class, one item an entry; of two units the first is that of a turn, the second of a translation (of a
`BeamLoad`, that of a load at a station and of a load along the beam). `tests/description/test_entry_units.py` compares
each with its docstring.
"""

from __future__ import annotations

from collections.abc import Mapping

_TURN_OR_SHIFT = ("N m", "N")
_STIFFNESS, _DAMPING = ("N m/rad", "N/m"), ("N m s/rad", "N s/m")
ENTRY_UNITS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "System": {"gravity": ("m/s^2",)},
    "Inertia": {"mass": ("kg",), "center_of_mass": ("m",), "moments": ("kg m^2",)},
    "Frame": {"position": ("m",)},
    "Joint": {
        "position": ("m",),
        "actuated": _TURN_OR_SHIFT,
        "effort": _TURN_OR_SHIFT,
        "pitch": ("m/rad",),
        "moving_position": ("m",),
        "armature": ("kg m^2", "kg"),
    },
    "Spring": {"stiffness": _STIFFNESS, "rest": ("rad", "m"), "cubic": ("N m/rad^3", "N/m^3")},
    "Damper": {"coefficient": _DAMPING, "quadratic": ("N m s^2/rad^2", "N s^2/m^2")},
    "Stop": {"stiffness": _STIFFNESS, "damping": _DAMPING, "lower": ("rad", "m"), "upper": ("rad", "m")},
    "Friction": {
        "dynamic": _TURN_OR_SHIFT,
        "static": _TURN_OR_SHIFT,
        "minimum_velocity": ("rad/s", "m/s"),
        "viscous": _DAMPING,
        "stribeck_velocity": ("rad/s", "m/s"),
    },
    "LuGre": {
        "dynamic": _TURN_OR_SHIFT,
        "stiffness": _STIFFNESS,
        "damping": _DAMPING,
        "static": _TURN_OR_SHIFT,
        "stribeck_velocity": ("rad/s", "m/s"),
        "viscous": _DAMPING,
    },
    "Hysteresis": {"stiffness": _STIFFNESS, "force": _TURN_OR_SHIFT},
    "Rotor": {"inertia": ("kg m^2",)},
    "Load": {"force": ("N",), "torque": ("N m",)},
    "Connection": {"stiffness": ("N/m",), "length": ("m",), "damping": ("N s/m",)},
    "Contact": {
        "radius": ("m",),
        "rim": ("m",),
        "segment": ("m",),
        "points": ("m",),
        "surface_radius": ("m",),
        "length": ("m",),
        "size": ("m",),
        "dissipation": ("s/m",),
        "minimum_velocity": ("m/s",),
        "bristle_stiffness": ("N/m",),
        "bristle_damping": ("N s/m",),
    },
    "Rod": {"length": ("m",)},
    "Rolling": {"radius": ("m",), "height": ("m",)},
    "Beam": {
        "length": ("m",),
        "rhoA": ("kg/m",),
        "EI_z": ("N m^2",),
        "EI_y": ("N m^2",),
        "GJ": ("N m^2",),
        "rhoJ": ("kg m",),
        "rhoI_y": ("kg m",),
        "rhoI_z": ("kg m",),
        "damping": ("s",),
        "curvature_y": ("1/m",),
        "curvature_z": ("1/m",),
        "twist_rate": ("rad/m",),
        "EA": ("N",),
        "GA_y": ("N",),
        "GA_z": ("N",),
        "EI_yz": ("N m^2",),
        "rhoI_yz": ("kg m",),
        "tension_center": ("m",),
        "shear_center": ("m",),
        "mass_center": ("m",),
    },
    "BeamLoad": {"force": ("N", "N/m"), "torque": ("N m", "N m/m")},
}


def units_of(noun: type, entry: str) -> tuple[str, ...]:
    """Units that an entry of a description class may have: ("N m/rad", "N/m"); none where any will do."""
    return ENTRY_UNITS.get(noun.__name__, {}).get(entry, ())
