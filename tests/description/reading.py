"""What tests of readers do: write a text, load it, or say what loading it complains about."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import symofros as sf


def load(folder: Path, text: str | bytes, name: str, **options: Any) -> sf.System:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return sf.load(path, **options)


def refused(path: Path, **options: Any) -> sf.DescriptionError:
    with pytest.raises(sf.DescriptionError) as caught:
        sf.load(path, **options)
    return caught.value


def faults(path: Path, **options: Any) -> str:
    """Everything that loading a file complains about."""
    return str(refused(path, **options))


def faults_of(folder: Path, text: str | bytes, name: str, **options: Any) -> str:
    """All problems that loading a text reports."""
    with pytest.raises(sf.DescriptionError) as caught:
        load(folder, text, name, **options)
    return str(caught.value)
