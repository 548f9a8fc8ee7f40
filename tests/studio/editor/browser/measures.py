"""What tests in the browser measure of the studio on their way, lines of JSON for `python -m validation studio`."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

# File that the lines go to; nothing is kept without it.
FILE = os.environ.get("SYMOFROS_STUDIO_MEASURES")


def noted(what: str, **figures: Any) -> None:
    """Keep figures under a name, and print them."""
    line = json.dumps({"what": what, **figures})
    print(line)
    if FILE:
        with Path(FILE).open("a", encoding="utf-8") as file:
            file.write(line + "\n")
