"""`python -m validation engines`: which engine is wrong where, and a script that proves it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Annotated, Any

import typer

from validation.engines.functions import FUNCTIONS
from validation.engines.identities import held
from validation.engines.interface import EnginePlugin, Tree
from validation.engines.matrix import names
from validation.engines.models import hostile, kinds
from validation.engines.models.readers import readings
from validation.engines.proving.shrink import TRIES
from validation.engines.study import RED, gathered, proofs, read
from validation.engines.workers import Worker, registry
from validation.reporting.command import Run, known
from validation.reporting.numbers import counted
from validation.reporting.record import Bullets, Cell, Code, Data, Fact, Fold, Report, Section, Table, Text, Topic

_TEXT = (
    "Each engine builds the same small trees by its own API and answers in its own conventions: coordinates, speeds, "
    "frames. What is right is worked out in 130 digits from nothing but what the engine's coordinates and speeds mean "
    "(`validation/engines/charts.py`), by Newton's and Euler's equations and differences. An answer may be off by what "
    "2000 roundings of its inputs make of it. **wrong**: off by more, and by more than a millionth of the largest "
    "entry. **imprecise**: off by more, but less than that. **refuses**: says in words that it can't. **crashes**: "
    "takes its process with it. Empty: not offered. Each red cell stands for a script that imports the engine alone, "
    "was shrunk to the plainest tree and state that still show it, and was run in a process of its own to fail."
)
_SIGNS = {"right": "ok", "wrong": "wrong", "imprecise": "imprecise", "refuses": "refuses", "crashes": "crashes"}
Row = Mapping[str, Any]


def trees() -> dict[str, Tree]:
    """All trees: one for each kind of joint, and the hostile set."""
    return {name: kinds.tree_of(name) for name in kinds.KINDS} | hostile.trees()


def measure(
    run: Run,
    engines: Annotated[list[str] | None, typer.Option("--engine", help="Only this engine.")] = None,
    models: Annotated[list[str] | None, typer.Option("--kinds", help="Only this kind of joint, or tree.")] = None,
    prove: Annotated[bool, typer.Option(help="Shrink red cells, write their scripts and run them.")] = True,
    tries: Annotated[int, typer.Option(min=0, help="Cases tried to shrink each fault.")] = TRIES,
) -> Data:
    """Hold engines against thirty digits of truth: every kind of joint, every function that they offer."""
    plugins = registry().plugins
    present = {name: plugin for name, plugin in plugins.items() if plugin.version()}
    chosen = {name: present[name] for name in known(engines, present, "--engine", "engine present")}
    all_trees, files = trees(), readings()
    names_wanted = known(models, [*all_trees, *files], "--kinds", "kind")
    wanted = [all_trees[name] for name in names_wanted if name in all_trees]
    run.expect(len(names_wanted), "asking engines")
    with Worker() as worker:
        cells = gathered(chosen, wanted, worker, run.advance)
        cells += read(chosen, {name: files[name] for name in names_wanted if name in files}, worker, run.advance)
        proven = (
            proofs(chosen, cells, worker, run.folder / "engines", lambda one: run.advance(one.file), tries)
            if prove
            else []
        )
    return {
        "engines": [_engine(plugin) for plugin in chosen.values()],
        "absent": {name: plugin.extra for name, plugin in plugins.items() if name not in present} | registry().failures,
        "models": names_wanted,
        "functions": {name: FUNCTIONS[name.partition(":")[0]].text for name in names(chosen)},
        # What an engine does not offer is what is left: a third of all.
        "cells": [asdict(one.cell) for one in cells if one.cell.verdict != "not offered"],
        "identities": [asdict(one) for one in held(cells)],
        "proofs": [asdict(proof) | {"models": models} for proof, models in proven],
    }


def _engine(plugin: EnginePlugin) -> Data:
    return {
        "name": plugin.name,
        "version": plugin.version(),
        "conventions": [list(row) for row in plugin.conventions],
        "functions": dict(plugin.functions),
    }


def compose(data: Data) -> Report:
    """The report of its JSON."""
    cells: list[Row] = data["cells"]
    tally = Counter(cell["verdict"] for cell in cells)
    red = sum(tally[verdict] for verdict in RED)
    anchors = {
        (proof["engine"], model, proof["function"]): _anchor(proof)
        for proof in data["proofs"]
        for model in proof["models"]
    }
    unproven = [proof["file"] for proof in data["proofs"] if not proof["proven"]]
    broken = [row for row in data["identities"] if not row["ok"]]
    by_engine = [_matrix(engine, data, anchors) for engine in data["engines"]]
    return Report(
        "Which engine is wrong where",
        f"{counted(len(data['engines']), 'engine')}, {counted(len(data['models']), 'tree')}, "
        f"{counted(len(data['functions']), 'function')}: {tally['right']} cells right, {red} red, "
        f"by {counted(len(data['proofs']), 'script')} that fail as they must.",
        not unproven,
        (_TEXT,),
        (
            Section("Engines", (_overview(data), *_absent(data)), "overview"),
            *by_engine,
            Section("Identities of engines with themselves", (_identities(data),), "identities"),
            Section("Conventions", (_conventions(data),), "conventions", page_only=True),
            Section("Proofs", tuple(map(_proof, data["proofs"])), "proofs", not unproven, page_only=True),
        ),
        facts=(
            Fact(str(tally["right"]), "cells right"),
            Fact(str(red), "red cells: wrong, imprecise, crashing"),
            Fact(str(len(data["proofs"])), "scripts that prove them", not unproven),
            Fact(str(tally["refuses"]), "cells where the engine refuses in words"),
            Fact(f"{len(data['identities']) - len(broken)} of {len(data['identities'])}", "identities that hold"),
        ),
        digest=(_overview(data),),
        decisions=(_decision(cells, sum(proof["proven"] for proof in data["proofs"])),),
    )


def _decision(cells: list[Row], proven: int) -> str:
    wrong = Counter(cell["engine"] for cell in cells if cell["verdict"] in ("wrong", "crashes"))
    said = ", ".join(f"{engine} in {counted(number, 'cell')}" for engine, number in wrong.most_common()) or "none"
    imprecise = sum(cell["verdict"] == "imprecise" for cell in cells)
    return (
        f"**Which engine is wrong, against the truth in many digits:** {said}; {counted(imprecise, 'cell')} more lose "
        f"digits beyond what rounding explains. {counted(proven, 'script')} prove it. "
        "Where: [the matrix](engines.html#overview)."
    )


def _overview(data: Data) -> Table:
    lines = []
    for engine in data["engines"]:
        tally = Counter(cell["verdict"] for cell in data["cells"] if cell["engine"] == engine["name"])
        proofs_of = sum(proof["engine"] == engine["name"] for proof in data["proofs"])
        red = sum(tally[verdict] for verdict in RED)
        lines.append(
            (
                f"[{engine['name']}](#engine-{engine['name']})",
                engine["version"],
                str(tally["right"]),
                Cell(str(tally["wrong"]), None if not tally["wrong"] else False),
                str(tally["imprecise"]),
                str(tally["crashes"]),
                str(tally["refuses"]),
                str(proofs_of) if red else "",
            )
        )
    head = ("engine", "version", "#right", "#wrong", "#imprecise", "#crashes", "#refuses", "#faults proven")
    return Table(head, tuple(lines))


def _absent(data: Data) -> Sequence[Text]:
    if not data["absent"]:
        return ()
    listed = "; ".join(f"{name}: {why}" for name, why in data["absent"].items())
    return (Text(f"Not installed here: {listed}.", "soft"),)


def _matrix(engine: Row, data: Data, anchors: Mapping[tuple[str, str, str], str]) -> Section:
    """Functions by trees, those that the engine has."""
    name = engine["name"]
    own = {(cell["function"], cell["model"]): cell for cell in data["cells"] if cell["engine"] == name}
    models = [model for model in data["models"] if any(model == known for _, known in own)]
    lines = []
    for function in data["functions"]:
        if function in engine["functions"]:
            row: list[str | Cell] = [
                Cell(f"`{function}`", hint=data["functions"][function]),
                engine["functions"][function],
            ]
            lines.append((*row, *(_cell(own.get((function, model)), anchors) for model in models)))
    return Section(
        f"{name} {engine['version']}",
        (Table(("function", "its name", *models), tuple(lines)),),
        f"engine-{name}",
        page_only=True,
    )


def _cell(cell: Row | None, anchors: Mapping[tuple[str, str, str], str]) -> str | Cell:
    if cell is None:
        return ""
    sign = _SIGNS[cell["verdict"]]
    anchor = anchors.get((cell["engine"], cell["model"], cell["function"]))
    hint = cell["words"] or f"error {cell['error']:.1e}, tolerance {cell['tolerance']:.1e}"
    return Cell(f"[{sign}](#{anchor})" if anchor else sign, False if cell["verdict"] in RED else None, hint=hint)


def _identities(data: Data) -> Table:
    rows: list[Row] = data["identities"]
    columns = [engine["name"] for engine in data["engines"]]
    lines = []
    for identity in dict.fromkeys(row["identity"] for row in rows):
        line: list[str | Cell] = [identity]
        for engine in columns:
            own = [row for row in rows if row["identity"] == identity and row["engine"] == engine]
            broken = [row["model"] for row in own if not row["ok"]]
            text = f"{len(own) - len(broken)} of {len(own)}" if own else ""
            line.append(Cell(text, False if broken else None, hint=", ".join(broken)))
        lines.append(tuple(line))
    return Table(("identity: trees on which it holds", *columns), tuple(lines))


def _conventions(data: Data) -> Table:
    rows = [(engine["name"], *row) for engine in data["engines"] for row in engine["conventions"]]
    return Table(("engine", "what", "convention"), tuple(rows))


def _anchor(proof: Row) -> str:
    return str(proof["file"]).removesuffix(".py")


def _proof(proof: Row) -> Fold:
    """A red cell: where it is red, who knows it, the script, what it prints."""
    return Fold(
        f"{proof['engine']}: {proof['native']}, {proof['model']}",
        (
            Bullets(
                (
                    f"`{proof['function']}` is {proof['verdict']}: error {proof['error']:.1e} of the largest entry, "
                    f"tolerance {proof['tolerance']:.1e}.",
                    f"The same functions are red on: {', '.join(proof['models'])}.",
                    f"Public thread: {proof['thread']}.",
                    f"Script: `reports/engines/{proof['file']}`.",
                )
            ),
            Code(proof["text"]),
            Code(proof["output"]),
        ),
        page_only=True,
        anchor=_anchor(proof),
    )


TOPIC = Topic("engines", "Correctness", "Which engine is wrong where?", compose, measure)
