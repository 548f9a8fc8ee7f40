"""Studies -> NAME.html (one self-contained page), NAME.md (the numbers), NAME.json (everything)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from validation.evidence.charts import svg
from validation.evidence.findings import Chart, Study
from validation.questions.topic import Topic
from validation.reporting.page import check_data, compact, figure_data, render, run_data, versions, write_pages


@dataclass(frozen=True)
class Answers:
    """One run.

    Attributes:
        topic: What was asked.
        studies: Short name -> what it found.
        failures: Short name -> why it could not be done.
        quick: Whether the short way was taken.
        seconds: Wall time.
    """

    topic: Topic
    studies: dict[str, Study]
    failures: dict[str, str]
    quick: bool
    seconds: float

    @property
    def ok(self) -> bool:
        """Whether all was done and every number is within its bounds."""
        return bool(self.studies) and not self.failures and all(study.ok for study in self.studies.values())

    @property
    def headline(self) -> str:
        """The verdict in a sentence."""
        checks = [check for study in self.studies.values() for check in study.checks]
        missed = sum(not check.ok for check in checks)
        verdict = "all are within their bounds" if not missed else f"{missed} miss their bounds"
        failed = f"; {len(self.failures)} studies could not be done" if self.failures else ""
        studies = "study" if len(self.studies) == 1 else "studies"
        return f"{len(checks)} numbers of {len(self.studies)} {studies}: {verdict}{failed}."


def write_report(run: Answers, folder: Path) -> Path:
    """Write the three files.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    name = run.topic.name
    return write_pages(folder, name, compact(as_data(run)), lambda template: _render(template, run), "questions")


def as_data(run: Answers) -> dict[str, Any]:
    """Everything, as plain data; None where there is no number."""
    return run_data(run) | {"studies": {name: _study(study) for name, study in run.studies.items()}}


def _study(study: Study) -> dict[str, Any]:
    return {
        "title": study.title,
        "answer": study.answer,
        "ok": study.ok,
        "checks": [check_data(check) for check in study.checks],
        "sources": study.sources,
        "figures": [figure_data(figure) for figure in study.figures],
    }


def _render(template: str, run: Answers) -> str:
    return render(template, {"svg": _svg}, run=run, versions=versions())


def _svg(chart: Chart) -> Markup:
    return Markup(svg(chart))
