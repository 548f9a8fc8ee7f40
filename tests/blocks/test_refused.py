"""What is stated wrongly of a block is refused: the rows of refused.yaml."""

from __future__ import annotations

from pathlib import Path

import pytest
from ruamel.yaml import YAML

from symofros.diagrams.files.registry import kinds
from tests.blocks.support import refused

ROWS = YAML(typ="safe").load(Path(__file__).with_name("refused.yaml"))


@pytest.mark.parametrize("kind", ROWS)
def test_what_is_wrong_is_said(kind: str) -> None:
    for fields, *says in ROWS[kind]:
        refused(lambda fields=fields: kinds()[kind](name="b", **fields), *says)
