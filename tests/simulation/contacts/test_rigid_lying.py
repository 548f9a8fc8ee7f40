"""Rims and segments that lie along a surface, carried by other contacts (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import symofros as sf
from tests.simulation.contacts.test_rigid_segments import HALF, RADIUS, stick
from tests.simulation.rigid_scenes import FINE, G


def on_block(*contacts: tuple[str, dict[str, Any]], friction: float = 0.4) -> sf.Model:
    """A capsule above a fixed block of 0.5 by 2 by 1 m, with such contacts, "ends" and "line" of its own."""
    base = sf.RigidBody("base", sf.Joint("base", "fixed"))
    laws: dict[str, Any] = {"restitution": 0.0, "friction": friction, "radius": RADIUS, "surface": "box"}
    touch = [sf.Contact(n, ("stick", None), ("base", None), **laws | sizes) for n, sizes in contacts]
    return sf.compile(sf.System("block", [base, stick("stick")], connections=touch))


LINE = {"segment": 2 * HALF}
ENDS = {"points": ((0, 0, -HALF), (0, 0, HALF))}


def lying(height: float, tilt: float, yaw: float) -> Any:
    """The capsule 0.05 m beside the middle, its axis along x but for the angles [m, rad]."""
    turned = Rotation.from_euler("z", yaw) * Rotation.from_euler("y", pi / 2 + tilt)
    return np.r_[0.05, 0.0, height, turned.as_quat()]


@pytest.mark.parametrize("given", [FINE, {"method": "rk4", "dt": 1e-3}])
def test_a_capsule_comes_to_lie_on_a_face_by_points_at_its_ends(given: dict[str, Any]) -> None:
    """The segment strikes, and hands over where it lies along the face: the ends carry half the weight each."""
    model = on_block(("line", LINE | {"size": (2, 2, 1)}), ("ends", ENDS | {"size": (2, 2, 1)}))
    for tilt in (0.0, 0.3):
        run = sf.simulate(model, lying(0.75, tilt, 0.2), t_end=0.6, **given)
        assert run.outcome.ok and run.v[-1] == pytest.approx(np.zeros(6), abs=1e-9)
        assert run.contact_forces().push[-1] == pytest.approx([0.0, G / 2, G / 2], abs=1e-8)
        assert run.q[-1, 2] == pytest.approx(0.5 + RADIUS, abs=1e-9) and np.diff(run.energy).max() < 1e-9
        assert not any("turns" in note or "too often" in note for note in run.outcome.notes)


@pytest.mark.parametrize("tilt", [0.0, 0.2])
def test_a_capsule_that_comes_to_lie_across_a_narrow_face_is_refused_in_words(tilt: float) -> None:
    """Beyond both edges of the face no end carries it: the edge by which it touches has the face's normal."""
    model = on_block(("line", LINE | {"size": (0.3, 2, 1)}), ("ends", ENDS | {"size": (0.3, 2, 1)}))
    run = sf.simulate(model, lying(0.7, tilt, 0.0), t_end=0.6, **FINE)
    assert run.outcome.kind == "beyond theory" and "a segment along its surface" in str(run.outcome)


def test_a_capsule_lies_across_a_narrow_block_by_the_edges_of_the_block() -> None:
    """As segments on the capsule they touch at two points, which carry what statics says."""
    width, off = 0.3, 0.02
    along_y = sf.Frame("along_y", rotation=sf.Rotation.axis_angle((1, 0, 0), -pi / 2))
    base = sf.RigidBody("base", sf.Joint("base", "fixed"), frames=[along_y])
    sizes: dict[str, Any] = {"segment": 2.0, "surface": "capsule", "surface_radius": RADIUS, "length": 2 * HALF}
    edges = sf.Contact(
        "edges",
        ("base", "along_y"),
        ("stick", None),
        restitution=0.0,
        friction=0.4,
        points=((-width / 2, -0.5, 0), (width / 2, -0.5, 0)),
        **sizes,
    )
    model = sf.compile(sf.System("across", [base, stick("stick")], connections=[edges]))
    for tilt in (0.0, 0.1):
        q = lying(0.7, tilt, 0.0)
        q[0] = off
        run = sf.simulate(model, q, t_end=1.5, **FINE)
        assert run.outcome.ok and run.v[-1] == pytest.approx(np.zeros(6), abs=1e-9)
        share = run.q[-1, 0] / width
        assert run.contact_forces().push[-1] == pytest.approx([G * (0.5 - share), G * (0.5 + share)], abs=1e-8)
        assert run.q[-1, 2] == pytest.approx(0.5 + RADIUS, abs=1e-9) and np.diff(run.energy).max() < 1e-8


