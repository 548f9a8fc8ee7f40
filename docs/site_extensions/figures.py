"""Figures of the reports, taken from reports/*.html: `{report-figure} accuracy spinning 2`, the second of a section.

A section is named by its anchor, which stays when sections are added before it, as its number does not.

The reports themselves are copied beside the site's pages, so that a figure leads to the page it is from.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

# A section that is folded has its anchor within.
_SECTION = re.compile(r'(?=<h2 |<h2>|<div id=")')
_FIGURE = re.compile(r"<figure>.*?</figure>", re.DOTALL)
_COLORS = re.compile(r":root \{ (--ink[^}]*) \}")


def figure(page: str, anchor: str, position: int) -> str:
    """A figure of a report's page, as HTML.

    Args:
        page: The page's HTML.
        anchor: Anchor of the section.
        position: Position among the section's figures, from 1.

    Raises:
        LookupError: The page has no such section, or the section no such figure.
    """
    begins = tuple(f'<{tag} id="{anchor}">' for tag in ("h2", "div"))
    sections = [text for text in _SECTION.split(page) if text.startswith(begins)]
    figures = _FIGURE.findall(sections[0]) if sections else []
    if not 1 <= position <= len(figures):
        raise LookupError(f"{anchor} {position}")
    return str(figures[position - 1])


def colors(page: str) -> str:
    """The colours that figures name, for the site's light and dark."""
    light, dark = _COLORS.findall(page)
    return (
        f"body {{ {light} }} body[data-theme=dark] {{ {dark} }} "
        f"@media (prefers-color-scheme: dark) {{ body:not([data-theme=light]) {{ {dark} }} }}"
    )


class ReportFigure(SphinxDirective):
    """A figure of a report, by the report's name, the section's anchor and the position within the section."""

    required_arguments = 3

    def run(self) -> list[nodes.Node]:
        """The figure, with a link to its report."""
        report, anchor, position = self.arguments
        path = Path(self.env.srcdir).parent / "reports" / f"{report}.html"
        self.env.note_dependency(str(path))
        page = path.read_text(encoding="utf-8")
        try:
            picture = figure(page, anchor, int(position))
        except LookupError:
            raise self.error(f"reports/{report}.html has no figure {position} in a section '{anchor}'") from None
        address = "../" * self.env.docname.count("/") + f"reports/{report}.html"
        shown = f'<div class="report-figure">{picture}<p><a href="{address}">The whole report: {report}</a></p></div>'
        if not self.env.temp_data.get("report_colors"):
            self.env.temp_data["report_colors"] = True
            shown = f"<style>{colors(page)}</style>{shown}"
        return [nodes.raw("", shown, format="html")]


def _copy_reports(app: Sphinx, failure: Exception | None) -> None:
    if failure is None and app.builder.format == "html":
        folder = Path(app.outdir) / "reports"
        folder.mkdir(exist_ok=True)
        for path in (Path(app.srcdir).parent / "reports").glob("*.html"):
            shutil.copy(path, folder)


def setup(app: Sphinx) -> Mapping[str, Any]:
    """Called by Sphinx."""
    app.add_directive("report-figure", ReportFigure)
    app.connect("build-finished", _copy_reports)
    return {"parallel_read_safe": True}
