"""A record -> timing.html (one self-contained page), timing.md, timing.json."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from markupsafe import Markup

from symofros.atomic import write_atomically
from validation.evidence.charts import svg
from validation.evidence.findings import Chart
from validation.reporting.page import render
from validation.timing.flexible.report import flexible_section
from validation.timing.record import Record, as_data
from validation.timing.sections import headline, sections

LIMITS = (
    "One thread, pinned to one processor, whose time on it is what is measured. All sides of a function run in one "
    "process, in turns of 10 ms or more, each a loop in C over the same random states; before, each side's results "
    "are compared with ours, to 1e-12 of the largest entry (1e-9 where a system is solved), and sides that differ are "
    "not timed. Cells hold minimum and median over the repeats, in nanoseconds a state; ratios are of medians, theirs "
    "to ours.",
    "Ours is generated C, one state after the other through the public header, in the fastest of its builds by gcc "
    "and clang (Options(tune=True)), and (batch) several at a time by vectors, likewise, in calls of 64 states, or of "
    "as many as keep their results within 384 KiB, by rows, by columns, and by columns of floats (checked to 5e-4, "
    "2^29 times as coarse); results replace each other as those of the engines do, and copies of the library compute "
    "them in turn, because where its code happens to lie matters; so with CasADi's and SymPy's. Pinocchio is its own "
    "headers, compiled in the run by gcc and by clang, in the faster of its two conventions; MuJoCo is its wheel's "
    "own library; CasADi is the C that it makes of composite-rigid-body, Newton-Euler and articulated-body "
    "recursions, in the best of four builds, gcc and clang with -O3 and -O3 -ffast-math; SymPy is Kane's equations "
    "and common subexpressions, built alike. Friction and springs in joints are taken out. Machines are noisy: quote "
    "a ratio rather than a time.",
)


def write_report(record: Record, folder: Path) -> Path:
    """Write the three files.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / "timing.json", json.dumps(as_data(record), indent=1) + "\n")
    shown = [*sections(record), *([flexible_section(record.flexible)] if record.flexible else [])]
    for suffix in ("md", "html"):
        text = render(
            f"timing.{suffix}.j2",
            {"svg": _svg, "facts": _facts},
            headline=headline(record),
            limits=LIMITS,
            sections=shown,
            facts=record.machine,
        )
        write_atomically(folder / f"timing.{suffix}", text)
    return folder / "timing.html"


def _svg(chart: Chart) -> Markup:
    return Markup(svg(chart))


def _facts(machine: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What times depend on, in words."""
    listed = []
    for name, value in machine.items():
        if isinstance(value, Mapping):
            listed += [(f"{name}: {part}", str(what)) for part, what in value.items()]
        elif name in ("scalar_flops", "vector_flops", "copied_bytes"):
            unit = "GB/s copied in the first cache" if name == "copied_bytes" else f"GFlop/s, {name.partition('_')[0]}"
            listed.append(("measured limit of a core", f"{value / 1e9:.1f} {unit}"))
        elif isinstance(value, list):
            listed.append((name, "; ".join(f"{x:.1f}" if isinstance(x, float) else str(x) for x in value)))
        else:
            listed.append((name, f"{value:g}" if isinstance(value, float) else str(value)))
    return listed
