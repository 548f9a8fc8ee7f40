"""Reference numbers in files; each says what it holds, with which parameters, and where it comes from."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class References:
    """The files of one folder."""

    folder: Path

    def data(self, name: str) -> dict[str, Any]:
        """The numbers of one file."""
        reference: dict[str, Any] = self._read(name)["reference"]
        return reference

    def source(self, name: str) -> str:
        """Source of the references, in words."""
        return str(self._read(name)["source"])

    def _read(self, name: str) -> dict[str, Any]:
        document: dict[str, Any] = json.loads((self.folder / f"{name}.json").read_text())
        return document
