"""What the editor's page knows of joint kinds: a JSON file made of the table of joint kinds.

After a change of the table: `python -m symofros.studio.editor.joint_table`, then build the page (docs/editor.md).
"""

from __future__ import annotations

import json
from pathlib import Path

from symofros.description import KINDS

PAGE_FILE = Path(__file__).with_name("page") / "src" / "model" / "joint_kinds.json"


def joint_table() -> str:
    """The file's text: kind -> speeds and coordinates by suffix and unit, entries of the description, glyph."""
    rows = []
    for name, kind in KINDS.items():
        facts = {
            "speeds": kind.nv,
            "coordinates": kind.coordinate_suffixes,
            "units": [coordinate.unit for coordinate in kind.coordinates],
            "quasi_velocities": kind.speed_suffixes,
            "entries": kind.entries,
            "glyph": kind.glyph,
        }
        lines = ",\n".join(f'    "{key}": {json.dumps(fact)}' for key, fact in facts.items())
        rows.append(f'  "{name}": {{\n{lines}\n  }}')
    return "{\n" + ",\n".join(rows) + "\n}\n"


if __name__ == "__main__":
    PAGE_FILE.write_text(joint_table(), encoding="utf-8")
