"""What the dashboard shows of the reports on speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from validation.dashboard.card import Card, Fact, counted, times
from validation.evidence.findings import Chart, Curve, Mark

Data = Mapping[str, Any]

# What a simulation asks for at each step, under the names that layouts of the report have had.
_TELLING = ("dynamics", "forward_dynamics", "mass_matrix")


def timing(data: Data) -> Card:
    """Generated C against engines and other generators: how many times their time is ours."""
    rows = data["entries"] if "entries" in data else [{**row, "peer": "pinocchio"} for row in data["timings"]]
    best: dict[tuple[str, str, str], Data] = {}
    for row in rows:  # Each peer in the fastest of its builds.
        key = (row["model"], row["function"], row["peer"])
        if key not in best or row["theirs"][1] < best[key]["theirs"][1]:
            best[key] = row
    peers = list(dict.fromkeys(row["peer"] for row in best.values()))
    facts, medians = [], []
    for peer in peers:
        ratios = [row["ratio"] for row in best.values() if row["peer"] == peer]
        middle = times(float(np.median(ratios)))
        medians.append(f"{peer} {middle}")
        span = f"{times(min(ratios))} to {times(max(ratios))}"
        facts.append(Fact(middle, f"{peer}'s time over ours, median of {len(ratios)}; {span}"))
    failed = len(data.get("failed") or data.get("failures") or ())
    functions = {row["function"] for row in best.values()}
    sizes = (len(best), "race"), (len({row["model"] for row in best.values()}), "model"), (len(functions), "function")
    races, models, of_them = (counted(number, noun) for number, noun in sizes)
    rest = f"; {failed} could not be timed" if failed else ""
    said = f"{races} over {models} and {of_them}; median of their time over ours: {', '.join(medians)}{rest}."
    charts = tuple(_growth(list(best.values()), name) for name in _TELLING if name in functions)[:2]
    return Card(said, None if not failed else False, tuple(facts), charts)


def _growth(rows: Sequence[Data], function: str) -> Chart:
    """Their time over ours, over the size of the model."""
    chosen = [row for row in rows if row["function"] == function]
    curves = []
    for k, peer in enumerate(dict.fromkeys(row["peer"] for row in chosen)):
        points = sorted((row["nv"], row["ratio"]) for row in chosen if row["peer"] == peer)
        curves.append(
            Curve(peer, np.array([p[0] for p in points], float), np.array([p[1] for p in points]), k, "joined")
        )
    return Chart(
        f"{function.replace('_', ' ')}: their time over ours",
        "speeds of the model  [1]",
        "ratio  [1]",
        tuple(curves),
        (Mark("as fast as we", 1.0),),
        log_x=True,
        log_y=True,
    )


def simulation(data: Data) -> Card:
    """Motions at equal accuracy."""
    rows = data["races"]
    raced = [row for row in rows if row["theirs"]]
    missed = [row for row in data["iftomm"] if not row["error"] <= row["threshold"]]
    facts = [Fact(times(row["ratio"]), f"{row['engine']}'s time over ours: {row['scene']}") for row in raced]
    if data["iftomm"]:
        facts.append(
            Fact(str(len(data["iftomm"])), f"IFToMM benchmarks, {len(missed)} beyond their thresholds", not missed)
        )
    fastest = max(row["real_time"] for row in rows)
    return Card(
        f"Motions run up to {fastest:.0f} times real time; {counted(len(raced), 'race')} at equal accuracy.",
        not missed if data["iftomm"] else None,
        tuple(facts),
    )


def rollouts(data: Data) -> Card:
    """Thousands of motions at once."""
    rows = [row for row in data["rollouts"] if "MuJoCo" not in row["who"]]
    fastest = min(rows, key=lambda row: row["nanoseconds"][0])
    best = max(rows, key=lambda row: row["ratio"])
    rate, motions = 1e3 / fastest["nanoseconds"][0], counted(data["trajectories"], "motion")
    return Card(
        f"{motions} of a 7-joint arm at once: {rate:.2g} million steps a second and core.",
        None,
        (
            Fact(f"{fastest['nanoseconds'][0]:.0f} ns", f"a step: {fastest['scene']}, {fastest['how']}"),
            Fact(times(best["ratio"]), f"mujoco.rollout's time over ours: {best['scene']}, {best['how']}"),
        ),
    )


def realtime(data: Data) -> Card:
    """How late instants begin."""
    rows = data["scenes"]
    best = [row for row in rows if row["first"]] or rows
    facts = [
        Fact(f"{1e6 * row['median']:.0f} µs", f"median: {row['what']}; {row['missed']} of {row['instants']} missed")
        for row in best
    ]
    least, most = (pick(1e6 * row["median"] for row in best) for pick in (min, max))
    beside = f"at load {data['load']:.1f} on {data['cores']} cores"
    return Card(
        f"Instants of diagrams begin {least:.0f} to {most:.0f} µs late (medians), {beside}.", None, tuple(facts)
    )


def exports(data: Data) -> Card:
    """What a call costs where."""
    facts = [
        Fact(f"{row['step of 1 ms'] / 1e3:.2g} µs", f"a step of 1 ms from {where}")
        for where, row in data["overheads"].items()
        if row.get("step of 1 ms") is not None
    ]
    worst = max(row["high"] for row in data["latencies"])
    facts.append(Fact(f"{worst / 1e3:.2g} µs", f"99.9 % of {data['calls']:,} calls in C are below".replace(",", " ")))
    return Card(f"{data['model']}: the cost of calls from {', '.join(data['overheads'])}.", None, tuple(facts))
