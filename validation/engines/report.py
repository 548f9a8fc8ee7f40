"""Which engine is wrong where, and the scripts that prove it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

from ..program import PROGRAM
from ..reporting.numbers import counted
from ..reporting.provenance import by_origin
from ..reporting.record import Bullets, Cell, Data, Fact, Report, Section, Table, Text, Topic, verdict
from . import changes, parts
from .causes import shown
from .causes.cause import Cause
from .causes.grouping import Group, causes_of, stale
from .proving.scripts import NO_SCRIPT
from .releases import CRASHES
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
_DECISION = "**Which engine is wrong, and what to mend first:** {} behind {} of {}, proven by {}."
_COUNTED = """Wrong numbers and crashes come before exceptions, these before lost digits; among them what most kinds of
trees show comes first. An engine that offers more functions is asked more."""
_CAUSES = """Red cells are the consequence of causes. A cause is stated by people, with the rule by which a cell is its
consequence, the line of documentation or the derivation that it offends, and the public thread, or the day on which
none was found; cells that no stated cause explains are grouped by functions that are red on the same trees. Where a
cause can be taken out of an answer, the answer is judged again without it: what is still red then has another cause
behind it."""
Row = Mapping[str, Any]


@dataclass(frozen=True)
class _Found:
    """What the cells of a report come to: causes of the red ones, those withdrawn, causes that explain none."""

    groups: list[Group]
    withdrawn: list[str]
    stale: list[Cause]

    @classmethod
    def of(cls, data: Data) -> _Found:
        """Findings of the JSON of a report."""
        cells, corrected = parts.cells(data), parts.cells(data, "corrected")
        groups = causes_of(cells, corrected=corrected)
        return cls(groups, shown.withdrawn(cells), stale(groups, [engine["name"] for engine in data["engines"]]))

    def by(self, engine: str) -> list[Group]:
        """The causes of an engine, the heaviest first."""
        return [group for group in self.groups if group.engine == engine]


def compose(data: Data) -> Report:
    """The report of its JSON."""
    found = _Found.of(data)
    data = {
        **data,
        "cells": parts.unnested(data["cells"], parts.CELLS),
        "identities": parts.unnested(data["identities"], parts.IDENTITIES),
        "asked": parts.unnested(data.get("asked", {}), parts.ASKED),
    }
    proofs = data["proofs"]
    tally = Counter(cell["verdict"] for cell in data["cells"])
    red = sum(tally[name] for name in RED)
    scripts = counted(sum(proof["proven"] for proof in proofs), "script")
    all_proven = all(proof["proven"] or proof["output"] == NO_SCRIPT for proof in proofs)
    # Of plug-ins from elsewhere an exception is an answer; of ours it is a fault of ours.
    raising = Counter(cell["engine"] for cell in data["cells"] if cell["verdict"] == "plug-in")
    sound = not raising.keys() & set(data.get("ours", ()))
    overview = _overview(data, found)
    engines = {group.engine for group in found.groups}
    decision = _DECISION.format(
        counted(len(found.groups), "cause"), counted(red, "red cell"), counted(len(engines), "engine"), scripts
    )
    return Report(
        "Which engine is wrong where",
        f"{counted(len(data['engines']), 'engine')}, {counted(len(data['models']), 'tree')}, "
        f"{counted(len(data['functions']), 'function')}: {tally['right']} answers are right, {red} wrong, imprecise "
        f"or failed, by {counted(len(found.groups), 'cause')}; {scripts} prove them"
        f"{_shortcomings(data, raising)}.",
        all_proven and sound and not data.get("changed"),
        (_CAUSES, *_stale(found), _TEXT),
        (
            *changes.shown(data),
            *(_engine(engine, data, found) for engine in sorted(data["engines"], key=itemgetter("name"))),
            Section("Engines", (overview, *_earlier(data), *_missing(data), *_releases(data)), "overview"),
            Section("Cells withdrawn, and why", (Bullets(tuple(found.withdrawn)),), "withdrawn"),
            Section(
                "Functions", tuple(_functions(engine, data) for engine in data["engines"]), "functions", page_only=True
            ),
            Section("Identities of engines with themselves", (_identities(data),), "identities"),
            Section("Conventions", (_conventions(data),), "conventions", page_only=True),
        ),
        facts=_facts(data, found, all_proven, sound),
        digest=(overview, *(block for section in changes.shown(data) for block in section.blocks)),
        decisions=(
            decision,
            Bullets(tuple(_first(data, found))),
            Text(_COUNTED, "soft"),
        ),
        aims=all_proven,
    )


def _releases(data: Data) -> Iterator[Text]:
    """What is said of releases beside their cells: those that crash, and those that the plug-in is not made for."""
    for engine in data["engines"]:
        name = f"{engine['name']} {engine['version']}"
        if engine.get("gave_up"):
            yield Text(f"{name} crashes: after {CRASHES} crashes nothing more was asked of it.", "bad")
        cells = [one for one in data["cells"] if (one["engine"], one["verdict"]) == (engine["name"], "plug-in")]
        if engine.get("release") and cells:
            said = f"in {counted(len(cells), 'cell')}, first {cells[0]['function']} on {cells[0]['model']}"
            yield Text(f"The plug-in does not fit {name}: {said}: {cells[0]['words']}.", "bad")


def _shortcomings(data: Data, raising: Counter[str]) -> str:
    """What the headline says of faults without proof, and of plug-ins that are in the way."""
    proofs = data["proofs"]
    open_faults = sum(not proof["proven"] for proof in proofs)
    said = f", {open_faults} of {len(proofs)} faults not proven" if open_faults else ""
    return said + (f"; {counted(raising.total(), 'cell')} where a plug-in raises" if raising else "")


def _facts(data: Data, found: _Found, all_proven: bool, sound: bool) -> tuple[Fact, ...]:
    """The key numbers."""
    tally, proofs = Counter(cell["verdict"] for cell in data["cells"]), data["proofs"]
    unexplained = [group for group in found.groups if not group.cause]
    held, raising = sum(row["ok"] for row in data["identities"]), tally["plug-in"]
    return (
        Fact(str(tally["right"]), "cells right"),
        Fact(str(len(found.groups)), f"causes, {len(unexplained)} of them not yet found"),
        Fact(str(sum(tally[name] for name in RED)), "red cells: wrong, imprecise, crashing, raising"),
        Fact(
            str(sum(proof["proven"] for proof in proofs)),
            f"scripts that prove them, of {len(proofs)} faults",
            all_proven,
        ),
        *((Fact(str(raising), "cells where a plug-in raises", sound),) if raising else ()),
        Fact(str(tally["refuses"]), "cells where the engine refuses in words"),
        Fact(f"{held} of {len(data['identities'])}", "identities that hold"),
    )


def _first(data: Data, found: _Found) -> Iterator[str]:
    """Number of causes of each engine that has some, and the heaviest."""
    for name in sorted(engine["name"] for engine in data["engines"]):
        if own := found.by(name):
            heaviest = own[0]
            link, causes = f"[{name}](engines.html#engine-{name})", counted(len(own), "cause")
            since = f" Releases: {heaviest.cause.releases}." if heaviest.cause else ""
            said = f"{shown.what(heaviest)} Shows in: {shown.where(heaviest)}.{since} Thread: {shown.thread(heaviest)}"
            yield f"**{link}**, {causes}{', first' if len(own) > 1 else ''}: {said}."


def _stale(found: _Found) -> tuple[Text, ...]:
    """Causes that are stated and explain nothing any more: mended, or not asked about in this run."""
    named = "; ".join(f"{cause.engine}, {cause.name}" for cause in found.stale)
    return (Text(f"Stated, but of no cell of this run: {named}.", "soft"),) if named else ()


def _engine(engine: Row, data: Data, found: _Found) -> Section:
    """What an engine's maintainer is to mend, the heaviest first; nothing of an engine without causes."""
    name, own = engine["name"], found.by(engine["name"])
    folds = tuple(shown.fold(group, k + 1, found.groups, data["proofs"]) for k, group in enumerate(own))
    return Section(f"{name} {engine['version']}: {counted(len(own), 'cause')}", folds, f"engine-{name}")


