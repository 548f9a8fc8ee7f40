"""docs/environments.md says which functions each environment has, as the environments' own lists do."""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

import pytest

from symofros.base.functions import FUNCTIONS
from tests.docs.pages import ROOT


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Any:
    """What makes the page's tables."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    return import_module("site_extensions.environments")


def test_the_environments_page_matches_its_source_lists(made: Any) -> None:
    page = made.PAGE.read_text(encoding="utf-8")
    assert made.rendered(page) == page, "run: python -m docs.site_extensions.environments"


def test_environments_cite_existing_functions_and_tests(made: Any) -> None:
    for environment in made.environments():
        assert environment.functions and environment.functions <= FUNCTIONS.keys(), environment.name
        assert all((ROOT / test).exists() for test in environment.tests), environment.name


def test_cited_evidence_of_environments_exists() -> None:
    _, _, shown = (ROOT / "docs/environments.md").read_text(encoding="utf-8").partition("## How each is shown")
    files = {name.replace(".", "/") + ".py" for name in re.findall(r"-m (validation\.[\w.]+)", shown)}
    files |= set(re.findall(r"(?:validation|examples)/[\w/]+\.(?:py|mjs)", shown))
    assert len(files) >= 3 and all((ROOT / file).is_file() for file in files)
    commands = set(re.findall(r"python -m validation (\w+)", shown))
    assert commands and commands <= set(
        re.findall(r"python -m validation (\w+)", (ROOT / "reports/README.md").read_text())
    )
