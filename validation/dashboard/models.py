"""What the dashboard shows of the reports on accuracy, stability and their price."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from validation.dashboard.card import Card, Fact, bounded, chart_of, counted, times
from validation.evidence.findings import Chart, Curve
from validation.passes.measure import ALL

Data = Mapping[str, Any]

# Study -> which of its charts; those that answer the questions asked most.
_TELLING = {"spinning": (0, 0), "convergence": (0, 0), "square": (0, 0), "two_arms": (0, 1)}
# Of the methods in the scene of energies.
_METHODS = ("semi_implicit_euler", "rk4", "dop853", "variational")


def accuracy(data: Data) -> Card:
    """A report of questions: on beams, on diagrams."""
    studies = data["studies"]
    checks = [check for study in studies.values() for check in study["checks"]]
    verdict, _ = bounded(checks)
    missed = [study["title"] for study in studies.values() if not study["ok"]]
    figures = (
        (studies[name]["figures"][figure], chart) for name, (figure, chart) in _TELLING.items() if name in studies
    )
    charts = tuple(chart_of(figure["charts"][chart]) for figure, chart in figures)
    facts = [
        Fact(str(len(studies)), "questions answered"),
        Fact(str(len(checks)), f"numbers, {verdict}", bool(data["ok"])),
    ]
    facts += [Fact("missed", title, False) for title in missed]
    said = f"{counted(len(checks), 'number')} on {counted(len(studies), 'question')}: {verdict}{_short_way(data)}."
    return Card(said, bool(data["ok"]), tuple(facts), charts)


def stability(data: Data) -> Card:
    """Where simulations fail."""
    scenes = data["scenes"]
    checks = [check for scene in scenes.values() for check in scene["checks"]]
    verdict, _ = bounded(checks)
    runs = sum(len(row) for scene in scenes.values() for found in scene["maps"].values() for row in found["values"])
    facts = (
        Fact(str(len(scenes)), "scenes"),
        Fact(str(runs), "runs"),
        Fact(str(len(checks)), f"claims, {verdict}", bool(data["ok"])),
    )
    charts = tuple(_energies(scenes["energy"])) if "energy" in scenes else ()
    return Card(
        f"{counted(len(checks), 'claim')} about {counted(len(scenes), 'scene')}: {verdict}{_short_way(data)}.",
        bool(data["ok"]),
        facts,
        charts,
    )


def _energies(scene: Data) -> Iterator[Chart]:
    """Who keeps energy, over the longest runs."""
    title, found = list(scene["maps"].items())[-1]
    rows = [(name, values) for name, values in zip(found["y"], found["values"], strict=True) if name in _METHODS]
    curves = [
        Curve(
            name,
            np.array(found["x"], float),
            np.array([np.nan if x is None else x for x in values], float),
            k,
            "joined",
        )
        for k, (name, values) in enumerate(rows)
    ]
    if curves:
        yield Chart(
            f"a pendulum's energy, {title}", scene["x"], scene["quantity"], tuple(curves), log_x=True, log_y=True
        )


def passes(data: Data) -> Card:
    """What each pass of the generator gains."""
    rows = data["rows"]
    base = {row["model"]: row["median"] for row in rows if row["without"] == ALL}
    gains = [(row["median"] / base[row["model"]], row) for row in rows]
    gain, most = max(gains, key=lambda pair: pair[0])
    return Card(
        f"Passes measured one by one on {counted(len(base), 'model')}.",
        None,
        (Fact(times(gain), f"the time of {most['model']} without {most['without']}"),),
    )


def pareto(data: Data) -> Card:
    """Accuracy against price."""
    scenes = list(data["scenes"].values())
    targets = [target for scene in scenes for target in scene["targets"]]
    met = sum(target["ok"] for target in targets)
    runs = sum(len(scene["points"]) for scene in scenes)
    most = max((target["found"] or 0.0 for target in targets), default=0.0)
    facts = (
        Fact(str(len(scenes)), "scenes"),
        Fact(str(runs), "runs"),
        Fact(times(most), "an engine's best time over ours, at equal error, where it is most"),
    )
    said = f"{met} of {counted(len(targets), 'target')} met, in {counted(len(scenes), 'scene')}{_short_way(data)}."
    return Card(said, bool(data["ok"]), facts, tuple(map(_prices, scenes[:1])))


def _prices(scene: Data) -> Chart:
    """Every run of a scene, by whose it is."""
    found: dict[str, list[tuple[float, float]]] = {}
    for point in scene["points"]:
        if point["error"] is not None:
            found.setdefault(point["who"], []).append((point["seconds"], point["error"]))
    curves = [
        Curve(who, np.array([x for x, _ in runs]), np.array([y for _, y in runs]), k, "points")
        for k, (who, runs) in enumerate(found.items())
    ]
    return Chart(scene["title"], "time of the processor [s]", "error [1]", tuple(curves), log_x=True, log_y=True)


def _short_way(data: Data) -> str:
    return " (quick variant)" if data.get("quick") else ""
