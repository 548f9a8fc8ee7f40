"""The recall of a test suite: every fault's wrong and right release asked and scored, and the report."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import typer

from ..engines.asking import SMOKE, Questions, about, in_turn, questions
from ..engines.causes.cause import stated as causes
from ..engines.causes.grouping import Group
from ..engines.interface import EnginePlugin, Tree
from ..engines.releases import Release, opened, plugins_of
from ..engines.verdicts import Cell
from ..faults.entry import Fault, faults, frozen
from ..faults.environment import NotAskedError, default_folder, kept, size_of
from ..reporting.command import Run, known
from ..reporting.numbers import counted
from ..reporting.provenance import by_origin
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Text, Topic, verdict
from . import suites
from .scoring import LOST, Scored, Stated, grouped, has, scored, shows

NO_PLUGIN = "the harness has no plug-in for it"


@dataclass
class Asked:
    """What one release answered.

    Attributes:
        cells: Cells, under the names of plug-ins.
        natives: Name of a function -> what the engine calls it.
        trees: Name of a tree -> what the engine calls what it states.
        seconds: Time of a processor that it took, with the truths that it was held to.
        memory: The most that its process held [MB].
        disk: Size of its environment [MB].
        words: Why it was not asked; "" where it was.
    """

    cells: list[Cell] = field(default_factory=list)
    natives: dict[str, str] = field(default_factory=dict)
    trees: dict[str, Stated] = field(default_factory=dict)
    seconds: float = 0.0
    memory: float = 0.0
    disk: float = 0.0
    words: str = ""


def measure(
    run: Run,
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAMES]...", help="Only these faults.")] = None,
    half: Annotated[
        bool | None, typer.Option("--frozen/--working", help="The faults that judge the harness, or the others.")
    ] = None,
    smoke: Annotated[bool, typer.Option("--smoke", help="At most a minute for each release.")] = False,
    update: Annotated[
        bool, typer.Option("--update", help="Keep what the report that is there says of the other faults.")
    ] = False,
    suite: Annotated[
        str, typer.Option(metavar="COMMAND", help="Score this test suite in place of ours: {python} is the release's.")
    ] = "",
    environments: Annotated[Path | None, typer.Option(help="Folder of releases' environments.")] = None,
) -> Data:
    """Score the harness, or another test suite, by real faults of engines' releases: which does it see?

    Each release is installed in an environment of its own, which is kept. The harness is the same for all: what it says
    of a fault's wrong release is held against what it says of the right one.
    """
    held = frozen()
    of_half = [name for name in faults() if half is None or (name in held) is half]
    chosen = [faults()[name] for name in known(names, of_half, "NAMES", "fault here")]
    by_engine: dict[str, list[Fault]] = {}
    for fault in chosen:
        by_engine.setdefault(fault.engine, []).append(fault)
    folder = environments or default_folder()
    asked = {"suite": suite, "smoke": smoke, "half": {None: "all", True: "frozen", False: "working"}[half]}
    earlier = _stored(run.folder / f"{run.topic.name}.json", asked, {fault.name for fault in chosen}) if update else []
    run.writes = run.asked or update or not (names or suite or smoke)

    def data(done: Any) -> Data:
        rows = earlier + [row for engine in done.results.values() for row in engine]
        rows = sorted(rows, key=lambda row: (row["engine"], row["name"]))
        return {"faults": rows, "failures": done.failures, "unfinished": list(done.unfinished), **asked}

    run.expect(len(chosen), "asking releases")

    def of_engine(engine: str) -> list[dict[str, Any]]:
        own = by_engine[engine]
        pairs = ((fault, version) for fault in own for _, version in _releases(fault))
        wanted = list(dict.fromkeys(Release(engine, version, tuple(fault.requires)) for fault, version in pairs))
        said = _by_suite(suite, wanted, folder) if suite else _by_harness(wanted, folder, smoke)
        rows = [_row(fault, said, bool(suite)) | {"frozen": fault.name in held} for fault in own]
        run.advance(engine, len(own))
        return rows

    return data(run.each(list(by_engine), of_engine, lambda done: run.save(data(done)) if run.writes else None))


def _stored(path: Path, asked: Data, anew: Collection[str]) -> list[dict[str, Any]]:
    """Rows of a stored report that are not asked anew, of faults that there still are; each with where it was measured.

    Raises:
        typer.BadParameter: There is none, or it was asked in another way.
    """
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        ways = [{name: one[name] for name in ("suite", "smoke")} for one in (stored, asked)]
    except (OSError, ValueError, KeyError) as error:
        raise typer.BadParameter(f"{path} can't be read: {error}; leave --update out", param_hint="--update") from None
    if ways[0] != ways[1]:
        raise typer.BadParameter(
            f"{path} was asked with {ways[0]}, this is {ways[1]}: ask alike", param_hint="--update"
        )
    held, there = frozen(), {name: stored[name] for name in ("revision", "date")}
    rows = [row for row in stored["faults"] if row["name"] in faults() and row["name"] not in anew]
    return [{"origin": there, **row, "frozen": row["name"] in held} for row in rows]


def _by_suite(command: str, wanted: Sequence[Release], folder: Path) -> dict[Release, Asked]:
    """What another suite says of releases."""
    said = {}
    for release in wanted:
        begun, one = time.monotonic(), Asked()
        try:
            python = kept(folder, release.requirements)
            one.disk, begun = size_of(python), time.monotonic()
            one.cells = suites.asked(command, python, release.package, release.version)
        except NotAskedError as error:
            one.words = str(error)
        one.seconds = time.monotonic() - begun
        said[release] = one
    return said


def _by_harness(wanted: Sequence[Release], folder: Path, smoke: bool) -> dict[Release, Asked]:
    """What the matrix says of releases of one engine, all asked together: they share the truths."""
    plugins = plugins_of(wanted[0].package)
    if not plugins:
        return {release: Asked(words=NO_PLUGIN) for release in wanted}
    said = {release: Asked() for release in wanted}
    with opened([(plugin, release) for release in wanted for plugin in plugins], folder) as reach:
        for release, words in reach.failures.items():
            said[release].words = words
        every = questions()
        asked = {name: every[name] for name in in_turn()} if smoke else every
        cells, _ = about(
            reach.plugins,
            asked,
            reach.worker,
            str,
            lambda: not smoke or max(reach.alone().values(), default=0.0) < SMOKE,
            further=not smoke,
        )
        seconds = reach.alone()
        for label, release in reach.release.items():
            one, (name, process) = said[release], reach.processes[label]
            one.cells += [replace(cell.cell, engine=name) for cell in cells if cell.cell.engine == label]
            one.natives |= reach.plugins[label].functions
            one.trees |= stated_by(reach.plugins[label], every)
            one.seconds += seconds[label]
            one.memory = max(one.memory, process.memory())
            one.disk = size_of(Path(process.python(label)))
    return said


def stated_by(plugin: EnginePlugin, asked: Questions) -> dict[str, Stated]:
    """Names of trees and files -> what an engine calls what they state, and what it does to them."""
    known: Mapping[str, str] = getattr(plugin, "demands", {})
    constraints: Mapping[str, str] = getattr(plugin, "constraints", {})
    stated = {name: Stated(known.get(one.form, "")) for name, one in asked.items() if not isinstance(one, Tree)}
    for name, tree in ((name, one) for name, one in asked.items() if isinstance(one, Tree)):
        done = [known.get(one, "") for one in sorted(tree.transformations)]
        called = [known.get(one, "") for one in sorted(tree.demands)]
        called += [constraints.get(one.kind, "") for one in tree.constraints]
        stated[name] = Stated(", ".join(filter(None, done)), ", ".join(filter(None, dict.fromkeys(called))))
    return stated


def _row(fault: Fault, said: Mapping[Release, Asked], by_suite: bool) -> dict[str, Any]:
    """A fault's row of the report."""
    sides = {side: said[Release(fault.engine, version, tuple(fault.requires))] for side, version in _releases(fault)}
    words = "; ".join(dict.fromkeys(one.words for one in sides.values() if one.words))
    result = Scored("not asked", words) if words else _score(fault, sides["wrong"], sides.get("right"), by_suite)
    if words == NO_PLUGIN:
        result = Scored("miss", NO_PLUGIN)
    spent = {
        "minutes": round(sum(one.seconds for one in sides.values()) / 60.0, 2),
        "memory": round(max(one.memory for one in sides.values())),
        "disk": round(sum(one.disk for one in sides.values())),
        "cells": sum(len(one.cells) for one in sides.values()),
    }
    stated = {name: getattr(fault, name) for name in ("name", "engine", "wrong", "right", "kind", "thread")}
    return stated | {"what": fault.fault} | result.row() | spent


