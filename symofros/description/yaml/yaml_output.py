"""Data as YAML text that the reader finds unchanged in it, whatever signs its texts and keys hold."""

from __future__ import annotations

import re
from collections.abc import Mapping
from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.scalarstring import SingleQuotedScalarString

from symofros.description.yaml.yaml_nodes import scalar_of

LINE_WIDTH = 120
_ENDLESS = 1 << 30
_YAML_INDICATORS = frozenset("?:,[]{}#&*!|>'\"%@`~")
_BLANKS_OR_ESCAPES = re.compile(r"  |\\")


def key_text(text: str) -> str:
    """A key, in quotes where YAML would take its first sign for its own, or lose blanks at which it breaks lines."""
    return SingleQuotedScalarString(text) if text[:1] in _YAML_INDICATORS or _BLANKS_OR_ESCAPES.search(text) else text


def value_text(text: str) -> str:
    """The same of a value, which without quotes could be a number or nothing: a joint called 1e3."""
    return key_text(text) if isinstance(scalar_of(text), str) else SingleQuotedScalarString(text)


def yaml_text(styled: Any) -> str:
    """The text of a document: mappings and sequences with their style, texts as above, numbers."""
    stream = StringIO()
    yaml = YAML()
    # A key is on one line, which the emitter does not mind.
    yaml.width = LINE_WIDTH if _longest_key(styled) < LINE_WIDTH // 2 else _ENDLESS
    yaml.dump(styled, stream)
    return stream.getvalue()


def _longest_key(value: Any) -> int:
    if isinstance(value, Mapping):
        return max((max(len(str(key)), _longest_key(item)) for key, item in value.items()), default=0)
    return max(map(_longest_key, value), default=0) if isinstance(value, list) else 0
