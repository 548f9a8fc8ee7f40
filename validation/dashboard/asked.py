"""Entries -> what a new reader asks first, each with its answer in one or two sentences, from the stored reports."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Mapping

from ..reporting.record import Block, Bullets, Table
from .gather import Entry
from .trust import uncovered

# An engine in the list that the report on engines begins with: its name, how many causes, the first of them.
_CAUSES = re.compile(r"\*\*\[(.+?)\]\(.*?\)\*\*, (\d+) causes?(?:, first)?: (.+?)\.?(?: Shows in:|$)", re.DOTALL)
# Engines whose first cause is stated; of the others the number alone.
_EXPLAINED = 2
# In the scene's cell: its title within a link.
_SCENE = re.compile(r"\[(.+?)\]")
_SENTENCE = re.compile(r"(?<=[.?!])\s+(?=[A-Z])")
# The humanoid among the models that are raced.
_HUMANOID = "Talos"


def asked_first(entries: Mapping[str, Entry]) -> Table:
    """Five questions; those that no report answers yet are left out."""
    answers = (
        ("Which method for my scene?", _methods(_blocks(entries, "pareto")), "pareto"),
        ("Which engine is wrong, and why?", engines_wrong(_blocks(entries, "engines")), "engines"),
        ("How far may a beam bend?", _bending(entries), "accuracy"),
        ("Is it faster than MuJoCo on a humanoid?", _humanoid(_blocks(entries, "timing")), "timing"),
        ("What is not covered?", uncovered(entries), "trust"),
    )
    rows = ((f"[{asked}]({name}.html)", said) for asked, said, name in answers if said)
    return Table.of("you ask | answer", rows)


def _blocks(entries: Mapping[str, Entry], name: str) -> tuple[Block, ...]:
    report = entries[name].report if name in entries else None
    return report.decisions if report else ()


def _methods(blocks: tuple[Block, ...]) -> str:
    """Of each scene, the method that is fastest at most of its errors."""
    chosen: dict[str, Counter[str]] = defaultdict(Counter)
    for table in (block for block in blocks if isinstance(block, Table)):
        scene, method = "", table.head.index("method")
        for row in table.rows:
            scene = str(row[0]) or scene
            chosen[scene][str(row[method])] += 1
    titles = {scene: _SCENE.findall(scene)[0] for scene in chosen}
    best = (
        f"{titles[scene][0].lower()}{titles[scene][1:]}: `{names.most_common(1)[0][0]}`"
        for scene, names in chosen.items()
    )
    said = "; ".join(best)
    return f"Fastest for most of the errors allowed: {said}." if said else ""


def engines_wrong(blocks: tuple[Block, ...]) -> str:
    """The engines by their number of causes, with what the first cause of those that have most is."""
    lists = (block for block in blocks if isinstance(block, Bullets))
    found = [match for block in lists for item in block.items for match in _CAUSES.findall(item)]
    ordered = sorted(found, key=lambda each: -int(each[1]))
    first = "; ".join(f"{name}, {number} causes, first: {why}" for name, number, why in ordered[:_EXPLAINED])
    others = ", ".join(f"{name} {number}" for name, number, _ in ordered[_EXPLAINED:])
    return f"{first}." + f" Fewer causes: {others}." * bool(others) if found else ""


def _bending(entries: Mapping[str, Entry]) -> str:
    studies = entries["accuracy"].data.get("studies", {}) if "accuracy" in entries else {}
    sentences = _SENTENCE.split(studies.get("elastica", {}).get("answer", ""))
    return " ".join(dict.fromkeys((sentences[0], sentences[-1])))


def _humanoid(blocks: tuple[Block, ...]) -> str:
    for table in (block for block in blocks if isinstance(block, Table)):
        for row in (row for row in table.rows if row[0] == _HUMANOID):
            cells = {name: str(cell) for name, cell in zip(table.head, row, strict=True) if "mujoco" in name}
            races = {name.split(":")[0]: cell for name, cell in cells.items() if cell != "-"}
            verdict = "Yes" if min(map(float, races.values()), default=0.0) > 1.0 else "Not in all"
            said = " and ".join(f"{cell} times as long for {function}" for function, cell in races.items())
            return f"{verdict}: on {_HUMANOID} MuJoCo takes {said}, state by state on one core."
    return ""
