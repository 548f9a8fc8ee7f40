"""Beams without stretch whose ends a loop holds along the axis are named when they are compiled; no other is."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import symofros as sf

GROUND = sf.RigidBody("ground", frames=(sf.Frame("end", (1.0, 0, 0)),))
ALL = ("x", "y", "z")


def beam(root: str = "fixed", **fields: Any) -> sf.Beam:
    """A beam of one metre from the origin along x."""
    joint = sf.Joint("root", root) if root == "fixed" else sf.Joint("root", root, axis=(0, 0, 1))
    stated: dict[str, Any] = {"EI_z": 2.0, "bend_y": 3, "theory": "second_order"} | fields
    return sf.Beam("strip", joint, 1.0, 0.5, **stated)


def closed(beam: sf.Beam, translations: tuple[str, ...] = ("x", "y"), rotations: tuple[str, ...] = ()) -> sf.System:
    """A beam, its tip held to the ground."""
    closure = sf.Closure("end", ("ground", "end"), ("strip", "tip"), translations, rotations)  # type: ignore[arg-type]
    return sf.System("held", (GROUND, beam), constraints=(closure,), gravity=(0, 0, 0))


ROD = {"theory": "strain", "GJ": 1.0, "EI_y": 2.0}
HELD = {
    "clamped at both ends": closed(beam(), ALL, ALL),
    "pinned at both ends": closed(beam("revolute")),
    "clamped and pinned": closed(beam()),
    "every term": closed(beam(retain="all")),
    "a rod": closed(beam(**ROD), ALL, ALL),
    "in segments": closed(beam(segments=3)),
}
FREE = {
    "a roller": closed(beam("revolute"), ("y",)),
    "a rod that stretches": closed(beam(**ROD, stretch=2, EA=1e4), ALL, ALL),
    "no foreshortening, on purpose": closed(beam(foreshortening=False, retain="zeroth_order"), ALL, ALL),
    "a rigid one": closed(beam("revolute", bend_y=0), ALL, ALL),
}


def said(system: sf.System) -> list[str]:
    """Warnings of held beams."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sf.compile(system, sf.Options(backend="interpreter"))
    return [str(one.message) for one in caught if "does not stretch" in str(one.message)]


@pytest.mark.parametrize("how", HELD)
def test_beams_held_at_both_ends_are_named_with_the_remedy(how: str) -> None:
    """By the closure, the condition and the beam."""
    (text,) = said(HELD[how])
    assert "closure 'end': 'end.x' holds both ends of beam 'strip" in text
    assert "functions of stretch" in text


@pytest.mark.parametrize("how", FREE)
def test_beams_free_to_shorten_get_no_warning(how: str) -> None:
    """Nor does what never bends."""
    assert not said(FREE[how])


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_mechanisms_with_an_elastic_coupler_get_no_warning(angle: float) -> None:
    """Not even where its links lie in one line."""
    crank = sf.RigidBody(
        "crank", sf.Joint("a", "revolute", axis=(0, 0, 1)), sf.Inertia(1.0), (sf.Frame("end", (0.3, 0, 0)),)
    )
    turned = sf.Rotation.rpy(0, 0, angle)
    joint = sf.Joint("b", "revolute", "crank", "end", rotation=turned, axis=(0, 0, 1))
    coupler = sf.Beam("strip", joint, 1.0, 0.5, EI_z=2.0, bend_y=2)
    tip = np.array([0.3 + np.cos(angle), np.sin(angle), 0.0])
    rocker = sf.RigidBody(
        "rocker",
        sf.Joint("c", "revolute", position=tuple((tip + [0.5, 0, 0]).tolist()), axis=(0, 0, 1)),
        sf.Inertia(1.0),
        (sf.Frame("end", (-0.5, 0, 0)),),
    )
    closure = sf.Closure("end", ("rocker", "end"), ("strip", "tip"), ("x", "y"))
    assert not said(sf.System("coupler", (crank, coupler, rocker), constraints=(closure,)))
