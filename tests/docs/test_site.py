"""The site builds without a warning, its tutorial executed on the way, and leaves nothing public out.

What looks at the built site is slow; `.ci/run` runs all of it, each time.
"""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

import symofros as sf
from symofros import blocks
from symofros.__main__ import app as symofros
from tests.docs.pages import ROOT
from tests.late import require
from validation.__main__ import app as validation

for package in ("sphinx", "furo", "myst_nb"):
    require(package, "docs")

BUILD = "-m sphinx -W --keep-going docs build/docs"
# Public names that are no objects of their own: modules of the packages, and what `typing` and Python bring.
BLOCKS = {name for name in vars(blocks) if re.match(r"[A-Z]\w+$", name)}
NAMES = {name for name in dir(sf) if re.match(r"[A-Z]\w+$", name)} - {"TYPE_CHECKING", "Any"}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built site. What cells printed is kept by their content in build/notebooks, so that they run once."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, *BUILD.replace("build/docs", str(folder)).split(), "-q"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.slow
def test_tutorial_pages_show_printed_output(site: Path) -> None:
    steps = sorted((ROOT / "docs/tutorial").glob("*.md"))
    assert len(steps) == 7  # Six, and the index.
    for step in steps:
        page = (site / "tutorial" / step.with_suffix(".html").name).read_text(encoding="utf-8")
        cells = step.read_text(encoding="utf-8").count("```{code-cell}")
        assert page.count('class="cell_input ') == cells or step.stem == "index"
        assert "Traceback" not in page and (step.stem == "index" or page.count("cell_output") >= 3)


@pytest.mark.slow
def test_pages_load_nothing_from_the_network(site: Path) -> None:
    for page in site.rglob("*.html"):
        loaded = re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(https?:[^"]*)"', page.read_text(encoding="utf-8"))
        assert loaded == [], page


@pytest.mark.slow
def test_figures_come_from_the_reports(site: Path) -> None:
    gallery = (site / "gallery.html").read_text(encoding="utf-8")
    reports = set(re.findall(r'href="(reports/\w+\.html)"', gallery))
    assert gallery.count("<svg role") >= 12 and len(reports) >= 6
    assert all((site / report).exists() for report in reports)


@pytest.mark.slow
def test_the_site_documents_the_whole_command_line(site: Path) -> None:
    page = (site / "reference/commands.html").read_text(encoding="utf-8")
    headings = {re.sub("<[^>]+>", "", heading) for heading in re.findall(r"<h3>(.*?)<a ", page)}
    for app, program in ((symofros, "symofros"), (validation, "python -m validation")):
        command: Any = typer.main.get_command(app)
        for name in command.list_commands(typer.Context(command)):
            assert f"{program} {name}" in headings


@pytest.mark.parametrize(("package", "names"), [("symofros", NAMES), ("symofros.blocks", BLOCKS)])
def test_the_reference_has_every_public_class_and_function(package: str, names: set[str]) -> None:
    pages = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "docs/reference").glob("*.md"))
    stated = set(re.findall(r"^\.\. auto\w+:: (\w+)$", pages, re.MULTILINE))
    assert names <= stated
    functions = (
        {name for name in sf._public() if inspect.isfunction(getattr(sf, name))} if package == "symofros" else set()
    )
    assert functions <= stated
