"""Texts that edits are tried on: the reference models, and one with whatever YAML allows a person to write."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from symofros.studio.editor.editing.data_edits import Path as Steps
from symofros.studio.editor.editing.yaml_spans import YamlText

ROOT = Path(__file__).parents[3] / "reference_models"
# Models lie in folders by kind; scenes and diagrams do not.
FILES = {path.stem: path for path in sorted(ROOT.glob("*/*.yaml"))}

ODD = """\
# head
symofros: 1   # version

# about the system
system:
  name: "we'ird"   # quoted
  gravity:
  - 0
  - 0
  - -9.81  # down
parameters:
  # lengths
  L1: {value: 1, unit: m}   # first

  L2:
    # inner
    value: 2.0e-1
    unit: 'm'
    # tail of L2

  # about L3
  L3: 3
inputs: {}
bodies:
    a:
        joint: {kind: revolute,
                axis: [0,
                       0, 1],   # z
                name: qa}
        frames:
            tip:
            other: {}
    b:    # the second
        joint:
          kind: fixed
          parent: a
        loads:
          - force: [1, 2, 3]
            # about axes
            axes: world
          -   at: body
              torque: [0, "L1, 2", 0]
          - {force: [0,0,1,], }
        waive: []
potentials:
  v: >
    L1 * cos(qa)
  w: |
    2*L1
  x: "3*
    L1"
"""
TEXTS = {name: path.read_text(encoding="utf-8") for name, path in FILES.items()}
TEXTS |= {"odd": ODD, "crlf": ODD.replace("\n", "\r\n"), "open end": ODD.rstrip("\n")}

# Reading a text takes longer than editing it; these are read once.
DATA = {name: YamlText(text).root.plain() for name, text in TEXTS.items()}

# What has a meaning of its own to YAML, or none.
TROUBLE = (
    "abc",
    "L1/2",
    "",
    "atan2(a, b)",
    "- x",
    "#no",
    "a: b",
    "true",
    "12",
    "~",
    "[x]",
    "a\nb",
    "it's",
    '"q"',
    "x #y",
    " lead",
    "trail ",
    "é",
    "\U0001f600",
    "-L/2",
    "*a",
    "&b",
    "!t",
    "%d",
    "@",
    "`",
    "key:",
    "?",
    "? x",
    "-",
    "---",
    "...",
    "a,b",
    "{",
    "}",
    "\u2028",
    "\x07",
    "\ufeff",
    "<<",
    "1e5",
    "0x1f",
    "\t",
    "a" * 200,
    "null",
    "=",
    "0\x1b",
    "a\ufffe",
    "a\x85b",
    "a\xa0",
)
KEYS = ("a", "b c", "x:", "on", "1", "value", "é", "-", "#", "long" * 9, "parameters", "true")

scalars = st.one_of(
    st.integers(-(10**15) + 1, 10**15 - 1),
    st.floats(allow_nan=False),
    st.booleans(),
    st.none(),
    st.sampled_from(TROUBLE),
    st.text(st.characters(exclude_categories=["Cs"]), max_size=20),
)
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(KEYS), inner, max_size=4),
    max_leaves=12,
)


def paths(data: Any, path: Steps = ()) -> list[Steps]:
    """The paths of all entries."""
    pairs = list(data.items()) if isinstance(data, dict) else list(enumerate(data)) if isinstance(data, list) else []
    return [path, *(inner for key, value in pairs for inner in paths(value, (*path, key)))]


def at(data: Any, path: Steps) -> Any:
    for step in path:
        data = data[step]
    return data


PATHS = {name: [path for path in paths(data) if path] for name, data in DATA.items()}