def test_a_box_with_rounded_edges_lands_flat_on_a_box() -> None:
    """It falls upon an edge, tips and lies on its four lower corners: the edges along it carry nothing then."""
    half, r = (0.19, 0.14, 0.09), 0.01
    frames = [
        sf.Frame("along_x", rotation=sf.Rotation.axis_angle((0, 1, 0), pi / 2)),
        sf.Frame("along_y", rotation=sf.Rotation.axis_angle((1, 0, 0), -pi / 2)),
    ]
    moments = tuple((a * a + b * b) / 3 for a, b in ((0.15, 0.1), (0.2, 0.1), (0.2, 0.15)))
    box = sf.RigidBody("box", sf.Joint("box", "free"), sf.Inertia(1.0, moments=moments), frames=frames)
    base = sf.RigidBody("base", sf.Joint("base", "fixed"))
    laws: dict[str, Any] = {"restitution": 0.0, "friction": 0.5, "radius": r, "surface": "box", "size": (2, 2, 1)}
    low = tuple((x * half[0], y * half[1], -half[2]) for x in (-1, 1) for y in (-1, 1))
    contacts = [sf.Contact("corners", ("box", None), ("base", None), points=low, **laws)]
    for frame, sides, length in (
        ("along_x", tuple((half[2], y * half[1], 0) for y in (-1, 1)), 2 * half[0]),
        ("along_y", tuple((x * half[0], half[2], 0) for x in (-1, 1)), 2 * half[1]),
    ):
        contacts.append(
            sf.Contact(f"edges {frame}", ("box", frame), ("base", None), points=sides, segment=length, **laws)
        )
    model = sf.compile(sf.System("boxes", [base, box], connections=contacts))
    for turns in ((0.0, 0.2, 0.0), (0.3, 0.2, 0.4)):
        q = np.r_[0.0, 0.0, 0.7, Rotation.from_euler("xyz", turns).as_quat()]
        run = sf.simulate(model, q, t_end=0.6, **FINE)
        assert run.outcome.ok and run.v[-1] == pytest.approx(np.zeros(6), abs=1e-9)
        assert run.q[-1, 2] == pytest.approx(0.6, abs=1e-9) and np.diff(run.energy).max() < 1e-9
        force = run.contact_forces()
        assert force.push[-1].sum() == pytest.approx(G, abs=1e-8) and force.gap.min() > -1e-9
        assert not any("turns" in note or "too often" in note for note in run.outcome.notes)


def test_a_disc_tips_onto_points_of_its_base_and_lies() -> None:
    """The rim strikes first; three points of the base, a little within it and lower, carry the disc where it lies."""
    disc = sf.RigidBody("disc", sf.Joint("disc", "free"), sf.Inertia(1.0, moments=(0.0026, 0.0026, 0.005)))
    laws: dict[str, Any] = {"restitution": 0.0, "friction": 0.4}
    feet = tuple((0.09 * np.cos(x), 0.09 * np.sin(x), -0.001) for x in (0.0, 2 * pi / 3, 4 * pi / 3))
    contacts = [
        sf.Contact("rim", ("disc", None), ("world", None), rim=0.1, **laws),
        sf.Contact("feet", ("disc", None), ("world", None), points=feet, **laws),
    ]
    model = sf.compile(sf.System("tips", [disc], connections=contacts))
    q = np.r_[0.0, 0.0, 0.1, Rotation.from_euler("y", 0.4).as_quat()]
    run = sf.simulate(model, q, t_end=0.8, **FINE)
    assert run.outcome.ok and run.q[-1, 2] == pytest.approx(0.001, abs=1e-9) and np.diff(run.energy).max() < 1e-9
    assert run.contact_forces().push[-1].sum() == pytest.approx(G, abs=1e-8)
