"""The published JSON Schema of diagrams is current, legal, and agrees with the reader."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import jsonschema
import pytest
from ruamel.yaml import YAML

from symofros.diagrams.files.schema import SCHEMA_FILE, json_schema, schema_text
from tests.diagrams.files.cases import TEXT

PART = "parts:\n  p: {file: x.yaml, inputs: {a: b.c}}\n  r: {diagram: {blocks: {s: {kind: scope, signals: [x]}}}}\n"
MACHINE = """  mode:
    kind: state_machine
    machine_states: {off: {}, on: {during: {y: 1}}}
    outputs: {y: 0}
    transitions: [{leave: off, enter: on, when: t - 1}]
"""


@cache
def schema() -> Any:
    return json_schema()


def check(text: str) -> None:
    jsonschema.validate(YAML(typ="safe", pure=True).load(text), schema())


def test_the_published_schema_is_current() -> None:
    assert SCHEMA_FILE.read_text(encoding="utf-8") == schema_text(), "run: python -m symofros.diagrams.files.schema"


def test_the_diagram_schema_is_legal() -> None:
    jsonschema.Draft202012Validator.check_schema(json.loads(schema_text()))


def test_the_diagram_schema_accepts_what_the_reader_accepts() -> None:
    check(TEXT)
    check(TEXT + PART)
    check(TEXT.replace("blocks:\n", "blocks:\n" + MACHINE, 1))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("kind: joint_pd", "kind: joint_pdd"),
        ("kd: 2", "gain: 2"),
        ("period: 0.01", "period: soon"),
        ("    kd: 2\n", ""),
        ("t_end: 0.2", "t_end: 0"),
        ("signals: [plant.q]", "signals: plant.q"),
        ("symofros_diagram: 1", "symofros_diagram: 2"),
        ("{file: x.yaml,", "{file: x.yaml, diagram: {},"),
        ("leave: off", "from: off"),
    ],
)
def test_the_diagram_schema_refuses_what_the_reader_refuses(old: str, new: str) -> None:
    text = (TEXT + PART).replace("blocks:\n", "blocks:\n" + MACHINE, 1)
    assert old in text
    with pytest.raises(jsonschema.ValidationError):
        check(text.replace(old, new, 1))
