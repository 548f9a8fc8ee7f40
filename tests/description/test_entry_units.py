"""Units of entries: as docstrings state them, and the same without docstrings (`python -OO`)."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

import symofros.description
from symofros.description.entries import descriptions
from symofros.description.entry_units import ENTRY_UNITS

_UNIT = re.compile(r"\[([^\]]+)\]")
# Its stations are in m as well: the load's units come first.
_FIRST = {("BeamLoad", "force"): 2}
WRONG = """\
symofros: 1
system: {name: wrong}
parameters: {L: {value: 1.0, unit: kg}, F: {value: 1.0, unit: kg}}
bodies:
  a:
    joint: {kind: revolute, name: q, axis: [0, 0, 1]}
    inertia: {mass: 1.0, center_of_mass: [L, 0, 0], moments: [1, 1, 1]}
  b:
    joint: {kind: fixed, parent: a}
    beam: {length: 1.0, rhoA: 1.0, EI_z: 10.0, bend_y: 1, loads: [{force: [0, F, 0]}]}
"""


def nouns() -> dict[str, type]:
    """Classes of descriptions by name."""
    found: dict[str, type] = {}
    for module in pkgutil.walk_packages(symofros.description.__path__, "symofros.description."):
        if ".usd" not in module.name:
            members = inspect.getmembers(importlib.import_module(module.name), inspect.isclass)
            found |= {name: cls for name, cls in members if cls.__module__ == module.name}
    return found


@pytest.mark.skipif(sys.flags.optimize > 1, reason="docstrings are gone")
@pytest.mark.parametrize("name", ENTRY_UNITS)
def test_units_are_those_that_the_docstring_states(name: str) -> None:
    of_entries = {}
    for entry, text in descriptions(nouns()[name]).items():
        units = tuple(unit for stated in _UNIT.findall(text) for unit in stated.split(" or "))
        if units:
            of_entries[entry] = units[: _FIRST.get((name, entry), len(units))]
    assert of_entries == ENTRY_UNITS[name]


@pytest.mark.parametrize("level", ["", "-O", "-OO"])
def test_wrong_units_are_noted_whatever_python_leaves_out(level: str, tmp_path: Path) -> None:
    (tmp_path / "wrong.yaml").write_text(WRONG)
    command = [sys.executable, *([level] if level else []), "-m", "symofros", "info", "wrong.yaml"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    said = " ".join((run.stdout + run.stderr).split())
    assert run.returncode == 0, said
    assert "body 'a': center_of_mass: unit kg" in said
    assert "beam 'b': load: unit kg" in said