def _functions(engine: Row, data: Data) -> Section:
    """Numbers of trees on which each function of an engine is right, red, or something else."""
    names = engine["functions"]
    cells: dict[str, list[Row]] = {function: [] for function in data["functions"] if function in names}
    for cell in data["cells"]:
        if cell["engine"] == engine["name"]:
            cells.setdefault(cell["function"], []).append(cell)
    rows = (
        (Cell(f"`{function}`", hint=data["functions"].get(function, "")), names.get(function, ""), *_fared(own))
        for function, own in cells.items()
    )
    title = f"{engine['name']}: {counted(len(names), 'function')}"
    table = Table.of("function | its name | right | red | otherwise", rows)
    said = (f"{engine['refusals']}.".capitalize(),) if "refusals" in engine else ()
    return Section(title, (*said, table), f"functions-{engine['name']}", page_only=True)


def _fared(cells: list[Row]) -> Iterator[str | Cell]:
    """How many cells are right, red, and otherwise."""
    tally = Counter(cell["verdict"] for cell in cells)
    red = [cell["model"] for cell in cells if cell["verdict"] in RED]
    others = {verdict: number for verdict, number in tally.items() if verdict not in ("right", *RED)}
    yield str(tally["right"])
    yield Cell(verdict(str(len(red)) if red else "", not red), hint=", ".join(red))
    yield ", ".join(f"{number} {name}" for name, number in others.items())


