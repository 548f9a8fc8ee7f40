"""Finds as files: a test that fails until the cause is mended, and the description of its mechanism."""

from __future__ import annotations

import re
from pathlib import Path
from pprint import pformat

import symofros as sf
from symofros.tools import write_atomically

from ..program import PROGRAM
from .attack import Attack
from .search import Find

_TEST = '''"""Found by `{program} adversary --attack {attack}`, and shrunk.

Claim: {claim}.
Route: {route}.
Then: {said}.
"""

from {package}.report import ATTACKS

SCENE = {scene}


def test_{name}() -> None:
    verdict = ATTACKS["{attack}"].verdict(SCENE)
    assert verdict.sound, verdict.said
'''


def name_of(find: Find) -> str:
    """Name of a find, for files and functions."""
    words = re.sub(r"\W+", "_", find.quantity.lower()).strip("_")
    return f"{find.attack}_{words or 'answer'}"


def write_find(find: Find, attack: Attack, folder: Path) -> tuple[Path, Path | None]:
    """Write test_NAME.py and NAME.yaml.

    Returns:
        The test; the description, None where the mechanism can't be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    name = name_of(find)
    scene = pformat(find.scene, width=110, sort_dicts=False)
    said = find.said.replace("\\", "/").replace('"', "'").rstrip(".")
    claims = {"claim": attack.claim, "route": attack.route, "said": said, "program": PROGRAM, "package": __package__}
    text = _TEST.format(attack=attack.name, name=name, scene=scene, **claims)
    test = folder / f"test_{name}.py"
    write_atomically(test, text)
    description: Path | None = folder / f"{name}.yaml"
    try:
        sf.save(attack.system(find.scene), folder / f"{name}.yaml")
    except sf.SymofrosError:
        description = None
    return test, description
