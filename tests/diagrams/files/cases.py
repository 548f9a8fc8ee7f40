"""A folder with a small diagram that tests change."""

from __future__ import annotations

import shutil
from pathlib import Path

import reference_models

ARM = Path(reference_models.__file__).parent / "rigid" / "double_pendulum.yaml"

TEXT = Path(__file__).with_name("held_arm.yaml").read_text()


def folder_with(path: Path, text: str = TEXT) -> Path:
    """Write the diagram and its model; the diagram's file."""
    shutil.copy(ARM, path / "arm.yaml")
    file = path / "diagram.yaml"
    file.write_text(text)
    return file


def line_of(text: str, words: str) -> int:
    """The line that some words are in."""
    return next(i for i, line in enumerate(text.splitlines(), 1) if words in line)


# A joint with damping, friction and a limit, and a free one.
RESISTED = """<robot name="resisted">
  <link name="base"/>
  <link name="arm"><inertial><mass value="1"/><origin xyz="0 0 -0.5"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="9" velocity="9"/><dynamics damping="0.3" friction="0.2"/></joint>
  <joint name="end" type="continuous"><parent link="arm"/><child link="tip"/><axis xyz="0 1 0"/></joint>
</robot>
"""
