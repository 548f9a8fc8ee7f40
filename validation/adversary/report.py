"""What the adversary found."""

from __future__ import annotations

import json

from ..reporting.numbers import counted
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from .catalogue import ATTACKS
from .measure import measure

_TEXT = (
    "Each attack draws scenes over many decades of size, mass, stiffness and step, and compares what we claim of our "
    "answer with an independent route. A scene is **refused** where we said ourselves, by a note, an outcome or an "
    "error in words, that there is no good answer, **undecided** where the independent route has none. A find is an "
    "answer called good that is not: it is shrunk to the plainest scene and written as a test."
)
_HEAD = "attack | scenes | refused | undecided | agreed | largest error over bound | finds | CPU time [s]"
_ROW = "{} | {tried} | {refused} | {undecided} | {agreed} | {largest:.2g} | {} | {seconds:.0f}"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    finds, attacks = data["finds"], data["attacks"]
    by_attack = {name: sum(find["attack"] == name for find in finds) for name in attacks}
    rows = (_ROW.format(name, verdict(n, not n), **attacks[name]) for name, n in by_attack.items())
    tried, refused, seconds = (sum(row[name] for row in attacks.values()) for name in ("tried", "refused", "seconds"))
    listed = tuple(f"{find['attack']}: {find['said']}: `{json.dumps(find['scene'])}`" for find in finds)
    claims = Table.of("attack | claim | route", ((one.name, one.claim, one.route) for one in ATTACKS.values()))
    return Report(
        "Adversary",
        f"{counted(tried, 'scene')}: {counted(len(finds), 'answer')} called good that independent routes contradict.",
        bool(data["ok"]),
        (_TEXT,),
        (
            Section("By attack", (Table.of(_HEAD, rows),)),
            Section("Finds", (Bullets(listed),)),
            Section("Claims and routes", (claims,), page_only=True),
        ),
        facts=(
            Fact(str(tried), "scenes"),
            Fact(str(refused), "refused in words"),
            Fact(str(len(finds)), "answers called good that are not", not finds),
            Fact(f"{seconds / 3600:.1f} h", "CPU time"),
        ),
        unfinished=tuple(data["unfinished"]),
        missed=tuple(f"{find['attack']}: {find['said']}" for find in finds),
    )


QUESTION = "Is a wrong answer ever called good?"
TOPIC = Topic("adversary", "Correctness", QUESTION, compose, measure)
