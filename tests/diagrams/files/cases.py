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
