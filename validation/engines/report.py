"""Which engine is wrong where, and the scripts that prove it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from ..reporting.numbers import counted
from ..reporting.record import Bullets, Cell, Code, Data, Fact, Report, Section, Table, Text, Topic, verdict
from . import parts
from .proving.scripts import NO_SCRIPT
from .study import measure
from .verdicts import RED

_TEXT = """Each engine builds the same small trees by its own API and answers in its own conventions: coordinates,
speeds, frames. What is right is worked out in 130 digits from nothing but what the engine's coordinates and speeds
mean (`validation/engines/truth/charts.py`), by Newton's and Euler's equations and differences. An answer may be off
by what 2000 roundings of its inputs and of the forces between links make of it. **wrong**: off by more, and by more
than a millionth of the largest entry. **imprecise**: off by more, but less than that. **crashes**: takes its process
with it. **raises**: an exception inside the engine that is no refusal. **refuses**: says in words that it can't.
**precondition**: the engine documents or asserts that it is not for this. **repairs**: it changed what it was given,
with a warning. **plug-in**: the plug-in, not the engine, is in the way: nothing is said of the engine. Empty: not
offered. A proven fault has a script that imports the engine alone, was shrunk to the plainest tree and state that
still show it, and was run in a process of its own to fail; one that does not end proves nothing."""
_DECISION = "**Which engine is wrong:** {}, proven by {}."
_COUNTED = """A cell counts where the answer is wrong against the truth in many digits; {} more lose digits beyond what
rounding explains."""
# Functions that the report begins with, of each engine that is wrong.
_NAMED = 4
Row = Mapping[str, Any]


def compose(data: Data) -> Report:
    """The report of its JSON."""
    data = {
        **data,
        "cells": parts.unnested(data["cells"], parts.CELLS),
        "identities": parts.unnested(data["identities"], parts.IDENTITIES),
    }
    cells, proofs, identities = data["cells"], data["proofs"], data["identities"]
    tally = Counter(cell["verdict"] for cell in cells)
    red = sum(tally[name] for name in RED)
    wrong = Counter(cell["engine"] for cell in cells if cell["verdict"] in ("wrong", "crashes", "raises"))
    listed = ", ".join(f"{engine} in {number}" for engine, number in wrong.most_common())
    listed = f"{listed} cells of [the matrix](engines.html#overview)" if listed else "none"
    proven, held = sum(proof["proven"] for proof in proofs), sum(row["ok"] for row in identities)
    scripts, open_faults = counted(proven, "script"), len(proofs) - proven
    all_proven = all(proof["proven"] or proof["output"] == NO_SCRIPT for proof in proofs)
    # Of plug-ins from elsewhere an exception is an answer; of ours it is a fault of ours.
    raising = Counter(cell["engine"] for cell in cells if cell["verdict"] == "plug-in")
    sound = not raising.keys() & set(data.get("ours", ()))
    said = f", {open_faults} of {len(proofs)} faults not proven" if open_faults else ""
    said += f"; {counted(raising.total(), 'cell')} where a plug-in raises" if raising else ""
    head = (
        "engine | version | right | wrong | imprecise | crashes | raises | refuses | plug-in | faults proven | measured"
    )
    overview = Table.of(head, (_tally(engine, data) for engine in data["engines"]))
    absent = "; ".join(f"{name}: {why}" for name, why in data["absent"].items())
    missing = (Text(f"Not installed here: {absent}.", "soft"),) if absent else ()
    conventions = ((engine["name"], *row) for engine in data["engines"] for row in engine["conventions"])
    stated = Table.of("engine | what | convention", conventions)
    return Report(
        "Which engine is wrong where",
        f"{counted(len(data['engines']), 'engine')}, {counted(len(data['models']), 'tree')}, "
        f"{counted(len(data['functions']), 'function')}: {tally['right']} cells right, {red} red, "
        f"by {scripts} that fail as they must{said}.",
        all_proven and sound,
        (_TEXT,),
        (
            Section("Engines", (overview, *missing), "overview"),
            *(_matrix(engine, data) for engine in data["engines"]),
            Section("Identities of engines with themselves", (_identities(data),), "identities"),
            Section("Conventions", (stated,), "conventions", page_only=True),
            Section("Proofs", tuple(map(_proof, proofs)), "proofs", all_proven, page_only=True),
        ),
        facts=(
            Fact(str(tally["right"]), "cells right"),
            Fact(str(red), "red cells: wrong, imprecise, crashing, raising"),
            Fact(str(proven), f"scripts that prove them, of {len(proofs)} faults", all_proven),
            *((Fact(str(raising.total()), "cells where a plug-in raises", sound),) if raising else ()),
            Fact(str(tally["refuses"]), "cells where the engine refuses in words"),
            Fact(f"{held} of {len(identities)}", "identities that hold"),
        ),
        digest=(overview,),
        decisions=(
            _DECISION.format(listed, scripts),
            Table.of("engine | wrong about | cells | of asked", _wrong_about(data, wrong)),
            Text(_COUNTED.format(counted(tally["imprecise"], "cell")), "soft"),
        ),
    )


def _wrong_about(data: Data, wrong: Counter[str]) -> Iterator[tuple[str, ...]]:
    """What each engine is wrong about or crashes at, the functions of most such cells first."""
    for name, number in wrong.most_common():
        own = [cell for cell in data["cells"] if cell["engine"] == name]
        functions = Counter(cell["function"] for cell in own if cell["verdict"] in ("wrong", "crashes", "raises"))
        *few, rest = *functions.most_common(_NAMED), len(functions) - _NAMED
        said = ", ".join(f"`{function}` ({count})" for function, count in few)
        more = f", and {counted(rest, 'function')} more" if rest > 0 else ""
        yield f"[{name}](engines.html#engine-{name})", said + more, str(number), str(len(own))


def _tally(engine: Row, data: Data) -> tuple[str, ...]:
    """A line of the overview."""
    name, tally = engine["name"], Counter(cell["verdict"] for cell in data["cells"] if cell["engine"] == engine["name"])
    own = [proof["proven"] for proof in data["proofs"] if proof["engine"] == name]
    proofs = (f"{sum(own)} of {len(own)}" if not all(own) else len(own)) if any(tally[red] for red in RED) else ""
    further = *(tally[name] for name in ("imprecise", "crashes", "raises", "refuses", "plug-in")), proofs
    counts = verdict(tally["wrong"], not tally["wrong"]), *further
    measured = {name: data.get(name, "") for name in parts.ORIGIN} | engine.get("measured", {})
    when = f"{measured['date']}, {measured['revision'][:8]}"
    return f"[{name}](#engine-{name})", engine["version"], str(tally["right"]), *map(str, counts), when


def _matrix(engine: Row, data: Data) -> Section:
    """Functions by trees, those that the engine has; red cells lead to their proofs."""
    name, names = engine["name"], engine["functions"]
    own = {(cell["function"], cell["model"]): cell for cell in data["cells"] if cell["engine"] == name}
    proofs = [proof for proof in data["proofs"] if proof["engine"] == name]
    anchors = {(proof["function"], model): _anchor(proof) for proof in proofs for model in proof["models"]}
    models = [model for model in data["models"] if any(model == known for _, known in own)]

    def cell(place: tuple[str, str]) -> str | Cell:
        if place not in own:
            return ""
        one, anchor = own[place], anchors.get(place)
        sign = one["verdict"].replace("right", "ok")
        hint = one["words"] or f"error {one['error']:.1e}, tolerance {one['tolerance']:.1e}"
        return Cell(verdict(f"[{sign}](#{anchor})" if anchor else sign, one["verdict"] not in RED), hint=hint)

    rows = [
        (Cell(f"`{function}`", hint=what), names[function], *(cell((function, model)) for model in models))
        for function, what in data["functions"].items()
        if function in names
    ]
    table = Table(("function", "its name", *models), tuple(rows))
    return Section(f"{name} {engine['version']}", (table,), f"engine-{name}", page_only=True)


def _identities(data: Data) -> Table:
    def held(identity: str, engine: str) -> Cell:
        own = [row for row in data["identities"] if (row["identity"], row["engine"]) == (identity, engine)]
        broken = [row["model"] for row in own if not row["ok"]]
        text = f"{len(own) - len(broken)} of {len(own)}" if own else ""
        return Cell(verdict(text, not broken), hint=", ".join(broken))

    engines = [engine["name"] for engine in data["engines"]]
    identities = dict.fromkeys(row["identity"] for row in data["identities"])
    rows = tuple((identity, *(held(identity, engine) for engine in engines)) for identity in identities)
    return Table(("identity: trees on which it holds", *engines), rows)


def _anchor(proof: Row) -> str:
    return str(proof["file"].removesuffix(".py"))


def _proof(proof: Row) -> Section:
    """A red cell: where it is red, who knows it, the script, what it prints."""
    facts = (
        f"`{proof['function']}` is {proof['verdict']}: error {proof['error']:.1e} of the largest entry, "
        f"tolerance {proof['tolerance']:.1e}.",
        f"The same functions are red on: {', '.join(proof['models'])}.",
        f"Public thread: {proof['thread']}.",
        *((f"Script: `reports/engines/{proof['file']}`.",) if proof["text"] else ()),
    )
    title = f"{proof['engine']}: {proof['native']}, {proof['model']}{'' if proof['proven'] else ': not proven'}"
    shown = tuple(map(Code, filter(None, (proof["text"], proof["output"]))))
    return Section(title, (Bullets(facts), *shown), _anchor(proof), page_only=True)


TOPIC = Topic("engines", "Correctness", "Which engine is wrong where?", compose, measure)
