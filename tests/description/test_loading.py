from __future__ import annotations

from pathlib import Path

import pytest

import symofros as sf
from reference_models import MODELS


def test_unknown_suffixes_name_the_known_ones(tmp_path: Path) -> None:
    path = tmp_path / "arm.step"
    path.write_text("")
    with pytest.raises(sf.DescriptionError, match=r"unknown format[\s\S]*\.yaml, \.yml, \.urdf"):
        sf.load(path)


def test_a_missing_file_suggests_its_neighbours(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("")
    with pytest.raises(sf.DescriptionError, match=r"does not exist[\s\S]*did you mean 'robot.yaml'"):
        sf.load(tmp_path / "robt.yaml")


def test_save_replaces_files_atomically_and_refuses_other_suffixes(tmp_path: Path) -> None:
    with pytest.raises(sf.DescriptionError, match="written"):
        sf.save(MODELS["pendulum"], tmp_path / "p.urdf")
    sf.save(MODELS["pendulum"], tmp_path / "p.yaml")
    sf.save(MODELS["double_pendulum"], tmp_path / "p.yaml")
    assert [path.name for path in tmp_path.iterdir()] == ["p.yaml"]
    assert sf.load(tmp_path / "p.yaml") == MODELS["double_pendulum"]


def test_checks_are_waived_by_name(tmp_path: Path) -> None:
    path = tmp_path / "arm.yaml"
    path.write_text("symofros: 1\nbodies:\n  finger: {joint: {name: q, kind: revolute}}\n")
    with pytest.raises(sf.DescriptionError, match="moves no mass"):
        sf.load(path)
    assert sf.load(path, waive=["massless_tip"]).body("finger").waive == ("massless_tip",)
    with pytest.raises(sf.DescriptionError, match="did you mean 'massless_tip'"):
        sf.load(path, waive=["masless_tip"])
