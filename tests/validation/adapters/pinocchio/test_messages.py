"""urdfdom's complaints are kept, and are not written among the lines of a check."""

from __future__ import annotations

import os

import pytest

from validation.adapters.pinocchio.urdf import parser_messages

pin = pytest.importorskip("pinocchio")
SLIDE = (
    "<robot name='r'><link name='a'/><link name='b'/><joint name='slide' type='prismatic'><parent link='a'/>"
    "<child link='b'/><limit upper='inf' lower='0' effort='1' velocity='1'/></joint></robot>"
)


def test_messages_of_the_parser_are_kept_and_later_lines_are_written(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="valid URDF"), parser_messages() as said:
        pin.buildModelFromXML(SLIDE)
    assert "upper value (inf)" in said[0]
    with parser_messages() as said:
        os.write(2, b"  one\n\n")
    assert said == ["one"]
    os.write(2, b"after\n")
    assert capfd.readouterr().err == "after\n"
