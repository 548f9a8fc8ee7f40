"""A folder with a small diagram that tests change."""

from __future__ import annotations

import shutil
from pathlib import Path

import reference_models

ARM = Path(reference_models.__file__).parent / "rigid" / "double_pendulum.yaml"

TEXT = """\
symofros_diagram: 1
name: held_arm
models:
  arm: {file: arm.yaml, start: {q1: 0.5, dq2: 0.1}, parameters: {m2: 0.9}}
simulation:
  t_end: 0.2
  dt: 1.0e-3
  record: 0.01
  plots:
    - {title: Joints, signals: [plant.q]}
    - ["pd.effort[0]"]
    - plant.v
blocks:
  plant:
    kind: forward_dynamics
    model: arm
    inputs: {u: pd.effort}
  pd:
    kind: joint_pd
    kp: [40, 20]
    kd: 2
    period: 0.01
    inputs:
      q: plant.q
      v: plant.v
      q_desired: plant.q
outlets: {effort: pd.effort}
"""


def folder_with(path: Path, text: str = TEXT) -> Path:
    """Write the diagram and its model; the diagram's file."""
    shutil.copy(ARM, path / "arm.yaml")
    file = path / "diagram.yaml"
    file.write_text(text)
    return file


def line_of(text: str, words: str) -> int:
    """The line that some words are in."""
    return next(i for i, line in enumerate(text.splitlines(), 1) if words in line)
