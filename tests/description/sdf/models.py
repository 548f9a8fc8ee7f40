"""Small SDFormat models, each with something that a reader can get wrong, and Drake 1.51.1's numbers for them.

Drake reads SDFormat by libsdformat, the format's own library. Gravity is 9.81 m/s^2 on both sides.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from ruamel.yaml import YAML

INERTIAL = (
    "<inertial><pose>0.1 -0.05 0.2 0.3 0.1 -0.2</pose><mass>{mass}</mass><inertia>"
    "<ixx>0.2</ixx><iyy>0.3</iyy><izz>0.25</izz><ixy>0.01</ixy><ixz>-0.02</ixz><iyz>0.03</iyz></inertia></inertial>"
)


def link(name: str, pose: str, mass: float) -> str:
    """A link with an inertia that has no symmetry."""
    return f'<link name="{name}">{pose}{INERTIAL.format(mass=mass)}</link>'


def document(body: str, version: str = "1.11") -> str:
    """A file of one model."""
    return f'<sdf version="{version}"><model name="arm">{body}</model></sdf>'


class Drake(NamedTuple):
    """What Drake says.

    Attributes:
        text: The file.
        coordinates: Names of the coordinates, in Drake's order.
        q: Coordinates [rad or m].
        v: Speeds [rad/s or m/s].
        M: Lower triangle of the mass matrix, row by row.
        h: Coriolis forces and weight.
    """

    text: str
    coordinates: tuple[str, ...]
    q: tuple[float, ...]
    v: tuple[float, ...]
    M: tuple[float, ...]
    h: tuple[float, ...]


MODELS = {name: Drake(**case) for name, case in YAML(typ="safe").load(Path(__file__).with_suffix(".yaml")).items()}

# A link on a hinge.
ONE = link("a", "", 1) + (
    '<joint name="q" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 1 0</xyz></axis></joint>'
)
