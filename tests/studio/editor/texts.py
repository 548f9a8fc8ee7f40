"""Texts that edits are tried on: the reference models, and one with whatever YAML allows a person to write."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from symofros.studio.editor.editing.data_edits import Path as Steps
from symofros.studio.editor.editing.yaml_spans import YamlText

ROOT = Path(__file__).parents[3] / "reference_models"
# Models lie in folders by kind; scenes and diagrams do not.
FILES = {path.stem: path for path in sorted(ROOT.glob("*/*.yaml"))}

ODD = Path(__file__).with_name("odd.yaml").read_text(encoding="utf-8")
TEXTS = {name: path.read_text(encoding="utf-8") for name, path in FILES.items()}
TEXTS |= {"odd": ODD, "crlf": ODD.replace("\n", "\r\n"), "open end": ODD.rstrip("\n")}

# Reading a text takes longer than editing it; these are read once.
DATA = {name: YamlText(text).root.plain() for name, text in TEXTS.items()}

# What has a meaning of its own to YAML, or none.
TROUBLE = json.loads(Path(__file__).with_name("trouble.json").read_text(encoding="utf-8"))
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
