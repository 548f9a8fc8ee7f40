"""The published JSON Schema is current, legal, and accepts what the reader accepts."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

import reference_models
from symofros.description.yaml.schema import SCHEMA_FILE, json_schema, schema_text

FILES = sorted((Path(reference_models.__file__).parent).glob("*/*.yaml"))


def test_the_published_schema_is_current() -> None:
    assert SCHEMA_FILE.read_text(encoding="utf-8") == schema_text(), "run: python -m symofros.description.yaml.schema"


def test_the_schema_is_legal() -> None:
    jsonschema.Draft202012Validator.check_schema(json.loads(schema_text()))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_schema_accepts_the_reference_models(path: Path) -> None:
    jsonschema.validate(YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8")), json_schema())


def test_the_schema_refuses_unknown_entries() -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"symofros": 1, "bodeis": {}}, json_schema())
