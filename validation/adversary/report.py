"""What the adversary found; the search as a command: rounds of attacks within a budget, and their log."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from symofros.tools import stored_json, write_atomically

from ..reporting.command import Run, known
from ..reporting.numbers import counted
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from .attack import Attack
from .attacks import (
    beam_runs,
    beam_statics,
    closed_dynamics,
    diagram_runs,
    engaging_runs,
    event_runs,
    held_apart,
    inverse_kinematics,
    loop_runs,
    overconstrained_runs,
    pushed_runs,
    rigid_trees,
    rolling_runs,
    step_sizes,
)
from .search import Budget, Find, Tally, hunt
from .writing import write_find

_MODULES = (
    rigid_trees,
    closed_dynamics,
    loop_runs,
    rolling_runs,
    step_sizes,
    diagram_runs,
    beam_statics,
    beam_runs,
    inverse_kinematics,
    event_runs,
    pushed_runs,
    overconstrained_runs,
    held_apart,
    engaging_runs,
)
ATTACKS: dict[str, Attack] = {module.ATTACK.name: module.ATTACK for module in _MODULES}


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--attack", help=f"Only this; of {', '.join(ATTACKS)}.")] = None,
    seconds: Annotated[float, typer.Option(min=0.0, help="Budget of CPU time, all attacks together [s].")] = 300.0,
    examples: Annotated[int, typer.Option(min=1, help="Budget of scenes for each attack.")] = 100_000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first round.")] = 0,
    work: Annotated[Path, typer.Option(help="Folder of log, examples, finds; an old one is gone on with.")] = Path(
        "adversary"
    ),
) -> Data:
    """Search for scenes that we answer as good where an independent route says otherwise; write each as a test."""
    wanted = known(chosen, ATTACKS, "--attack", "attack")
    log = Log(work)
    unfinished: list[str] = []
    run.expect(len(wanted) * 1000, "attacking")
    for position, name in enumerate(wanted):
        budget = Budget(seconds / len(wanted), examples)
        tally = log.tallies.setdefault(name, Tally())
        run.reached(1000 * position)

        def show(name: str = name, position: int = position, budget: Budget = budget) -> None:
            share = max(budget.spent / budget.seconds if budget.seconds else 1.0, budget.tried / budget.examples)
            run.advance(f"{name}: {counted(budget.tried, 'scene')}", steps=0)
            run.reached(1000 * position + min(1000, int(1000 * share)))

        try:
            _attack(name, log, seed, budget, tally, show, run.say)
        except KeyboardInterrupt:
            unfinished = wanted[position:]
            break
        finally:
            log.save()
    return {
        "ok": not log.finds,
        "seed": seed,
        "unfinished": unfinished,
        "attacks": {name: asdict(tally) for name, tally in log.tallies.items()},
        "finds": [asdict(find) for find in log.finds],
    }


def _attack(
    name: str,
    log: Log,
    seed: int,
    budget: Budget,
    tally: Tally,
    show: Callable[[], None],
    say: Callable[[str, bool], None],
) -> None:
    """Rounds of one attack until its budget is spent."""
    attack = ATTACKS[name]
    while not budget.over:
        quantities = {find.quantity for find in log.finds if find.attack == name}
        find = hunt(attack, log.folder, seed, budget, tally, quantities, show)
        if find is not None:
            test, _ = write_find(find, attack, log.folder)
            log.finds.append(find)
            say(f"{name}: {find.said}; {test}", True)
        log.save()


def _logged(data: Any) -> tuple[dict[str, Tally], list[Find]]:
    """Tallies and finds in the contents of log.json, of attacks that still exist."""
    tallies = {name: Tally(**one) for name, one in data["attacks"].items() if name in ATTACKS}
    return tallies, [Find(**one) for one in data["finds"] if one["attack"] in ATTACKS]


class Log:
    """The log of a search in its folder: counts and finds, as log.json. What is mended since is looked at anew.

    Args:
        folder: Folder of the search.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.tallies: dict[str, Tally] = {}
        self.finds: list[Find] = []
        folder.mkdir(parents=True, exist_ok=True)
        tallies, finds = stored_json(folder / "log.json", _logged) or ({}, [])
        self.tallies = tallies
        self.finds = [find for find in finds if not ATTACKS[find.attack].verdict(find.scene).sound]

    def save(self) -> None:
        """Write it."""
        data = {
            "attacks": {name: asdict(tally) for name, tally in self.tallies.items()},
            "finds": [asdict(find) for find in self.finds],
        }
        write_atomically(self.folder / "log.json", json.dumps(data, indent=1) + "\n")


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
