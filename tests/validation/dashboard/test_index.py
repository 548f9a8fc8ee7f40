from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.validation.dashboard.test_gather import DIGEST, FUZZ, digest, write
from validation.__main__ import app
from validation.dashboard.catalogue import TOPICS
from validation.dashboard.gather import gather
from validation.dashboard.index import BEGIN, END, QUOTED, QuoteError, brief, quote, write_index
from validation.reporting import evidence
from validation.reporting.html import prose

ROOT = Path(__file__).parents[3]


def quoted(readme: Path) -> str:
    return readme.read_text(encoding="utf-8").partition(f"{BEGIN}\n")[2].partition(END)[0]


def test_the_readme_quotes_the_main_lines_of_the_summary() -> None:
    summary = (ROOT / "reports" / "summary.md").read_text(encoding="utf-8")
    assert quoted(ROOT / "README.md") == brief(summary)
    lines = brief(summary).splitlines()
    assert lines[0] == summary.splitlines()[0] and len(lines) == len(QUOTED) + 4
    assert set(lines) <= set(summary.splitlines())


def test_the_list_of_reports_has_each_with_its_command() -> None:
    listed = (ROOT / "reports" / "README.md").read_text(encoding="utf-8")
    for topic in TOPICS.values():
        assert f"| [{topic.name}]({topic.name}.md) | `{' '.join(topic.command.split()[:4])}" in listed, topic.name
    for link in re.findall(r"\]\(([^)]+)\)", listed):
        assert (ROOT / "reports" / link).is_file(), link


@pytest.fixture
def page(tmp_path: Path) -> str:
    write(tmp_path, FUZZ | {"versions": {"numpy": "<b>1"}})
    path = write_index(gather(tmp_path, {"numpy": "2"}, digest), tmp_path, "2026-11-21 12:00 UTC")
    return path.read_text(encoding="utf-8")


def test_the_page_has_every_report_and_nothing_from_outside(page: str) -> None:
    assert all(f'id="{name}"' in page for name in TOPICS)
    assert not re.search(r'(src|href)="(https?:)?//', page) and "<script" not in page
    assert "is not made yet" in page and "was made with numpy &lt;b&gt;1, now 2" in page


def test_the_readme_keeps_text_around_the_summary(tmp_path: Path) -> None:
    readme = tmp_path / "README.md"
    readme.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    assert quote(readme, "new\n") and readme.read_text() == f"before\n{BEGIN}\nnew\n\n{END}\nafter\n"
    assert quoted(readme) == "new\n\n"
    readme.write_text(f"{END}\n{BEGIN}\n")
    with pytest.raises(QuoteError, match="no '<!-- "):
        quote(readme, "new\n")
    assert not quote(tmp_path / "none", "new\n")


def test_the_dashboard_collects_existing_reports(tmp_path: Path) -> None:
    write(tmp_path, FUZZ)
    readme = tmp_path / "README.md"
    readme.write_text(f"{BEGIN}\n{END}\n")
    result = CliRunner().invoke(app, ["dashboard", "--report", str(tmp_path), "--readme", str(readme)])
    assert result.exit_code == 0 and "fuzz       good" in result.output, result.output
    assert quoted(readme) == brief((tmp_path / "summary.md").read_text())
    write(tmp_path, FUZZ | {"ok": False})
    assert CliRunner().invoke(app, ["dashboard", "--report", str(tmp_path), "--readme", "none"]).exit_code == 1


@pytest.mark.parametrize(
    ("stated", "says"),
    [(DIGEST, ""), ("another", evidence.OLDER), ("", evidence.UNKNOWN)],
)
def test_reports_older_than_the_code_are_marked_everywhere(tmp_path: Path, stated: str, says: str) -> None:
    entries = gather(write(tmp_path, FUZZ | {"digest": stated}), {"numpy": "2.0"}, digest)
    page = write_index(entries, tmp_path, "2026-11-21 12:00 UTC").read_text(encoding="utf-8")
    summary = (tmp_path / "summary.md").read_text(encoding="utf-8")
    assert (f"| 2026-11-20 10:00{'; ' * bool(says)}{says} |" in summary) and (f"; 1 {says}." in summary) == bool(says)
    assert all((text in page) == bool(says) for text in (f"1 {says}.", f"fuzz: good, {says}<")) or not says
    assert says or not any(text in summary + page for text in ("older than", "before reports stated"))


def test_pages_are_rendered_from_stored_measurements(tmp_path: Path) -> None:
    write(tmp_path, FUZZ)
    write(tmp_path, "{", "mutation")
    result = CliRunner().invoke(app, ["render", "fuzz", "--output", str(tmp_path)])
    assert result.exit_code == 0 and "fuzz       good" in result.output
    assert "10 hostile inputs" in (tmp_path / "fuzz.html").read_text() and (tmp_path / "fuzz.md").is_file()
    assert json.loads((tmp_path / "fuzz.json").read_text()) == FUZZ
    assert CliRunner().invoke(app, ["render", "mutation", "--output", str(tmp_path)]).exit_code == 1
    assert CliRunner().invoke(app, ["render", "fuss", "--output", str(tmp_path)]).exit_code == 2


@pytest.mark.parametrize("name", TOPICS)
def test_stored_pages_are_rendered_from_the_numbers_beside_them(name: str) -> None:
    """A page rendered with earlier targets contradicts the index, which reads the numbers."""
    reports = ROOT / "reports"
    report = TOPICS[name].compose(json.loads((reports / f"{name}.json").read_text(encoding="utf-8")))
    assert f"\n**{report.summary}**\n" in (reports / f"{name}.md").read_text(encoding="utf-8")
    assert f">{prose(report.summary)}</p>" in (reports / f"{name}.html").read_text(encoding="utf-8")
