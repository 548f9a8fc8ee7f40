"""docs/faults.md is true: tests that it names exist."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
# A file, a test, or the beginning of the name of one.
NAMED = re.compile(r"\b(test_\w+)(\.py|\.\.\.)?")


def test_named_tests_exist() -> None:
    paths = list((ROOT / "tests").rglob("test_*.py"))
    files = {path.stem for path in paths}
    functions = {name for path in paths for name in re.findall(r"\bdef (test_\w+)", path.read_text("utf-8"))}
    missing = []
    for name, ending in NAMED.findall((ROOT / "docs" / "faults.md").read_text("utf-8")):
        known = name in files if ending == ".py" else name in functions
        if not known and not (ending == "..." and any(function.startswith(name) for function in functions)):
            missing.append(name + ending)
    assert not missing