def _releases(fault: Fault) -> list[tuple[str, str]]:
    return [(side, version) for side, version in (("wrong", fault.wrong), ("right", fault.right)) if version]


def _score(fault: Fault, wrong: Asked, right: Asked | None, by_suite: bool) -> Scored:
    """The score of a fault whose releases were asked."""
    natives, version = wrong.natives, fault.right or fault.wrong

    def explained(group: Group) -> str:
        """The cause of a group that is new at the right release: stated of the engine, or another fault of the set."""
        cause = next((cause for cause in causes() if all(map(cause.explains, group.cells))), None)
        others = (one for one in faults().values() if one.engine == fault.engine and one is not fault)
        called = [natives.get(name, name) for name in group.functions]
        left = (one for one in others if has(one, version))
        other = next((one for one in left if shows(one, group, called, wrong.trees)), None)
        return cause.what if cause else other.name if other else ""

    cells = None if right is None else right.cells
    together = suites.apart if by_suite else grouped
    return scored(fault, wrong.cells, cells, natives, explained, together, wrong.trees)


# Part of the faults that is to be hit.
_WANTED = 0.8
_TEXT = f"""A fault is a wrong number of a public release (`validation/faults/entries`), found in its tracker, in its
changelog, or by a harness. The same harness asks the wrong release and the first right one, each in an environment of
its own. **hit**: a group of cells that is red at the wrong release and not, or less, at the right one shows what
the fault's file states as its subject. **half a hit**: such groups are imprecise only, or are lost among
{LOST} new groups or more. **miss**: neither. **false
alarm**: a group that is red at the right release and not, or less, at the wrong one, which neither a cause that is
stated of the engine nor another fault of the set explains. Groups are found from the cells alone. Names are
compared by `validation/recall/scoring.py`. The frozen faults were chosen before the harness was changed for any of them
(`validation/faults/frozen.txt`); the others were worked with."""
Row = Mapping[str, Any]


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows: Sequence[Row] = data["faults"]
    sets = {"frozen": [row for row in rows if row["frozen"]], "working": [row for row in rows if not row["frozen"]]}
    alarms = sum(row["alarms"] for row in rows)
    asked = [row for row in rows if row["right"] and row["score"] != "not asked"]
    lines = [_tally(name, own) for name, own in sets.items() if own]
    # The frozen faults decide; where they were not asked, the others.
    decisive = "frozen" if sets["frozen"] else "working"
    met = [not alarms, not data["failures"], _part(sets[decisive]) >= _WANTED]
    who = (
        f"`{data['suite']}`"
        if data["suite"]
        else "The harness" + (", within a minute a release," if data["smoke"] else "")
    )
    said = "; ".join(f"{_hits(own)} of {len(own)} of the {name} set" for name, own in sets.items() if own)
    head = "set | faults | hit | half a hit | miss | not asked | hit, of all | false alarms"
    overview = Table.of(head, lines)
    failures = Bullets(tuple(f"{name}: {why}" for name, why in data["failures"].items()))
    return Report(
        "Real faults of releases: which are seen",
        f"{who} hits {said}; {counted(alarms, 'false alarm')} on {counted(len(asked), 'right release')}.",
        all(met),
        (_TEXT,),
        (
            Section("Sets", (overview, failures), "sets"),
            Section("Faults", (Table.of(_HEAD, map(_line, rows)), Text(_COLUMNS, "soft")), "faults", all(met)),
            Section("By class", (Table.of(f"class | {_CLASSES}", _by("kind", rows)),), "classes"),
            Section("By engine", (Table.of(f"engine | {_CLASSES}", _by("engine", rows)),), "engines"),
            *_earlier(rows),
            *(Section(row["name"], _shown(row), row["name"], page_only=True) for row in rows if _shown(row)),
        ),
        facts=(
            *(
                Fact(
                    f"{_part(own):.0%}",
                    f"of the {name} set are hit",
                    _part(own) >= _WANTED if name == decisive else None,
                )
                for name, own in sets.items()
                if own
            ),
            Fact(str(alarms), f"false alarms on {counted(len(asked), 'right release')}", not alarms),
            Fact(f"{sum(row['minutes'] for row in rows):.0f} min", "for all releases of all faults"),
        ),
        digest=(overview, Table.of(_HEAD, map(_line, rows))),
        unfinished=tuple(data["unfinished"]),
        aims=all(met[:2]),
    )


