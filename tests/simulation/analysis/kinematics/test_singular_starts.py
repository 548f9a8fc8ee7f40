"""First postures: whether a start is a singular posture is said where it is one, and nowhere else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.simulation.analysis.kinematics.starts import closed_start, singular_start


@pytest.mark.parametrize(("start", "singular"), [({}, True), ({"q1": 1.2}, False), ({"q1": 0.1}, False)])
def test_a_start_in_a_singular_posture_is_reported(start: dict[str, float], singular: bool) -> None:
    """A parallelogram that lies flat; laid out a little it is none."""
    model = sf.compile(MODELS["four_bar"], sf.Options(backend="interpreter"))
    q = np.array([start.get(name, 0.0) for name in model.names.q])
    closed = closed_start(model, q, np.zeros(model.nv), tuple(start), ())
    notes = singular_start(model, closed.q)
    assert bool(notes) == singular and all("rank is 1 there and 2 beside it" in note for note in notes)


@pytest.mark.parametrize("name", ["slider_crank", "bricard"])
def test_regular_starts_get_no_note_of_singularity(name: str) -> None:
    model = sf.compile(MODELS[name], sf.Options(backend="interpreter"))
    assert singular_start(model, closed_start(model, model.neutral(), np.zeros(model.nv), (), ()).q) == ()


def test_exports_note_a_singular_start(tmp_path: Path) -> None:
    words = "the start is a singular posture"
    flat, laid_out = (sf.export(MODELS["four_bar"], "c", tmp_path / str(q), start={"q1": q}) for q in (0.0, 1.2))
    assert any(words in note for note in flat.notes) and not any(words in note for note in laid_out.notes)
