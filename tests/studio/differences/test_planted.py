"""Single changed entries of robots' files: what changes the mechanism is named, the rest is called the same."""

from functools import cache
from pathlib import Path

import pytest

import symofros as sf
from symofros.studio.differences.diff import MechanismDiff, read_fully
from tests.studio.differences.planted import FLOATING, Planted, original, planted, shows

# 200 in all.
COUNTS = {"ur5": 50, "panda": 50, "go2": 50, "icub": 10, "creature": 40}

# What may be undone by another zero or sign of coordinates: then the joint is named, and the mechanism is the same. The
# mass of a free body that carries nothing is anywhere in its frame.
REMAPPED = ("origin rpy", "origin xyz", "axis reversed", "body pos", "geom pos")


def described(text: str, robot: str, folder: Path) -> sf.System:
    path = folder / ("robot.xml" if robot == "creature" else "robot.urdf")
    path.write_text(text, encoding="utf-8")
    return read_fully(path, floating_base=robot in FLOATING)


def verdict(case: Planted, found: MechanismDiff) -> str:
    """What is wrong with the answer; "" if nothing."""
    named = next((item for item in found.differences if case.subject in (item.joint, item.link, *item.names)), None)
    if found.same and case.kind in REMAPPED and any("coordinates" in item.changes for item in found.differences):
        return "" if named is not None and named.entry in case.entries else "the coordinate is not named"
    if not shows(case):
        return "" if found.same else "called different"
    first = found.first_difference
    if first is None or found.same:
        return "called the same"
    return "" if first is named and first.entry in case.entries else f"{first.entry} of {first.subject} is named"


@pytest.mark.parametrize(("robot", "seed"), [(robot, k) for robot, n in COUNTS.items() for k in range(n)])
def test_a_planted_difference_is_named(robot: str, seed: int, tmp_path: Path) -> None:
    case = planted(robot, seed)
    found = sf.diff(read_original(robot), described(case.text, robot, tmp_path))
    assert not verdict(case, found), f"{case.kind} of {case.subject}\n{found}"


@cache
def read_original(robot: str) -> sf.System:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        return described(original(robot), robot, Path(folder))
