"""Whether a file states a diagram."""

from __future__ import annotations

import re
from pathlib import Path

_HEAD = re.compile(rb"^(\xef\xbb\xbf)?symofros_diagram[ \t]*:", re.MULTILINE)
_LOOKED_AT = 1 << 16


def is_diagram(path: Path) -> bool:
    """Whether a file states a diagram, by the key that such a file has."""
    if path.suffix.lower() not in (".yaml", ".yml") or not path.is_file():
        return False
    with path.open("rb") as stream:
        return _HEAD.search(stream.read(_LOOKED_AT)) is not None
