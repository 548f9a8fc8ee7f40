"""Reference numbers of beams; each file says what it holds, with which parameters, and where it comes from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

DATA = Path(__file__).parent / "data"


def data(name: str) -> dict[str, Any]:
    """The numbers of one file."""
    found: dict[str, Any] = json.loads((DATA / f"{name}.json").read_text())["reference"]
    return found


def source(name: str) -> str:
    """Where they come from, in words."""
    return str(json.loads((DATA / f"{name}.json").read_text())["source"])
