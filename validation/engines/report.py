"""Which engine is wrong where, and the scripts that prove it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from validation.engines.study import RED, measure
from validation.reporting.numbers import counted
from validation.reporting.record import (
    Bullets,
    Cell,
    Code,
    Column,
    Data,
    Fact,
    Fold,
    Report,
    Section,
    Table,
    Text,
    Topic,
)

_TEXT = (
    "Each engine builds the same small trees by its own API and answers in its own conventions: coordinates, speeds, "
    "frames. What is right is worked out in 130 digits from nothing but what the engine's coordinates and speeds mean"
    " (`validation/engines/truth/charts.py`), by Newton's and Euler's equations and differences. An answer may be off"
    " by what 2000 roundings of its inputs and of the forces between links make of it. **wrong**: off by more, and by"
    " more than a millionth of the largest entry. **imprecise**: off by more, but less than that. **refuses**: says "
    "in words that it can't. **crashes**: takes its process with it. Empty: not offered. Each red cell stands for a "
    "script that imports the engine alone, was shrunk to the plainest tree and state that still show it, and was run "
    "in a process of its own to fail."
)
_DECISION = (
    "**Which engine is wrong, against the truth in many digits:** {}; {} more lose digits beyond what rounding "
    "explains. {} prove it. Where: [the matrix](engines.html#overview)."
)
_OVERVIEW = """engine = [{name}](#engine-{name}); version; #right; #wrong ? no wrong; #imprecise; #crashes; #refuses;
    #faults proven = {proofs}"""
Row = Mapping[str, Any]


def compose(data: Data) -> Report:
    """The report of its JSON."""
    cells, proofs, identities = data["cells"], data["proofs"], data["identities"]
    tally = Counter(cell["verdict"] for cell in cells)
    red = sum(tally[verdict] for verdict in RED)
    wrong = Counter(cell["engine"] for cell in cells if cell["verdict"] in ("wrong", "crashes"))
    listed = ", ".join(f"{engine} in {counted(number, 'cell')}" for engine, number in wrong.most_common()) or "none"
    scripts = counted(sum(proof["proven"] for proof in proofs), "script")
    all_proven, held = all(proof["proven"] for proof in proofs), sum(row["ok"] for row in identities)
    overview = Table.of((_tally(engine, data) for engine in data["engines"]), _OVERVIEW)
    absent = "; ".join(f"{name}: {why}" for name, why in data["absent"].items())
    conventions = ((engine["name"], *row) for engine in data["engines"] for row in engine["conventions"])
    return Report(
        "Which engine is wrong where",
        f"{counted(len(data['engines']), 'engine')}, {counted(len(data['models']), 'tree')}, "
        f"{counted(len(data['functions']), 'function')}: {tally['right']} cells right, {red} red, "
        f"by {counted(len(proofs), 'script')} that fail as they must.",
        all_proven,
        (_TEXT,),
        (
            Section(
                "Engines", (overview, *([Text(f"Not installed here: {absent}.", "soft")] if absent else ())), "overview"
            ),
            *(_matrix(engine, data) for engine in data["engines"]),
            Section("Identities of engines with themselves", (_identities(data),), "identities"),
            Section(
                "Conventions",
                (Table.of(conventions, "engine = {0}; what = {1}; convention = {2}"),),
                "conventions",
                page_only=True,
            ),
            Section("Proofs", tuple(map(_proof, proofs)), "proofs", all_proven, page_only=True),
        ),
        facts=(
            Fact(str(tally["right"]), "cells right"),
            Fact(str(red), "red cells: wrong, imprecise, crashing"),
            Fact(str(len(proofs)), "scripts that prove them", all_proven),
            Fact(str(tally["refuses"]), "cells where the engine refuses in words"),
            Fact(f"{held} of {len(identities)}", "identities that hold"),
        ),
        digest=(overview,),
        decisions=(_DECISION.format(listed, counted(tally["imprecise"], "cell"), scripts),),
    )


def _tally(engine: Row, data: Data) -> Row:
    """A line of the overview."""
    verdicts = Counter(cell["verdict"] for cell in data["cells"] if cell["engine"] == engine["name"])
    proofs = sum(proof["engine"] == engine["name"] for proof in data["proofs"])
    counts = {name: verdicts[name] for name in ("right", "wrong", "imprecise", "crashes", "refuses")}
    return {**engine, **counts, "proofs": proofs if any(verdicts[name] for name in RED) else ""}


def _matrix(engine: Row, data: Data) -> Section:
    """Functions by trees, those that the engine has; red cells lead to their proofs."""
    name = engine["name"]
    own = {(cell["function"], cell["model"]): cell for cell in data["cells"] if cell["engine"] == name}
    anchors = {
        (proof["function"], model): proof["file"].removesuffix(".py")
        for proof in data["proofs"]
        for model in proof["models"]
        if proof["engine"] == name
    }

    def verdict(model: str) -> Column:
        def cell(function: str) -> str | Cell:
            one, anchor = own.get((function, model)), anchors.get((function, model))
            if one is None:
                return ""
            sign = one["verdict"].replace("right", "ok")
            hint = one["words"] or f"error {one['error']:.1e}, tolerance {one['tolerance']:.1e}"
            return Cell(f"[{sign}](#{anchor})" if anchor else sign, False if one["verdict"] in RED else None, hint=hint)

        return cell

    columns: dict[str, Column] = {
        "function": lambda function: Cell(f"`{function}`", hint=data["functions"][function]),
        "its name": lambda function: engine["functions"][function],
        **{model: verdict(model) for model in data["models"] if any(model == known for _, known in own)},
    }
    table = Table.of((function for function in data["functions"] if function in engine["functions"]), columns)
    return Section(f"{name} {engine['version']}", (table,), f"engine-{name}", page_only=True)


def _identities(data: Data) -> Table:
    def held(engine: str) -> Column:
        def cell(identity: str) -> Cell:
            own = [row for row in data["identities"] if (row["identity"], row["engine"]) == (identity, engine)]
            broken = [row["model"] for row in own if not row["ok"]]
            text = f"{len(own) - len(broken)} of {len(own)}" if own else ""
            return Cell(text, False if broken else None, hint=", ".join(broken))

        return cell

    columns: dict[str, Column] = {engine["name"]: held(engine["name"]) for engine in data["engines"]}
    return Table.of(
        dict.fromkeys(row["identity"] for row in data["identities"]),
        {"identity: trees on which it holds": str, **columns},
    )


def _proof(proof: Row) -> Fold:
    """A red cell: where it is red, who knows it, the script, what it prints."""
    facts = (
        f"`{proof['function']}` is {proof['verdict']}: error {proof['error']:.1e} of the largest entry, "
        f"tolerance {proof['tolerance']:.1e}.",
        f"The same functions are red on: {', '.join(proof['models'])}.",
        f"Public thread: {proof['thread']}.",
        f"Script: `reports/engines/{proof['file']}`.",
    )
    title = f"{proof['engine']}: {proof['native']}, {proof['model']}"
    blocks = (Bullets(facts), Code(proof["text"]), Code(proof["output"]))
    return Fold(title, blocks, page_only=True, anchor=proof["file"].removesuffix(".py"))


TOPIC = Topic("engines", "Correctness", "Which engine is wrong where?", compose, measure)
