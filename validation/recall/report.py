"""The recall of a test suite as a report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..reporting.numbers import counted
from ..reporting.provenance import by_origin
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Text, Topic, verdict
from .measure import measure
from .scoring import LOST

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
