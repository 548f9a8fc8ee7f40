"""docs/yaml.md names the fields of what a whole system has."""

from __future__ import annotations

from dataclasses import fields

import pytest
from ruamel.yaml import YAML

import symofros as sf
from tests.docs.pages import blocks


def block(entry: str) -> str:
    """The code block that begins with an entry."""
    (shown,) = [block.text for block in blocks("docs/yaml.md", "yaml") if block.text.startswith(f"{entry}:")]
    return shown


def test_every_field_of_a_connection_is_shown() -> None:
    (cable,) = YAML(typ="safe").load(block("connections"))["connections"].values()
    assert set(cable) == {field.name for field in fields(sf.Connection)} - {"name"}


@pytest.mark.parametrize("field", ["first", "second", "length"])
def test_closures_show_the_fields_of_a_rod(field: str) -> None:
    assert field in block("closures")
