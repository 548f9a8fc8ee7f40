"""Results -> pareto.html (one self-contained page), pareto.md, pareto.json (every run; a later one goes on from it)."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from symofros.runtime.toolchain import DEFAULT_FLAGS
from validation.evidence import charts
from validation.pareto import words
from validation.pareto.catalogue import SCENES
from validation.pareto.figures import figure, letters
from validation.pareto.front import charted, front
from validation.pareto.race import Result
from validation.pareto.scene import Point, Scene
from validation.reporting.page import compact, number, render, run_data, versions, write_pages
from validation.reporting.record import machine

ENGINES = ("mujoco", "exudyn", "pin")
FLAGS = " ".join(DEFAULT_FLAGS)


@dataclass(frozen=True)
class Page:
    """A scene with its result."""

    scene: Scene
    result: Result

    @property
    def verdicts(self) -> list[words.Verdict]:
        """Of its targets."""
        return words.verdicts(self.scene, self.result.points)

    @property
    def trusted(self) -> bool:
        """Whether the references agree below what targets ask."""
        return self.result.agreement <= self.scene.trust

    @property
    def ok(self) -> bool:
        """Whether the targets are met, and references are to be trusted."""
        return self.trusted and all(verdict.ok for verdict in self.verdicts)

    @property
    def named(self) -> list[tuple[str, Point]]:
        """The runs of the front, with the letters of the figure."""
        best = front(charted(self.scene, self.result.points))
        return list(zip(letters(len(best)), best, strict=True))


@dataclass(frozen=True)
class Comparison:
    """One run of the command, with what earlier ones left.

    Attributes:
        results: Short name -> result.
        failures: Short name -> why it could not be done.
        quick: Whether few contestants ran.
        unfinished: Scenes that Ctrl-C cut.
        seconds: Wall time of the scenes.
        dates: Short name -> when it was run (UTC).
    """

    results: dict[str, Result]
    failures: dict[str, str]
    quick: bool
    unfinished: tuple[str, ...]
    dates: dict[str, str]

    @property
    def seconds(self) -> float:
        """Wall time of the scenes."""
        return sum(result.seconds for result in self.results.values())

    @property
    def pages(self) -> dict[str, Page]:
        """In the catalogue's order."""
        return {name: Page(SCENES[name], self.results[name]) for name in SCENES if name in self.results}

    @property
    def ok(self) -> bool:
        """Whether all was done and every target met."""
        done = bool(self.results) and not self.failures and not self.unfinished
        return done and all(page.ok for page in self.pages.values())

    @property
    def headline(self) -> str:
        """The verdict in a sentence."""
        found = [verdict for page in self.pages.values() for verdict in page.verdicts]
        met = sum(verdict.ok for verdict in found)
        runs = sum(len(result.points) for result in self.results.values())
        said = f"{met} of {len(found)} targets met, on {len(self.results)} scenes with {runs} ways through them"
        doubted = [name for name, page in self.pages.items() if not page.trusted]
        said += f"; references disagree on {', '.join(doubted)}" if doubted else ""
        said += f"; {len(self.failures)} could not be done" if self.failures else ""
        return said + (f"; interrupted before {', '.join(self.unfinished)}." if self.unfinished else ".")


def now() -> str:
    """The date for the record."""
    return datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")


def write_report(comparison: Comparison, folder: Path) -> Path:
    """Write the three files.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    data = compact(as_data(comparison))
    return write_pages(folder, "pareto", data, lambda template: _render(template, comparison))


def as_data(comparison: Comparison) -> dict[str, Any]:
    """Everything, as plain data; None where there is no number."""
    scenes = {name: _scene(page, comparison.dates[name]) for name, page in comparison.pages.items()}
    return run_data(comparison, *ENGINES) | {"flags": FLAGS, "unfinished": comparison.unfinished, "scenes": scenes}


def _scene(page: Page, date: str) -> dict[str, Any]:
    scene, result = page.scene, page.result
    return {
        "title": scene.title,
        "measure": scene.measure,
        "ok": page.ok,
        "date": date,
        "agreement": number(result.agreement),
        "trust": scene.trust,
        "references": result.references,
        "floors": dict(result.floors),
        "seconds": round(result.seconds, 1),
        "targets": [asdict(v.target) | {"found": _bounded(v.found), "ok": v.ok} for v in page.verdicts],
        "words": [*words.compared(scene, result.points), *words.advice(scene, result)],
        "front": [point.name for _, point in page.named],
        "points": [asdict(p) | {"error": number(p.error), "seconds": number(p.seconds)} for p in result.points],
    }


def _bounded(found: float) -> float | str | None:
    return "only ours" if math.isinf(found) else number(found)


def read(folder: Path, quick: bool) -> tuple[dict[str, Result], dict[str, str]]:
    """What an earlier run left on this machine, in the same way: results and dates by scene."""
    path = folder / "pareto.json"
    if not path.is_file():
        return {}, {}
    data = json.loads(path.read_text())
    if data["quick"] != quick or data["machine"] != machine():
        return {}, {}
    kept = {name: scene for name, scene in data["scenes"].items() if name in SCENES}
    results = {name: _result(scene) for name, scene in kept.items()}
    return results, {name: scene["date"] for name, scene in kept.items()}


def _result(scene: dict[str, Any]) -> Result:
    def real(x: float | None) -> float:
        return math.nan if x is None else float(x)

    points = tuple(Point(**p | {"error": real(p["error"]), "seconds": real(p["seconds"])}) for p in scene["points"])
    return Result(points, real(scene["agreement"]), scene["references"], scene["floors"], scene["seconds"])


def _render(template: str, comparison: Comparison) -> str:
    drawn = {
        name: figure(page.scene, page.result, words.see(page.scene, page.result))
        for name, page in comparison.pages.items()
    }
    overall = words.overall({name: (page.scene, page.result) for name, page in comparison.pages.items()})
    return render(
        template,
        {"svg": charts.svg, "duration": words.duration},
        comparison=comparison,
        drawn=drawn,
        words=words,
        overall=overall,
        flags=FLAGS,
        versions=versions(*ENGINES),
    )
