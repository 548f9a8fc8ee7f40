"""Scenes and their maps -> stability.html (one self-contained page), stability.md, stability.json (every cell)."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup, escape

from validation.reporting.page import check_data, compact, render, rounded, run_data, versions, write_pages
from validation.stability import heatmap
from validation.stability.scene import FINISHED, Map, Maps, Scene, Verdict

ENGINES = ("mujoco", "exudyn", "pin")


@dataclass(frozen=True)
class Page:
    """A scene that was run.

    Attributes:
        scene: As it is stated.
        maps: What the subjects came to.
        verdict: What follows.
        seconds: Wall time.
    """

    scene: Scene
    maps: Maps
    verdict: Verdict
    seconds: float

    @property
    def ok(self) -> bool:
        """Whether every claim is within its bounds."""
        return all(check.ok for check in self.verdict.checks)

    @property
    def endings(self) -> list[str]:
        """How the runs of each map ended, in words."""
        return [f"{name}: {_endings(found)}" for name, found in self.maps.items()]


def _endings(found: Map) -> str:
    cells = [c for row in found.cells for c in row]
    said = [f"{int(found.good.sum())} of {len(cells)} meet the criterion"]
    said += [f"{found.wrong} come to their end and miss it"] if found.wrong else []
    kinds = Counter(c.ended for c in cells if c.ended not in FINISHED)
    for kind, count in kinds.items():
        first = next(c.note for c in cells if c.ended == kind)
        said.append(f"{count} {kind} (“{first}”)")
    notes = sum("singular posture" in c.note for c in cells)
    said += [f"{notes} report a singular posture"] if notes else []
    return ", ".join(said)


@dataclass(frozen=True)
class Atlas:
    """One run of the command.

    Attributes:
        pages: Short name -> scene.
        failures: Short name -> why it could not be done.
        quick: Whether the grids were coarse.
        unfinished: Scenes that Ctrl-C cut.
        seconds: Wall time.
    """

    pages: dict[str, Page]
    failures: dict[str, str]
    quick: bool
    unfinished: tuple[str, ...]
    seconds: float

    @property
    def ok(self) -> bool:
        """Whether all was done and every claim is within its bounds."""
        done = bool(self.pages) and not self.failures and not self.unfinished
        return done and all(page.ok for page in self.pages.values())

    @property
    def headline(self) -> str:
        """The verdict in a sentence."""
        checks = [check for page in self.pages.values() for check in page.verdict.checks]
        runs = sum(found.values.size for page in self.pages.values() for found in page.maps.values())
        missed = sum(not check.ok for check in checks)
        verdict = "all are within their bounds" if not missed else f"{missed} miss their bounds"
        failed = f"; {len(self.failures)} scenes could not be done" if self.failures else ""
        cut = f" Interrupted: {', '.join(self.unfinished)} not done." if self.unfinished else ""
        return f"{len(checks)} claims on {len(self.pages)} scenes, {runs} runs: {verdict}{failed}.{cut}"


def write_report(atlas: Atlas, folder: Path) -> Path:
    """Write the three files.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    return write_pages(folder, "stability", compact(as_data(atlas)), lambda template: _render(template, atlas))


def as_data(atlas: Atlas) -> dict[str, Any]:
    """Everything, as plain data; None where there is no number."""
    scenes = {name: _page(page) for name, page in atlas.pages.items()}
    return run_data(atlas, *ENGINES) | {"unfinished": atlas.unfinished, "scenes": scenes}


def _page(page: Page) -> dict[str, Any]:
    scene, verdict = page.scene, page.verdict
    return {
        "question": scene.question,
        "setting": scene.setting,
        "x": scene.x.name,
        "y": scene.y.name,
        "quantity": scene.quantity,
        "bound": scene.bound,
        "verdict": verdict.words,
        "see": verdict.see,
        "advice": scene.advice,
        "sources": scene.sources,
        "ok": page.ok,
        "seconds": round(page.seconds, 1),
        "checks": [check_data(check) for check in verdict.checks],
        "maps": {name: _cells(scene, found) for name, found in page.maps.items()},
    }


def _cells(scene: Scene, found: Map) -> dict[str, Any]:
    notes = sorted({c.note for row in found.cells for c in row if c.ended not in FINISHED})
    return {
        "x": [scene.x.label(x) if scene.x.labels else float(x) for x in found.x],
        "y": [scene.y.label(y) if scene.y.labels else float(y) for y in found.y],
        "values": [rounded(row) for row in found.values],
        "ended": [[c.ended for c in row] for row in found.cells],
        "said": notes[:8],
    }


def _render(template: str, atlas: Atlas) -> str:
    return render(template, {"map": _map, "prose": _prose}, atlas=atlas, versions=versions(*ENGINES))


def _map(found: Map, scene: Scene) -> Markup:
    return Markup(heatmap.svg(found, scene.x, scene.y, scene.quantity))


def _prose(text: str) -> Markup:
    """Escaped, with `names of code` set as such."""
    return Markup(re.sub("`([^`]+)`", r"<code>\1</code>", str(escape(text))))
