"""Frames of SDFormat that refer to each other in long chains: each is looked at a bounded number of times."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.sdf import frames as sdf_frames
from tests.models import interpreted

_MODEL = """<sdf version="1.9"><model name="m">{frames}<link name="a"><inertial><mass>1</mass></inertial></link>
<joint name="j" type="revolute"><parent>world</parent><child>a</child><pose relative_to="f{last}"/>
<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"""


def chain(count: int, first: str = "a") -> str:
    """Frames f0, f1, ..., each in the one before and fixed to it, the last first; the first is fixed to another."""
    names = [first, *(f"f{k}" for k in range(count))]
    stated = [
        f'<frame name="{own}" attached_to="{other}"><pose relative_to="{other}">0 0 0.001 0 0 0</pose></frame>'
        for other, own in zip(names, names[1:], strict=False)
    ]
    return _MODEL.format(frames="".join(reversed(stated)), last=count - 1)


class Counting(dict[str, Any]):
    """A mapping that counts how often it is asked."""

    asked = 0

    def __getitem__(self, key: str) -> Any:
        """As of a dict."""
        Counting.asked += 1
        return super().__getitem__(key)


def test_frame_look_ups_grow_linearly(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = sdf_frames.Frames.__init__

    def counted(self: sdf_frames.Frames, *arguments: Any) -> None:
        made(self, *arguments)
        self.nodes = Counting(self.nodes)

    monkeypatch.setattr(sdf_frames.Frames, "__init__", counted)
    asked = []
    for count in (100, 400):
        Counting.asked = 0
        file = tmp_path / "chain.sdf"
        file.write_text(chain(count))
        assert sf.load(file).bodies[-1].name == "a"
        asked.append(Counting.asked)
    assert asked[1] < 5 * asked[0]


def test_circular_frame_references_are_reported_once_of_each_kind(tmp_path: Path) -> None:
    file = tmp_path / "circle.sdf"
    file.write_text(chain(50, "f49"))
    with pytest.raises(sf.DescriptionError, match="its frame refers to itself") as raised:
        sf.load(file)
    assert [problem.what for problem in raised.value.problems] == ["frame 'f49': its frame refers to itself"] * 2


_NESTED = """<model name="m"><pose>10 0 0 0 0 1.5</pose><link name="a"><pose>1 0 0 0 0 0</pose></link>
<joint name="j" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 0 1</xyz></axis></joint>
<model name="in"><pose{frame}>0 2 0 0.3 0 0</pose><link name="b"><pose>0 0 3 0 0 0</pose></link></model>
<joint name="k" type="fixed"><parent>a</parent><child>in::b</child></joint></model>"""


@pytest.mark.parametrize("outer", ["{}", '<world name="w">{}</world>'])
def test_a_nested_model_stands_in_the_frame_of_the_model_around_it(tmp_path: Path, outer: str) -> None:
    """Drake's places: the rotation about z by 1.5 takes (0, 2) to (-2 sin 1.5, 2 cos 1.5)."""
    file = tmp_path / "nested.sdf"
    for frame in ("", ' relative_to="__model__"'):
        file.write_text(f'<sdf version="1.9">{outer.format(_NESTED.format(frame=frame))}</sdf>')
        model = interpreted(sf.load(file))
        name = next(name for name in model.names.frames if name.endswith("in::b"))
        p, _ = model.frame_pose(name, [0.0])
        y = 2.0 - 3.0 * np.sin(0.3)  # In the frame of the model around it, x being zero.
        expected = (10.0 - y * np.sin(1.5), y * np.cos(1.5), 3.0 * np.cos(0.3))
        np.testing.assert_allclose(p, expected, rtol=0, atol=1e-14)
