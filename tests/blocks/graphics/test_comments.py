"""Comments: they are kept in files and change nothing of a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Comment
from symofros.blocks.graphics.comments import MOST
from tests.diagrams.parts import ramp

TEXT = "Above: the law.\nBelow: # the plant, with 'quotes' and \\ signs"


def diagram(*comments: Comment) -> sf.Diagram:
    d = sf.Diagram("commented")
    d.add(ramp())
    for comment in comments:
        d.add(comment)
    return d


def test_a_comment_changes_nothing_of_a_run() -> None:
    bare, commented = (sf.Simulation(diagram(*more)) for more in ((), (Comment(name="about", text=TEXT),)))
    for run in (sf.Simulation.run, sf.Simulation.interpret):
        expected, actual = (run(simulation, 0.1, dt=0.01) for simulation in (bare, commented))
        assert np.array_equal(expected["ramp.y"], actual["ramp.y"]) and np.array_equal(expected.t, actual.t)
        assert expected.outcome == actual.outcome


def test_a_file_keeps_its_words(tmp_path: Path) -> None:
    file = tmp_path / "commented.yaml"
    sf.save_diagram(diagram(Comment(name="about", text=TEXT), Comment(name="title", text="Law", heading=True)), file)
    blocks = sf.load_diagram(file).blocks
    assert blocks["about"] == Comment(name="about", text=TEXT)
    assert blocks["title"] == Comment(name="title", text="Law", heading=True)


@pytest.mark.parametrize(
    ("changes", "words"),
    [({"text": "x" * (MOST + 1)}, f"{MOST + 1} characters"), ({"period": 0.1}, "no samples"), ({"offset": 1.0}, "1.0")],
)
def test_invalid_comments_are_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(sf.DescriptionError, match=words):
        Comment(**{"name": "about", "text": "x", **changes})
