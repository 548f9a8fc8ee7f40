"""Studies -> accuracy.html (one self-contained page), accuracy.md (the numbers), accuracy.json (everything)."""

from __future__ import annotations

import json
import math
import platform
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup

import symofros as sf
from symofros.atomic import write_atomically
from validation.accuracy.charts import svg
from validation.accuracy.findings import Chart, Study
from validation.record import machine

# Digits of a curve's points in accuracy.json: more than a figure shows.
DIGITS = 5


@dataclass(frozen=True)
class Accuracy:
    """One run.

    Attributes:
        studies: Short name -> what it found.
        failures: Short name -> why it could not be done.
        quick: Whether the short way was taken.
        seconds: Wall time.
    """

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
        return f"{len(checks)} numbers of {len(self.studies)} studies: {verdict}{failed}."


def write_report(run: Accuracy, folder: Path) -> Path:
    """Write the three files.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / "accuracy.json", json.dumps(as_data(run), allow_nan=False) + "\n")
    write_atomically(folder / "accuracy.md", _render("accuracy.md.j2", run))
    write_atomically(folder / "accuracy.html", _render("accuracy.html.j2", run))
    return folder / "accuracy.html"


def as_data(run: Accuracy) -> dict[str, Any]:
    """Everything, as plain data; None where there is no number."""
    return {
        "ok": run.ok, "quick": run.quick, "seconds": round(run.seconds, 1), "failures": run.failures,
        "versions": _versions(), "machine": machine(),
        "studies": {name: _study(study) for name, study in run.studies.items()},
    }  # fmt: skip


def _study(study: Study) -> dict[str, Any]:
    checks = [
        {name: _number(value) if isinstance(value, float) else value for name, value in asdict(check).items()}
        | {"ok": check.ok}
        for check in study.checks
    ]
    figures = [
        {"caption": figure.caption, "charts": [_chart(chart) for chart in figure.charts]} for figure in study.figures
    ]
    return {"title": study.title, "answer": study.answer, "ok": study.ok, "checks": checks,
            "sources": study.sources, "figures": figures}  # fmt: skip


def _chart(chart: Chart) -> dict[str, Any]:
    curves = [{"label": curve.label, "x": _rounded(curve.x), "y": _rounded(curve.y)} for curve in chart.curves]
    return {"title": chart.title, "x": chart.x, "y": chart.y, "curves": curves,
            "marks": {mark.label: mark.at for mark in chart.marks}}  # fmt: skip


def _rounded(values: Any) -> list[float | None]:
    return [_number(float(f"{x:.{DIGITS}g}")) for x in np.asarray(values, float)]


def _number(x: float) -> float | None:
    return x if math.isfinite(x) else None


def _versions() -> dict[str, str]:
    found = {"symofros": sf.__version__, "python": platform.python_version()}
    return found | {name: metadata.version(name) for name in ("numpy", "scipy")}


def _render(template: str, run: Accuracy) -> str:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("validation"), undefined=jinja2.StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, autoescape=jinja2.select_autoescape(["html.j2"]),
    )  # fmt: skip
    environment.filters |= {"number": _short, "svg": _svg}
    return environment.get_template(template).render(run=run, versions=_versions(), machine=machine())


def _svg(chart: Chart) -> Markup:
    return Markup(svg(chart))


def _short(x: float) -> str:
    if not math.isfinite(x):
        return "" if math.isinf(x) else "NaN"
    return f"{x:.6g}" if x == 0.0 or 1e-3 <= abs(x) < 1e5 else f"{x:.2e}"
