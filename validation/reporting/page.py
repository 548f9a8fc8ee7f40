"""What the pages of several reports share: templates, how numbers look, versions, checks as data."""

from __future__ import annotations

import json
import math
import platform
from collections.abc import Callable, Mapping
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Any, Protocol

import jinja2
import numpy as np

import symofros as sf
from symofros.atomic import write_atomically
from validation.evidence.findings import Chart, Check, Figure
from validation.reporting.provenance import stamp
from validation.reporting.record import machine

# Digits of a curve's points in JSON: more than a figure shows.
DIGITS = 5


def render(template: str, filters: Mapping[str, Callable[..., object]], **values: object) -> str:
    """A template of validation/templates with its values; HTML is escaped, `number` shows a float short."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("validation"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=jinja2.select_autoescape(["html.j2"]),
    )
    environment.filters |= {"number": short, **filters}
    return environment.get_template(template).render(machine=machine(), **values)


class Run(Protocol):
    """What a command that writes a report has done."""

    @property
    def ok(self) -> bool:
        """Whether all was done and every number is within its bounds."""
        ...

    @property
    def failures(self) -> dict[str, str]:
        """What could not be done -> why."""
        ...

    @property
    def quick(self) -> bool:
        """Whether the short way was taken."""
        ...

    @property
    def seconds(self) -> float:
        """Wall time."""
        ...


def run_data(run: Run, *distributions: str) -> dict[str, Any]:
    """How a run went and on what, for JSON."""
    return {
        "ok": run.ok,
        "quick": run.quick,
        "seconds": round(run.seconds, 1),
        "failures": run.failures,
        "versions": versions(*distributions),
        **stamp(),
    }


def write_pages(
    folder: Path, name: str, data: str, rendered: Callable[[str], str], template: str | None = None
) -> Path:
    """Write a report's three files: NAME.json (everything), NAME.md (a summary), NAME.html (one self-contained page).

    Args:
        folder: Made where it is missing.
        name: Of the report.
        data: Its JSON.
        rendered: Template -> text.
        template: Name of the templates; the report's own by default.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / f"{name}.json", data)
    for kind in ("md", "html"):
        write_atomically(folder / f"{name}.{kind}", rendered(f"{template or name}.{kind}.j2"))
    return folder / f"{name}.html"


def compact(data: Mapping[str, Any]) -> str:
    """JSON on one line."""
    return json.dumps(data, allow_nan=False) + "\n"


def short(x: float) -> str:
    """For people; an unbounded side of a bound is left empty."""
    if not math.isfinite(x):
        return "" if math.isinf(x) else "NaN"
    return f"{x:.6g}" if x == 0.0 or 1e-3 <= abs(x) < 1e5 else f"{x:.2e}"


def number(x: float) -> float | None:
    """For JSON, which has no NaN."""
    return x if math.isfinite(x) else None


def rounded(values: Any) -> list[float | None]:
    """A curve for JSON."""
    return [number(float(f"{x:.{DIGITS}g}")) for x in np.asarray(values, float)]


def check_data(check: Check) -> dict[str, Any]:
    """A check for JSON."""
    fields = {name: number(value) if isinstance(value, float) else value for name, value in asdict(check).items()}
    return fields | {"ok": check.ok}


def figure_data(figure: Figure) -> dict[str, Any]:
    """A figure for JSON: its caption, and each chart's curves."""
    return {"caption": figure.caption, "charts": [_chart(chart) for chart in figure.charts]}


def _chart(chart: Chart) -> dict[str, Any]:
    curves = [
        {"label": curve.label, "kind": curve.kind, "x": rounded(curve.x), "y": rounded(curve.y)}
        for curve in chart.curves
    ]
    return {
        "title": chart.title,
        "x": chart.x,
        "y": chart.y,
        "log": [chart.log_x, chart.log_y],
        "curves": curves,
        "marks": {mark.label: mark.at for mark in chart.marks},
    }


def versions(*distributions: str) -> dict[str, str]:
    """Ours, Python's, and those of NumPy, SciPy and the distributions named."""
    found = {"symofros": sf.__version__, "python": platform.python_version()}
    return found | {name: metadata.version(name) for name in ("numpy", "scipy", *distributions)}
