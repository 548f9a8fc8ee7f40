"""Bodies of a golden case, one a line of YAML, as a system."""

from __future__ import annotations

from pathlib import Path

import symofros as sf

# Bodies for which a case states no inertia.
_SOLID = "{mass: 1, moments: [1, 1, 1]}"


def system_of_bodies(lines: str, folder: Path) -> sf.System:
    """The system with these lines as bodies; those on joints that state no inertia get that of a solid."""
    bodies = [
        line[:-1] + f", inertia: {_SOLID}}}" if "joint:" in line and "beam:" not in line else line
        for line in lines.splitlines()
    ]
    stated = ["symofros: 1", "system: {name: s}", "bodies:", *(f"  {line}" for line in bodies)]
    (folder / "s.yaml").write_text("\n".join(stated), encoding="utf-8")
    return sf.load(folder / "s.yaml")
