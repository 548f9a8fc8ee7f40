"""A rod that is curved without stress gets the sections that its own turn needs, for frames within it as at its tip."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.mechanics.beams.strain.theory import sections_of_turn
from symofros.mechanics.topology.tree import build_tree
from symofros.runtime.calls.kernel import Array
from tests.mechanics.beams.rods import rod

LENGTH = 2.0


def coil(turns: float, pitch: float, **more: object) -> sf.System:
    """A helix of so many turns without load, with frames at eighths of its length."""
    curvature = 2 * np.pi * turns / LENGTH
    frames = tuple(sf.Frame(f"at{i}", at=i / 8) for i in range(1, 9))
    own = {"curvature_z": float(curvature), "twist_rate": float(pitch * curvature), "frames": frames}
    return sf.System("coil", (rod((1, 1, 1), None, LENGTH, **own, **more),), gravity=(0, 0, 0))


def helix(turns: float, pitch: float, x: float) -> Array:
    """Where constant strains lead, in closed form."""
    w = np.array([pitch, 0.0, 1.0]) * 2 * np.pi * turns / LENGTH
    size = float(np.linalg.norm(w))
    axis, along = w / size, np.array([1.0, 0.0, 0.0])
    across = along - axis * (axis @ along)
    sine, cosine = np.sin(size * x) / size, (1 - np.cos(size * x)) / size
    return np.asarray(axis * (axis @ along) * x + across * sine + np.cross(axis, along) * cosine)


@pytest.mark.parametrize(("turns", "pitch"), [(0.25, 0.0), (0.25, 2.0), (1.0, 0.3), (1.0, 2.0), (3.0, 0.0), (3.0, 0.3)])
def test_frames_lie_on_the_helix(turns: float, pitch: float) -> None:
    """All of them: with the sections of its functions alone frames of three turns were 0.6 of the length off."""
    model = sf.compile(coil(turns, pitch), sf.Options(("frame_pose",), backend="interpreter"))
    for i in range(1, 9):
        p, _ = model.frame_pose(f"at{i}", model.neutral())
        assert np.linalg.norm(p - helix(turns, pitch, LENGTH * i / 8)) < 1e-3 * LENGTH


def test_an_unloaded_coil_stays_at_rest() -> None:
    """Without a note."""
    model = sf.compile(coil(3.0, 0.3), sf.Options(backend="interpreter"))
    rest = sf.equilibrium(model)
    assert not rest.notes
    assert np.abs(rest.q).max() < 1e-9


@pytest.mark.parametrize("more", [{}, {"sections": 5}])
def test_rods_of_little_turn_or_stated_sections_are_left_unchanged(more: dict[str, object]) -> None:
    """Their programs, and so their bits, are the same."""
    for system in (coil(0.02, 0.3, **more), coil(3.0, 0.3, sections=5)):
        (beam,) = (link.tip_of for link in build_tree(system).links if link.tip_of is not None)
        assert beam is system.bodies[0]


def test_a_twist_without_curvature_needs_no_more_sections() -> None:
    """The axis of a rod that is twisted without stress is straight."""
    assert sections_of_turn(20.0, 0.0) == 2
    assert [sections_of_turn(turn, 1.0) for turn in (0.5, np.pi / 2, 2 * np.pi, 6 * np.pi)] == [2, 3, 7, 16]
