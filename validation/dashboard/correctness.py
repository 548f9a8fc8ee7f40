"""What the dashboard shows of the reports on correctness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from validation.adapters import ROUTES
from validation.contract.quantities import ROUNDING, SOLVE
from validation.dashboard.card import Card, Fact, counted
from validation.evidence.findings import Chart, Curve
from validation.reporting.page import short

Data = Mapping[str, Any]

# An error of exactly zero has no logarithm; it is shown a decade below the rounding of a double.
_EXACT = 1e-17


def check(data: Data) -> Card:
    """The cross-check."""
    judged = [row for row in data["comparisons"] if row["tolerance"]]
    wrong = [row for row in data["comparisons"] if not row["ok"]]
    engines = {row["engine"] for row in judged} & {name for name, route in ROUTES.items() if route.independent}
    verdict = "all agree" if not wrong else f"{len(wrong)} do not agree"
    facts = [
        Fact(str(len(data["models"])), f"models, {data['settings']['states']} states each"),
        Fact(str(len(engines)), f"independent opinions: {', '.join(sorted(engines))}"),
    ]
    for label, tolerance in (("rounding alone stands between", ROUNDING), ("a system is solved", SOLVE)):
        rows = [row for row in judged if row["tolerance"] == tolerance and row["error"] is not None]
        if rows:
            worst = max(rows, key=lambda row: row["error"])
            place = f"{worst['quantity']} of {worst['model']}, {worst['engine']}"
            facts.append(
                Fact(f"{worst['error']:.1e}", f"largest error where {label}, of {tolerance:.0e}: {place}", worst["ok"])
            )
    unfinished = f"; {counted(len(data['unfinished']), 'model')} not reached" if data.get("unfinished") else ""
    asked = f"{counted(len(data['comparisons']), 'comparison')} of {counted(len(data['models']), 'model')}"
    chart = _errors(judged, sorted(engines))
    return Card(f"{asked}: {verdict}{unfinished}.", bool(data["ok"]), tuple(facts), (chart,))


def _errors(rows: Sequence[Data], engines: Sequence[str]) -> Chart:
    """How many comparisons err by no more than how much, an engine a curve."""
    curves = []
    for k, engine in enumerate(engines):
        errors = np.sort(
            [max(row["error"], _EXACT) for row in rows if row["engine"] == engine and row["error"] is not None]
        )
        curves.append(Curve(engine, errors, np.arange(1, len(errors) + 1) / max(len(errors), 1), k))
    return Chart(
        "how close independent engines are",
        "largest relative error of a comparison  [1]",
        "share of the comparisons  [1]",
        tuple(curves),
        log_x=True,
        range_y=(0.0, 1.0),
    )


def mutation(data: Data) -> Card:
    """Planted faults."""
    survived = sum(len(row["survived"]) for row in data["models"])
    silent, small = (sum(row[name] for row in data["models"]) for name in ("silent", "too_small"))
    matter = data["planted"] - silent - small
    return Card(
        f"{matter - survived} of {matter} faults that matter are caught, in {counted(len(data['models']), 'model')}.",
        bool(data["ok"]),
        (
            Fact(str(data["planted"]), "single faults planted"),
            Fact(str(survived), "survived; none may", not survived),
            Fact(str(silent + small), "change nothing, or less than a tolerance"),
        ),
    )


def oracle(data: Data) -> Card:
    """SymPy's derivations."""
    rows = data["comparisons"]
    least = min((digits for row in rows for digits in row["digits"].values()), default=0.0)
    models = {row["model"] for row in rows}
    verdict = "all agree" if data["ok"] else "not all agree"
    asked = min(row["required"] for row in rows)
    digits = Fact(f"{least:.0f}", f"digits agree at the least; {asked:.0f} and more are asked for", bool(data["ok"]))
    said = f"{counted(len(rows), 'derivation')} by SymPy of {counted(len(models), 'model')}: {verdict}."
    return Card(said, bool(data["ok"]), (digits,))


def fuzz(data: Data) -> Card:
    """Hostile input."""
    faults = len(data["faults"])
    slowest = max(row["slowest"] for row in data["kinds"].values())
    facts = (Fact(f"{slowest:.1f} s", "the slowest"), Fact(f"{data['peak_memory_mib']} MiB", "peak memory"))
    said = f"{counted(data['inputs'], 'hostile input')}: {faults} crashed or hung a reader."
    return Card(said, bool(data["ok"]), facts)


def campaign(data: Data) -> Card:
    """The latest long campaign that was reported."""
    spent = data["effort"]
    rate = f"{data['states'] / spent['seconds']:.0f}/s" if spent["seconds"] else ""
    wrong = sum(not row["agree"] for row in data["groups"])
    verdict = "all agree" if not wrong and data["ok"] else f"{wrong} do not agree"
    return Card(
        f"{counted(data['states'], 'state')} of {counted(data['models'], 'model')}, "
        f"{counted(len(data['groups']), 'comparison')}: {verdict}.",
        bool(data["ok"]),
        (
            Fact(rate, f"states, {counted(spent['sessions'], 'session')}"),
            Fact(str(len(spent["repeated"])), f"of {counted(spent['executions'], 'execution')} of batches repeated"),
            Fact(_worst(data["groups"]), "of its tolerance, the largest error", not wrong),
        ),
    )


def _worst(groups: Sequence[Data]) -> str:
    share = max(
        (row["error"] / row["tolerance"] for row in groups if row["error"] is not None and row["tolerance"]), default=0
    )
    return f"{short(float(f'{100 * share:.2g}'))} %"
