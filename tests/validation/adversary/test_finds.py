"""What `python -m validation adversary` found, shrunk, and what became of it: all scenes are sound now."""

from __future__ import annotations

from pathlib import Path

import pytest
from ruamel.yaml import YAML

from validation.adversary.attack import Scene
from validation.adversary.report import ATTACKS

FINDS = YAML(typ="safe").load(Path(__file__).with_name("finds.yaml"))


@pytest.mark.parametrize(
    ("attack", "scene"),
    [
        pytest.param(attack, find["scene"], id=f"{attack}-{find['mended']}")
        for attack, finds in FINDS.items()
        for find in finds
    ],
)
def test_a_find_is_mended(attack: str, scene: Scene) -> None:
    verdict = ATTACKS[attack].verdict(scene)
    assert verdict.sound, verdict.said
