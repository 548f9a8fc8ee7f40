"""Scenes, in Python and as files: what they hold, and what is said of those that don't fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

GOOD = "t_end: 2\noutputs:\n  tip: {position: tip, absolute: 1e-3}\n"
SCENES = sorted((Path(__file__).parents[3] / "reference_models").rglob("scenes/*.yaml"))


def read(tmp_path: Path, text: str) -> sf.Scene:
    file = tmp_path / "scene.yaml"
    file.write_text(text)
    return sf.load_scene(file)


def test_a_scene_file_is_read(tmp_path: Path) -> None:
    scene = read(
        tmp_path,
        GOOD + "  turn: {coordinate: q1, relative: 0.01}\ninputs:\n  a: 2*sin(t)\n  b: 3\n"
        "  c: {t: [0, 1], values: [0, 2], kind: hold}\nstart: {q1: 0.5, dq1: -1}\nkeep: [m]\n"
        "fixed_step: true\nsamples: 50\n",
    )
    assert scene.inputs["a"] == "2*sin(t)" and scene.inputs["b"] == 3.0 and scene.inputs["c"].kind == "hold"
    assert scene.outputs[1] == sf.Output("turn", "coordinate", "q1", relative=0.01)
    assert scene.start == {"q1": 0.5, "dq1": -1.0} and scene.keep == ("m",) and scene.fixed_step
    assert len(scene.times) == 50 and scene.frames == ("tip",)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_every_reference_scene_fits_its_model(path: Path) -> None:
    scene = sf.load_scene(path)
    assert path.stem in MODELS and scene.outputs


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t_end: 2\n", "entry 'outputs' is missing"),
        ("t_end: -1\noutputs: {a: {position: tip, absolute: 1}}\n", "no span of time"),
        ("t_end: soon\noutputs: {a: {position: tip, absolute: 1}}\n", "t_end is not a number"),
        ("t_end: 1\noutputs: {}\n", "no outputs"),
        ("t_end: 1\noutputs: {a: {position: tip, absolute: -1}}\n", "no tolerance"),
        ("t_end: 1\noutputs: {a: {place: tip, absolute: 1}}\n", "unknown entry 'place'"),
        ("t_end: 1\noutputs: {a: {position: tip, speed: q, absolute: 1}}\n", "not of one thing"),
        (GOOD + "input: {a: 1}\n", "did you mean 'inputs'?"),
        (GOOD + "inputs: {a: __import__('os')}\n", "scene.yaml:4"),
        (GOOD + "inputs: {a: 'open(1)'}\n", "'open' is not a function that formulas may call"),
        (GOOD + "inputs: {a: {t: [0, 1]}}\n", "samples lack a part"),
        (GOOD + "inputs: {a: {t: [1, 0], values: [1, 2]}}\n", "t (n) increases"),
        (GOOD + "start: {q: [1]}\n", "is not a number"),
        (GOOD + "keep: m\n", "keep is not a list"),
        (GOOD + "fixed_step: maybe\n", "one of True, False"),
        (GOOD + "samples: 2\n", "samples out of range"),
        ("a: &x 1\nb: *x\n", "anchors and aliases are refused"),
    ],
)
def test_invalid_scene_files_are_refused(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(sf.DescriptionError) as raised:
        read(tmp_path, text)
    assert words in str(raised.value)


def test_a_file_that_is_too_large_is_refused(tmp_path: Path) -> None:
    with pytest.raises(sf.DescriptionError, match="too large"):
        read(tmp_path, "#" * (1 << 20) + GOOD)


def test_other_tolerances_change_the_bounds() -> None:
    outputs = (sf.Output("a", "speed", "q", relative=0.1), sf.Output("b", "effort", "q", absolute=1.0))
    scene = sf.Scene(1.0, outputs)
    assert [(one.absolute, one.relative) for one in scene.within(0.5).outputs] == [(0.5, 0.0), (0.5, 0.0)]
    assert scene.within({"b": 2.0}).outputs == (outputs[0], sf.Output("b", "effort", "q", absolute=2.0))
    with pytest.raises(sf.DescriptionError, match="did you mean 'b'"):
        scene.within({"B": 1.0})
    with pytest.raises(sf.DescriptionError, match="unknown kind"):
        sf.Output("a", "place", "q", absolute=1.0)  # type: ignore[arg-type]


def test_tolerances_are_absolute_plus_relative_to_travel() -> None:
    output = sf.Output("a", "position", "tip", absolute=0.1, relative=0.01)
    assert output.bound(np.array([[1.0, 0, 0], [1.0, 3.0, 4.0]])) == pytest.approx(0.15)
