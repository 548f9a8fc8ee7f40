"""How bodies look by their files: what is read of it, and that nothing else depends on it."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import pytest

import symofros as sf
from symofros.description.visual import MAX_VISUALS, Visual

ROBOT = """<robot name="arm"><material name="sky"><color rgba="0 0.5 1 1"/></material>
<link name="base"/>
<link name="upper"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
%s</link>
<joint name="q1" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>
"""
BOX = '<box size="1 2 3"/>'


def visual(geometry: str, more: str = "") -> str:
    return f"<visual>{more}<geometry>{geometry}</geometry></visual>"


def load(folder: Path, inside: str) -> sf.System:
    file = folder / "robot" / "urdf" / "arm.urdf"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(ROBOT % inside)
    return sf.load(file)


def shapes(folder: Path, inside: str) -> tuple[Visual, ...]:
    return load(folder, inside).visuals.get("upper", ())


@pytest.mark.parametrize(
    ("stated", "where"),
    [
        ("hand.stl", "robot/urdf/hand.stl"),
        ("meshes/hand.stl", "robot/urdf/meshes/hand.stl"),
        ("package://robot/meshes/hand.stl", "robot/meshes/hand.stl"),
        ("model://robot/meshes/hand.stl", "robot/meshes/hand.stl"),
        ("package://other/hand.stl", "robot/urdf/other/hand.stl"),
        ("package://other/hand.stl", "robot/urdf/hand.stl"),
    ],
)
def test_meshes_are_found_in_the_folder_and_the_package(stated: str, where: str, tmp_path: Path) -> None:
    (tmp_path / where).parent.mkdir(parents=True)
    (tmp_path / where).write_bytes(b"whatever")  # It is not opened.
    (shape,) = shapes(tmp_path, visual(f'<mesh filename="{stated}" scale="1 -1 0.001"/>'))
    assert shape.kind == "mesh" and shape.size == (1.0, -1.0, 0.001)
    assert shape.file == str((tmp_path / where).resolve())


@pytest.mark.parametrize(
    "stated",
    [
        "../secret.stl",
        "/etc/passwd",
        "file:///etc/passwd",
        "package://robot/../secret.stl",
        "link.stl",
        "package://../secret.stl",
        "missing.stl",
        "",
        "http://example.org/x.stl",
        "x" * 5000,
        "loop.stl",
        "package://a//etc/passwd",
    ],
)
def test_meshes_outside_the_folder_are_not_read(stated: str, tmp_path: Path) -> None:
    for place in (tmp_path / "secret.stl", tmp_path / "robot" / "secret.stl"):
        place.parent.mkdir(exist_ok=True)
        place.write_bytes(b"secret")
    (tmp_path / "robot" / "urdf").mkdir()
    (tmp_path / "robot" / "urdf" / "link.stl").symlink_to(tmp_path / "secret.stl")
    (tmp_path / "robot" / "urdf" / "loop.stl").symlink_to(tmp_path / "robot" / "urdf" / "loop.stl")
    system = load(tmp_path, visual(f'<mesh filename="{stated}"/>'))
    assert not system.visuals and any("visual shapes that can't be drawn ignored" in note for note in system.notes)


def test_visuals_beyond_the_limit_are_dropped(tmp_path: Path) -> None:
    assert len(shapes(tmp_path, visual(BOX) * (MAX_VISUALS + 5))) == MAX_VISUALS


def test_visuals_do_not_affect_the_mechanics(tmp_path: Path) -> None:
    plain, dressed = load(tmp_path, ""), load(tmp_path, visual(BOX))
    assert plain == dressed and repr(plain) == repr(dressed) and dressed.visuals and not plain.visuals
    models = [sf.compile(system, sf.Options(backend="interpreter")) for system in (plain, dressed)]
    assert models[0].record.hash == models[1].record.hash


def test_visuals_stay_with_copies_of_a_system(tmp_path: Path) -> None:
    system = load(tmp_path, visual(BOX))
    assert pickle.loads(pickle.dumps(system)).visuals == system.visuals
    assert system.with_bodies(replace(system.body("upper"), waive=())).visuals == system.visuals
    with pytest.raises(TypeError):
        system.visuals["upper"] = ()  # type: ignore[index]
