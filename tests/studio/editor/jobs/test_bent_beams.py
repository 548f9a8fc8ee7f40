"""How far beams are bent, as the page shows it: what is judged, and that it is JSON."""

from __future__ import annotations

import json
import math

import pytest

from symofros.runtime.beams import BeamBending, slope_error, slope_of_error
from symofros.studio.editor.jobs import operations
from symofros.studio.editor.jobs.bent_beams import bent_beams
from tests.studio.editor.texts import FILES

PENDULUM = FILES["double_pendulum"].parents[1] / "flexible" / "flexible_pendulum.yaml"


def bending(error: float, sections: int = 0) -> BeamBending:
    return BeamBending("rod", 0.5, math.sqrt(abs(error)), 0.0, 0.01, error, sections=sections)


@pytest.mark.parametrize(
    ("error", "grade"),
    [(0.0, "fine"), (0.01, "fine"), (0.02, "noted"), (0.5, "noted"), (0.6, "beyond"), (math.inf, "beyond")],
)
def test_errors_are_graded_as_results_note_and_refuse_them(error: float, grade: str) -> None:
    (judged,) = bent_beams([bending(error)])
    assert judged["grade"] == grade and judged["t"] is None
    assert judged["error"] == (error if math.isfinite(error) else None)
    json.dumps(judged, allow_nan=False)
    assert bent_beams([bending(0.02)], limit=0.015)[0]["grade"] == "beyond"
    assert bent_beams([bending(0.001, sections=8)])[0]["exact"]  # A rod.


def test_slope_of_error_solves_equation_24() -> None:
    for error in (1e-6, 0.01, 0.1, 0.5, 3.0):
        assert slope_error(slope_of_error(error) ** 2) == pytest.approx(error, rel=1e-12)


def test_a_simulation_carries_the_judgement_of_its_beams() -> None:
    text = PENDULUM.read_text()
    options = {"t_end": 0.2, "q0": {"swing": 1.2}, "points": 20}
    found = operations.simulate({"file": "p.yaml", "text": text, "options": options}, lambda *_: None)
    (rod,) = found["beams"]
    assert rod["beam"] == "rod" and 0.0 < rod["slope"] < 1.0 and 0.0 <= rod["t"] <= 0.2
    assert rod["error"] == pytest.approx(slope_error(rod["slope"] ** 2), rel=0.5)  # Axial loads amplify it.
    assert not rod["exact"] and "rod" in rod["text"]
