"""What serves geometrically exact rods around the equations: judgement, drawing, files, refusals."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.compiler import program_of
from symofros.generator.passes.count import count_program
from symofros.mechanics.beams.theories import theory_of
from symofros.studio.viewer.drawing.drawing import STATIONS
from tests.mechanics.beams.rods import integrated, rod


@cache
def pendulum() -> sf.Model:
    return sf.compile(MODELS["soft_pendulum"], sf.Options(("frame_pose",), backend="interpreter"))


def test_the_stated_error_of_a_rod_is_the_error_of_its_sections(rng: np.random.Generator) -> None:
    (judged,) = pendulum().beams()
    for size in (0.3, 1.0, 3.0):
        q = size * rng.standard_normal(3)
        stations = np.arange(1, 9) / 8
        p, _ = integrated((0, 3, 0), q, stations)
        own = theory_of(rod((0, 3, 0), sections=judged.bending(q).sections)).shape({}, STATIONS).points(1.0, q)[2::2]
        error = np.linalg.norm(own - p, axis=-1).max()
        assert judged.bending(q).error == pytest.approx(error, rel=0.1, abs=1e-9)


def test_a_rod_that_is_rolled_up_carries_a_note_on_its_sections() -> None:
    (judged,) = pendulum().beams()
    bent = judged.bending(np.array([14.0, 6.0, 0.0]))
    assert bent.error > 0.01 and bent.slope > 3.0
    assert "sections place it to about" in str(bent) and f"sections: {2 * bent.sections}" in bent.remedy
    # Axial loads amplify no error of a rod, and no slope alone is beyond its theory.
    assert bent.amplified(1e3) == bent and judged.error_bound(np.array([14.0, 6.0, 0.0])) < 1e-5


def test_urdf_export_refuses_curved_rods(tmp_path: Path) -> None:
    curved = sf.System("s", (rod((1, 0, 0), curvature_z=0.5),))
    with pytest.raises(sf.ExportError, match="rods that URDF can't hold"):
        sf.export(curved, "urdf", tmp_path / "s.urdf")


@pytest.mark.parametrize(("counts", "most"), [((3, 0, 0), 571), ((2, 2, 2), 2002)])
def test_operations_of_a_rod_on_a_free_base_do_not_grow(counts: tuple[int, int, int], most: int) -> None:
    """The table of docs/theory/rods.md, section 7."""
    stated = sf.Beam(
        "b",
        sf.Joint("base", "free"),
        1.0,
        1.0,
        EI_z=1.0,
        EI_y=1.0,
        GJ=1.0,
        rhoJ=0.01 if counts[2] else 0.0,
        bend_y=counts[0],
        bend_z=counts[1],
        twist=counts[2],
        family="legendre",
        theory="strain",
    )
    operations = count_program(program_of(sf.System("s", (stated,)), ["dynamics"]))["dynamics", ""]
    assert operations.total <= most


def test_segments_of_a_rod_keep_its_strains_without_stress() -> None:
    """Three rods in series, each with its part of a curvature that changes along the whole."""
    whole = rod((1, 0, 0), length=1.5, curvature_z="0.4 + x", sections=10)
    divided = replace(whole, segments=3)
    options = sf.Options(("frame_pose",), backend="interpreter")
    tips = [sf.compile(sf.System("s", (body,)), options) for body in (whole, divided)]
    poses = [m.frame_pose("tip", np.zeros(m.nq)) for m in tips]
    assert poses[0][0] == pytest.approx(poses[1][0], abs=1e-7)
    assert poses[0][1] == pytest.approx(poses[1][1], abs=1e-12)
