"""What the site adds to Sphinx: links out of docs/, figures of reports, numbers of equations, docstrings."""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

import pytest

from tests.docs.pages import ROOT
from tests.late import require

require("sphinx", "docs")


@pytest.fixture
def extension(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Gives the extensions by name."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    return lambda name: import_module(f"site_extensions.{name}")


@pytest.mark.parametrize(
    ("page", "link", "turned"),
    [
        ("mjcf.md", "../symofros/NOTATION.md", "conventions.md"),
        ("theory/rigid.md", "../../symofros/NOTATION.md#glossary", "../conventions.md#glossary"),
        ("howto/batches.md", "../../reports/timing.md", "path:../../reports/timing.md"),
        ("howto/batches.md", "../yaml.md", "../yaml.md"),
        ("index.md", "https://example.org/a.md", "https://example.org/a.md"),
    ],
)
def test_links_resolve_to_pages_or_files(extension: Any, page: str, link: str, turned: str) -> None:
    assert extension("links").inside(f"[x]({link})", ROOT / "docs" / page, ROOT) == f"[x]({turned})"


def test_equation_numbers_become_anchors(extension: Any) -> None:
    shown = extension("equations").as_equations("f = m a + U S      (9)\n  with a < b\nn = c    (22a)")
    text, numbers = re.findall(r"<pre[^>]*>(.*?)</pre>", shown, re.DOTALL)
    assert text.split("\n") == ["f = m a + U S", "  with a &lt; b", "n = c"]
    assert re.findall(r'id="([^"]+)"', numbers) == ["eq-9", "eq-22a"] and numbers.count("\n") == 2
    assert extension("equations").as_equations("y = f(2)\nz = 3") == ""


def test_every_equation_of_the_theory_has_a_number_of_its_own() -> None:
    for page in sorted((ROOT / "docs/theory").glob("*.md")):
        numbers = re.findall(r"^    .*\s{2,}\((\d+[a-z]?)\)$", page.read_text(encoding="utf-8"), re.MULTILINE)
        assert len(numbers) == len(set(numbers)), page.name


def test_a_figure_is_found_by_its_section_and_position(extension: Any) -> None:
    figure = extension("figures").figure
    one, two, other = (f"<figure>{name}</figure>" for name in ("one", "two", "other"))
    page = f'<h2>Unnamed</h2>{other}<h2 id="cost">Cost</h2>{one} {two}<h2 id="rest">Rest</h2>{other}'
    assert figure(page, "cost", 2) == two
    for anchor, position in (("cost", 3), ("cost", 0), ("costs", 1), ("", 1)):
        with pytest.raises(LookupError):
            figure(page, anchor, position)


def test_the_gallery_names_existing_figures(extension: Any) -> None:
    """The site's build says so too, but only after minutes."""
    named = re.findall(r"^```\{report-figure\} (\w+) (\w+) (\d)$", (ROOT / "docs/gallery.md").read_text("utf-8"), re.M)
    assert len(named) > 10
    for report, anchor, position in named:
        page = (ROOT / f"reports/{report}.html").read_text(encoding="utf-8")
        assert extension("figures").figure(page, anchor, int(position)).count("<svg"), (report, anchor)


def test_figures_have_colours_for_light_and_dark(extension: Any) -> None:
    colors = extension("figures").colors((ROOT / "reports/accuracy.html").read_text(encoding="utf-8"))
    assert colors.count("--ink:") == 3 and "body[data-theme=dark]" in colors


def test_stars_and_bars_in_formulas_are_escaped(extension: Any) -> None:
    escaped = extension("docstrings").escaped
    assert escaped("|phi| < `a*b` * c") == r"\|phi\| < `a*b` \* c"
    assert escaped('"file:line" of objects') == r'"\file:line" of objects'
