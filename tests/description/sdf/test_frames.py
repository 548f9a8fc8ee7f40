"""Frames of SDFormat that refer to each other in long chains: each is looked at a bounded number of times."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from symofros.description.sdf import frames as sdf_frames

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
