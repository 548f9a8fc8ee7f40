"""docs/architecture.md is true: every folder stands in it, with what it may import and where its tests are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.test_layers import ALLOWED, HARNESS, MAY_USE, STUDIES

ROOT = Path(__file__).parent.parent
MAP = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PARTS = dict(re.findall(r"^## (.+)\n((?:(?!^## ).*\n)*)", MAP, re.MULTILINE))


def rows(part: str) -> list[list[str]]:
    lines = [line for line in PARTS[part].splitlines() if line.startswith("| `")]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]


def folders(package: str) -> set[str]:
    root = ROOT / package
    with_modules = {path.parent for path in root.rglob("*.py") if path.name != "__init__.py"}
    return {str(folder.relative_to(root)) for folder in with_modules} - {"."}


def test_every_folder_of_the_package_is_on_the_map() -> None:
    named = {cells[0].strip("`") for cells in rows("symofros/")}
    # The library of blocks is one row, with its folders by name; divided folders have a row for their own purpose.
    assert {name for name in folders("symofros") if not name.startswith("blocks/")} <= named
    assert all((ROOT / "symofros" / name).is_dir() for name in named)


def test_every_folder_of_the_harness_is_on_the_map() -> None:
    named = {cells[0].strip("`") for cells in rows("validation/")}
    assert {name.partition("/")[0] for name in folders("validation")} == named


@pytest.mark.parametrize("cells", rows("symofros/"), ids=lambda cells: cells[0])
def test_imports_are_those_that_are_enforced(cells: list[str]) -> None:
    name, purpose, imports, _ = cells
    layer = name.strip("`").replace("/", ".")
    assert purpose
    if layer in ALLOWED:
        assert set(imports.split()) - {"nothing"} == ALLOWED[layer]


@pytest.mark.parametrize("cells", rows("validation/"), ids=lambda cells: cells[0])
def test_imports_of_the_harness_are_those_that_are_enforced(cells: list[str]) -> None:
    name, purpose, imports, _ = cells
    layer = name.strip("`")
    assert purpose and layer in MAY_USE
    others = set(re.findall(r"\w+", imports.replace("the check's folders", ""))) - {"nothing"}
    assert others == (MAY_USE["oracle"] if layer == "oracle" else (HARNESS | STUDIES)[layer])


def test_every_folder_of_the_documentation_is_on_the_map() -> None:
    named = {cells[0].strip("`") for cells in rows("docs/ and examples/")}
    there = {folder.relative_to(ROOT).as_posix() for folder in (ROOT / "docs").iterdir() if folder.is_dir()}
    assert {name for name in there if Path(name).name not in ("images", "static", "__pycache__")} <= named
    assert all((ROOT / name).is_dir() for name in named)


@pytest.mark.parametrize("part", ["symofros/", "validation/", "docs/ and examples/"])
def test_tests_are_where_the_map_says(part: str) -> None:
    for cells in rows(part):
        path = cells[-1].strip("`")
        assert (ROOT / (path if path.startswith("tests/") else f"tests/{path}")).is_dir(), cells


def test_files_named_in_the_look_ups_exist() -> None:
    paths = [
        path
        for part in ("Look-ups", "To add ...")
        for path in re.findall(r"`((?:symofros|validation|docs)/[^`]*)`", PARTS[part])
    ]
    assert len(paths) > 15
    for path in paths:
        assert (ROOT / path).exists(), path


def test_modules_named_in_texts_of_the_code_exist() -> None:
    """By a path, in docstrings, comments and notes: `mechanics/dynamics/formulas.py`."""
    code = [path for package in ("symofros", "validation") for path in (ROOT / package).rglob("*.py")]
    there = {"/".join(path.parts[first:]) for path in code for first in range(len(ROOT.parts), len(path.parts))}
    named = {
        (path.name, name)
        for path in (*code, ROOT / "symofros/NOTATION.md")
        for name in re.findall(r"`((?:\w+/)+\w+\.py)\b", path.read_text(encoding="utf-8"))
    }
    assert len(named) > 40
    assert {(path, name) for path, name in named if name not in there and not (ROOT / name).exists()} == set()