def _overview(data: Data, found: _Found) -> Table:
    """A line for each engine; columns in which nothing is stated are left out."""
    head = (
        "engine | version | causes | right | wrong | imprecise | crashes | raises | refuses | precondition | repairs"
        " | plug-in | faults proven | measured"
    )
    return Table.of(head, (_tally(engine, data, found) for engine in data["engines"])).without_empty()


def _missing(data: Data) -> tuple[Text, ...]:
    """Engines that are not installed, and those that refuse so much that what is left shows little."""
    absent = "; ".join(f"{name}: {why}" for name, why in data["absent"].items())
    refusing = [f"{one['name']} {said}" for one in data["engines"] if "above" in (said := one.get("refusals", ""))]
    said = (f"Not installed here: {absent}." if absent else "", *(f"{one}." for one in refusing))
    return tuple(Text(one, "soft") for one in said if one)


def _conventions(data: Data) -> Table:
    """How engines state what they are asked."""
    rows = ((engine["name"], *row) for engine in data["engines"] for row in engine["conventions"])
    return Table.by_group(("engine", "what", "convention"), rows)


def _tally(engine: Row, data: Data, found: _Found) -> tuple[str, ...]:
    """A line of the overview."""
    name, tally = engine["name"], Counter(cell["verdict"] for cell in data["cells"] if cell["engine"] == engine["name"])
    own = [proof["proven"] for proof in data["proofs"] if proof["engine"] == name]
    proofs = (f"{sum(own)} of {len(own)}" if not all(own) else str(len(own))) if any(tally[red] for red in RED) else ""
    verdicts = ("imprecise", "crashes", "raises", "refuses", "precondition", "repairs", "plug-in")
    counts = verdict(tally["wrong"] or "", not tally["wrong"]), *(str(tally[name] or "") for name in verdicts)
    causes = str(len(found.by(name)) or "")
    return (
        f"[{name}](#{'engine' if causes else 'functions'}-{name})",
        engine["version"],
        causes,
        str(tally["right"]),
        *counts,
        proofs,
        _measured([row for row in data["asked"] if row["engine"] == name], data),
    )


def _measured(asked: list[Row], data: Data) -> str:
    """When and of which commit something was measured; on how many trees, where that differs."""
    keys = sorted((row["origin"] for row in asked), key=str)
    origins = by_origin(data if key == "" else data["origins"][key] for key in keys or ("",))
    several = len(origins) > 1
    return "; ".join(f"{date}, {revision}" + (f": {number}" if several else "") for date, revision, number in origins)


def _earlier(data: Data) -> Iterator[Text]:
    """Which cells are of earlier commits, and how much was not asked: of engines that are not here, what changed."""
    if left := data.get("left"):
        engines = ", ".join(f"{name} {number}" for name, number in left.items())
        said = f"{counted(sum(left.values()), 'pair')} of an engine and a tree ({engines})"
        yield Text(f"Not asked anew: {said}; `{PROGRAM} engines --update` asks them where the engines are.", "bad")
    earlier = [row for row in data["asked"] if row["origin"] != ""]
    if earlier:
        why = "the same question was put to the same release by the same code"
        said = f"{counted(len(earlier), 'pair')} of an engine and a tree, of {len(data['asked'])}"
        yield Text(f"Taken over from earlier commits, where {why}: {said}. {_measured(earlier, data)}.", "soft")


def _identities(data: Data) -> Table:
    """Numbers of trees of all engines on which an identity holds, and where it does not."""

    def row(identity: str) -> tuple[str | Cell, ...]:
        own = [one for one in data["identities"] if one["identity"] == identity]
        broken = [one for one in own if not one["ok"]]
        asked, failed = (Counter(one["engine"] for one in rows) for rows in (own, broken))
        where = "; ".join(f"{name} on {number} of {asked[name]}" for name, number in failed.items())
        hint = "; ".join(f"{one['engine']}, {one['model']}" for one in broken)
        return identity, str(len(asked)), f"{len(own) - len(broken)} of {len(own)}", Cell(where, hint=hint)

    identities = dict.fromkeys(one["identity"] for one in data["identities"])
    return Table.of("identity | engines | holds on | broken by", map(row, identities))


TOPIC = Topic("engines", "Correctness", "Which engine is wrong where?", compose, measure)
