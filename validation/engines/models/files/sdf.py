"""SDFormat: inertia of collisions, links that don't move, models in models; what stands alone is in `covering`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...interface import Vector, vector
from ...plugins.writing.urdf import numbers, rpy
from . import readers
from .readers import (
    ASKEW,
    BODY,
    NEXT,
    TURNED,
    Reading,
    along,
    diagonal,
    hung,
)

_LIMIT = "<limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit>"
_NAMES = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_AT_A = "0.1 0.2 0.3 0.3 -0.4 0.5"
_AXIS_A, _AXIS_B = "<xyz>0 0 1</xyz>", "<xyz>0 1 0</xyz>"
_of = partial(readers.reading, "sdf")


def _inertial(mass: str, pose: str, moments: tuple[float, ...] = (0.2, 0.3, 0.4, 0.0, 0.0, 0.0)) -> str:
    entries = "".join(f"<{name}>{value}</{name}>" for name, value in zip(_NAMES, moments, strict=True))
    return f"<inertial><pose>{pose}</pose><mass>{mass}</mass><inertia>{entries}</inertia></inertial>"


_IA, _IB = _inertial("2", "0.1 -0.2 0.3 0 0 0"), _inertial("1", "0 0.1 0.2 0 0 0")


def _link(name: str, pose: str, inertial: str) -> str:
    """A link; its pose as numbers, or as an element."""
    return f'<link name="{name}">{pose if "<" in pose else f"<pose>{pose}</pose>"}{inertial}</link>'


def _joint(name: str, parent: str, axis: str, kind: str = "revolute", more: str = "") -> str:
    """A joint; its axes as what <axis> holds, or as elements."""
    stated = axis if axis.startswith("<axis") or not axis else f"<axis>{axis}{_LIMIT}</axis>"
    child = name.rpartition("::")[2]
    ends = f"{more}<parent>{parent}</parent><child>{name}</child>"
    return f'<joint name="j{child}" type="{kind}">{ends}{stated}</joint>'


def _model(*elements: str, version: str = "1.6", pose: str = "") -> str:
    return f'<sdf version="{version}"><model name="m">{pose}{"".join(elements)}</model></sdf>'


_A = _link("a", _AT_A, _IA)
_JA = _joint("a", "world", _AXIS_A)


def _in_model(p: Vector) -> str:
    """The pose in the model's frame of what is placed so in the first link's."""
    world = np.array(TURNED) @ np.array(p) + np.array(BODY.joints[0].p)
    return f"{numbers(vector(world))} {numbers(rpy(TURNED))}"


_AT_B = _in_model((0.0, 0.0, 0.5))
_B = _link("b", _AT_B, _IB)
_JB = _joint("b", "a", _AXIS_B)


def _computed() -> Iterator[tuple[str, Reading]]:
    """Inertia that is to be computed of collisions, of their densities or the link's (of SDFormat 1.11 and later)."""
    box, pose = "<box><size>0.2 0.4 0.6</size></box>", "<pose>0.1 -0.2 0.3 0.5 0.6 0.7</pose>"
    ball = "<sphere><radius>0.2</radius></sphere>"
    cylinder = "<cylinder><radius>0.1</radius><length>0.6</length></cylinder>"

    def collision(name: str, shape: str, more: str = "") -> str:
        return f'<collision name="{name}">{pose}{more}<geometry>{shape}</geometry></collision>'

    def of(name: str, shapes: str, mass: float, moments: Vector, more: str = "") -> tuple[str, Reading]:
        """Moments are those of a kilogram."""
        text = f'<inertial auto="true">{more}</inertial>{shapes}'
        inertia = along(ASKEW, diagonal(*(mass * one for one in moments)))
        body = replace(BODY, mass=mass, inertia=inertia)
        return _of(f"inertia computed of {name}", _model(_link("a", _AT_A, text), _JA, version="1.11"), body)

    of_box = (0.52 / 12.0, 0.40 / 12.0, 0.20 / 12.0)
    own, whole = "<density>250</density>", "<density>500</density>"
    yield of("a box", collision("c", box), 48.0, of_box)
    yield of("a box of its own density", collision("c", box, own), 12.0, of_box)
    yield of("a box of the link's density", collision("c", box), 24.0, of_box, whole)
    yield of("a box of its own density before the link's", collision("c", box, own), 12.0, of_box, whole)
    yield of("a ball", collision("c", ball), 4000.0 / 3.0 * np.pi * 0.008, (0.016, 0.016, 0.016))
    across = 0.01 / 4.0 + 0.36 / 12.0
    yield of("a cylinder", collision("c", cylinder), 6.0 * np.pi, (across, across, 0.005))
    yield of("two boxes", collision("c", box) + collision("d", box, own), 60.0, of_box)


def _trees() -> Iterator[tuple[str, Reading]]:
    """A link that does not move between two that do; a model within the model."""
    rest, last = hung(NEXT, kind="fixed"), replace(NEXT, name="c", parent=1)
    C = _link("c", _in_model((0.0, 0.0, 1.0)), _IB.replace('"b"', '"c"'))
    amid = _model(_A, _B, C, _JA, _joint("b", "a", "", "fixed"), _joint("c", "b", _AXIS_B))
    yield _of("fixed link with mass amid", amid, BODY, rest, last)
    inner = f'<model name="n"><pose relative_to="a">0 0 0.5 0 0 0</pose>{_link("b", "<!-- -->", _IB)}</model>'
    nested = _model(_A, inner, _JA, _joint("n::b", "a", _AXIS_B), version="1.9")
    yield _of("model within the model", nested, BODY, NEXT)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_computed(), *_trees()])
