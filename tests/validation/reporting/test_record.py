"""One record, three renderings: nothing is lost, nothing breaks out of its place."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from validation.reporting import html, markdown
from validation.reporting.figures import Chart, Curve, Figure, Mark
from validation.reporting.findings import Finding
from validation.reporting.plain import plain, restored
from validation.reporting.provenance import Provenance
from validation.reporting.questions import findings_fold
from validation.reporting.record import Bullets, Cell, Report, Section, Table, Text, verdict

LIMIT = Mark("limit", 2.0, "x")
CHART = Chart("t < u", "x  [m]", "y  [s]", (Curve("a", np.array([1.0, np.nan]), np.ones(2), 3),), (LIMIT,))
FINDINGS = (Finding("gap [m]", 2.0, 1.0, reason="asked"), Finding("rate", 1.0, np.inf, 0.5))
SECTION = Section(
    "How | wide?",
    (
        "It is `so`, see [there](#other).",
        Text("Beware.", "bad"),
        Bullets(("one", "two")),
        Table(("who|what", "n"), (("a|b", Cell(verdict(3, False), hint="h")),)),
        Figure("Look.", (CHART,)),
        findings_fold(FINDINGS, "number"),
        Section("Only there", ("hidden",), page_only=True),
    ),
    "how",
    False,
)
REPORT = Report("Title", "1 of 2 missed.", False, ("First.",), (SECTION, Section("Other", ("Last.",), "other")))
NOWHERE = Provenance.of({"date": "2026-11-22", "versions": {"numpy": "2"}})


def test_a_page_shows_everything() -> None:
    page = html.page(REPORT, NOWHERE, "Written by `x`.")
    for text in ("Title", "1 of 2 missed.", "First.", "<code>so</code>", '<a href="#other">there</a>', "Figure 1.1."):
        assert text in page, text
    assert "t &lt; u" in page and "limit: 2" in page and "hidden" in page and "2026-11-22" in page
    assert page.count("details open") == 1 and '<details class="section" open>' in page, "a miss is not folded away"
    assert '<details class="section"><summary><h2>Other</h2>' in page, "what is good is"
    assert 'class="n wrong"' in page and page.count("<b class=bad>missed</b>") == 1


def test_markdown_shows_everything_but_figures() -> None:
    text = markdown.page(REPORT, NOWHERE, "Written by `x`.")
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert "| a\\|b | **missed** 3 |" in rows and "| gap [m] | **missed** 2 |  | 1 | asked |" in rows
    assert "## How | wide?" in text and "Only there" not in text and "svg" not in text and "numpy 2" in text


@pytest.mark.parametrize("text", ["<script>", "[x](javascript:alert)", '[x](#"onclick="y)', "`<b>`", "**<i>**"])
def test_texts_cannot_break_the_page(text: str) -> None:
    shown = html.prose(text)
    assert not re.search(r"<(script|i)>|javascript:alert\"|onclick=\"y\">", shown)


def test_a_chart_survives_its_json() -> None:
    again = restored(Chart, json.loads(json.dumps(plain(CHART), allow_nan=False)))
    assert (again.title, again.marks) == (CHART.title, (LIMIT,))
    assert again.curves[0].color == 3 and np.isnan(again.curves[0].x[1])


def test_a_finding_survives_its_json() -> None:
    assert restored(tuple[Finding, ...], plain(FINDINGS)) == FINDINGS
    lost = restored(Finding, plain(Finding("x", np.nan, 1.0)))
    assert np.isnan(lost.value) and not lost.ok