_HEAD = "fault | engine | wrong | right | class | score | seen by | new groups | false alarms | min | MB | MB on disk"
_COLUMNS = """min: both releases, with the truths that they are held to. MB: the most that a release's process held. MB
on disk: both environments."""
_CLASSES = "faults | hit | half a hit | miss | not asked"


def _earlier(rows: Sequence[Row]) -> Iterator[Section]:
    """Which rows an update has kept."""
    if origins := by_origin(row["origin"] for row in rows if "origin" in row):
        table = Table.of(
            "asked on | by the harness of | faults",
            ((date, revision, str(number)) for date, revision, number in origins),
        )
        yield Section(f"When the {len(rows)} faults were asked, where earlier", (table,), "asked")


def _hits(rows: Sequence[Row]) -> int:
    return sum(row["score"] == "hit" for row in rows)


def _part(rows: Sequence[Row]) -> float:
    return _hits(rows) / len(rows) if rows else 0.0


def _tally(name: str, rows: Sequence[Row]) -> tuple[str, ...]:
    """A line of the overview."""
    alarms = sum(row["alarms"] for row in rows)
    part = verdict(f"{_part(rows):.0%}", _part(rows) >= _WANTED if name == "frozen" else None)
    return name, *_counts(rows), part, verdict(alarms, not alarms)


