"""What the palette offers: templates of parts, each a whole entry of the file that is valid as it stands."""

from __future__ import annotations

from typing import Any

import symofros
from symofros.description import entries_by_surface
from symofros.description.yaml import SectionEntry, SolidEntry, json_schema
from symofros.exports.exporting import TARGETS
from symofros.simulation.stepping.methods import METHODS
from symofros.studio.editor.diagrams.palette import diagram_catalogue

Json = dict[str, Any]

_UNITS_OF_MOTION = "m, kg, s, rad, N, N m, m/s, rad/s, m/s^2, kg m^2"
_UNITS_OF_MATERIAL = "kg/m, N/m, N m/rad, N s/m, N m s/rad, N m^2, kg m, m^2, Pa, kg/m^3"
UNITS = (*_UNITS_OF_MOTION.split(", "), *_UNITS_OF_MATERIAL.split(", "))

# Across gravity: what is drawn and simulated moves, and a beam bends under its weight.
_REVOLUTE = {"kind": "revolute", "axis": [0, 1, 0]}
_ANCHORS = {"first": {"body": "world"}, "second": {"body": "world"}}

PALETTE: tuple[Json, ...] = (
    {
        "kind": "rigid_body",
        "section": "bodies",
        "name": "body",
        "title": "Rigid body",
        "help": "Mass and inertia, on a joint that its parent carries.",
        "template": {
            "joint": _REVOLUTE,
            "inertia": {"mass": 1.0, "center_of_mass": [0.5, 0, 0], "moments": [0.01, 0.1, 0.1]},
            "frames": {"tip": {"position": [1, 0, 0]}},
        },
    },
    {
        "kind": "massless_body",
        "section": "bodies",
        "name": "link",
        "title": "Massless body",
        "help": "Geometry without inertia, such as one axis of several; something with mass lies beyond it.",
        "template": {"joint": _REVOLUTE, "frames": {"tip": {"position": [1, 0, 0]}}},
    },
    {
        "kind": "beam",
        "section": "bodies",
        "name": "beam",
        "title": "Flexible beam",
        "help": "A slender elastic body along x, clamped at its root, with one frame at its tip.",
        "template": {
            "joint": {"kind": "fixed"},
            "beam": {"length": 1.0, "rhoA": 1.0, "EI_y": 100.0, "bend_z": 2},
            "frames": {"tip": {}},
        },
    },
    {
        "kind": "base",
        "section": "bodies",
        "name": "ground",
        "title": "Base",
        "help": "The one body without a joint: frames fixed in the world. Without one, 'world' is the ground.",
        "template": {"frames": {"mount": {"position": [0, 0, 1]}}},
    },
    {
        "kind": "gravity",
        "section": "system",
        "name": "gravity",
        "title": "Gravity",
        "help": "Acceleration of gravity in the world frame [m/s^2].",
        "template": [0, 0, -9.81],
    },
    {
        "kind": "closure",
        "section": "closures",
        "name": "loop",
        "title": "Closure",
        "help": "Two frames that stay together in some directions: it closes a loop.",
        "template": {**_ANCHORS, "translations": ["x", "y", "z"]},
    },
    {
        "kind": "rod",
        "section": "closures",
        "name": "rod",
        "title": "Rod",
        "help": "A massless rod: two frames stay at a distance.",
        "template": {**_ANCHORS, "length": 1.0},
    },
    {
        "kind": "connection",
        "section": "connections",
        "name": "spring",
        "title": "Spring and damper",
        "help": "A force along the line between two frames.",
        "template": {**_ANCHORS, "stiffness": 100.0, "length": 1.0, "damping": 1.0},
    },
    {
        "kind": "contact",
        "section": "contacts",
        "name": "touch",
        "title": "Contact",
        "help": "A ball that a surface pushes back where it penetrates it.",
        "template": {**_ANCHORS, "stiffness": 1e5, "exponent": 1.0, "friction": 0.5},
    },
    {
        "kind": "contact",
        "section": "contacts",
        "name": "touch",
        "title": "Rigid contact",
        "help": "A ball on a surface: it strikes, slides, sticks and parts.",
        "template": {**_ANCHORS, "restitution": 0.5, "friction": 0.5},
    },
    {
        "kind": "nonholonomic",
        "section": "nonholonomic",
        "name": "skate",
        "title": "Knife edge",
        "help": "A frame that does not move along one of its axes.",
        "template": {"knife_edge": {"body": "world", "axis": "y"}},
    },
    {
        "kind": "nonholonomic",
        "section": "nonholonomic",
        "name": "wheel",
        "title": "Rolling",
        "help": "A disc (axis z) or a sphere that rolls on a horizontal plane without slip.",
        "template": {"rolling": {"body": "world", "radius": 0.1}},
    },
    {
        "kind": "parameter",
        "section": "parameters",
        "name": "p",
        "title": "Parameter",
        "help": "A named number, given at run time unless constant.",
        "template": {"value": 1.0, "unit": ""},
    },
    {
        "kind": "input",
        "section": "inputs",
        "name": "u",
        "title": "Input",
        "help": "A named input for formulas of efforts and loads.",
        "template": {"unit": "N m"},
    },
)


def catalogue() -> Json:
    """Version, format and palette of the editor, and the choices of fields and runs."""
    methods = [
        {"name": item.name, "adaptive": item.adaptive, "order": item.order, "help": item.summary}
        for item in METHODS.values()
    ]
    return {
        "version": symofros.__version__,
        "schema": json_schema(),
        "palette": list(PALETTE),
        "methods": methods,
        "units": list(UNITS),
        "targets": list(TARGETS),
        "sizes": {
            "section": SectionEntry.sizes_by_shape(),
            "solid": SolidEntry.sizes_by_shape(),
            "contact": entries_by_surface(),
        },
        "diagram": diagram_catalogue(),
    }