def _counts(rows: Sequence[Row]) -> tuple[str, ...]:
    tally = Counter(row["score"] for row in rows)
    return str(len(rows)), *(str(tally[name]) for name in ("hit", "half a hit", "miss", "not asked"))


def _by(name: str, rows: Sequence[Row]) -> Iterator[tuple[str, ...]]:
    """Lines of scores by what faults have in common."""
    for value in sorted({row[name] for row in rows}):
        yield value, *_counts([row for row in rows if row[name] == value])


def _line(row: Row) -> tuple[str, ...]:
    """A fault's line."""
    naming = next((one for one in row["groups"] if one["shows"]), None)
    seen = _functions(naming) if naming and row["score"] in ("hit", "half a hit") else ""
    why = f": {row['why'].splitlines()[0]}" if row["why"] else ""
    link = f"[{row['name']}](#{row['name']})" if _shown(row) else row["name"]
    stated = link, row["engine"], row["wrong"], row["right"] or "none yet", row["kind"]
    numbers = (str(len(row["groups"])), verdict(row["alarms"], not row["alarms"]), f"{row['minutes']:.1f}")
    return *stated, f"{row['score']}{why}", seen, *numbers, str(row["memory"]), str(row["disk"])


def _functions(group: Row) -> str:
    """What a group shows in: the first functions, and of what else there are how many."""
    first, *others = group["natives"]
    more = f" and {counted(len(others), 'other')}" if others else ""
    return f"`{first}`{more}, {counted(len(group['models']), 'tree')}"


def _shown(row: Row) -> tuple[Any, ...]:
    """What a fault's section has: new groups, and those of the right release."""
    head = "release | shows it | verdict | functions | trees and files | explained by"
    lines = [
        (
            release,
            "yes" if one["shows"] else "",
            one["verdict"],
            ", ".join(one["natives"]),
            "; ".join(one["models"]),
            one["explained"],
        )
        for release, groups in ((row["wrong"], row["groups"]), (row["right"], row["others"]))
        for one in groups
    ]
    return (row["what"], Table.of(head, lines)) if lines else ()


TOPIC = Topic("recall", "Correctness", "Which faults of real releases are seen?", compose, measure)
