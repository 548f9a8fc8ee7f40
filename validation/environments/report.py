"""Times and differences of each environment, and who was not there; the command runs one process an environment."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import typer

from ..reporting.charts import logarithmic, style
from ..reporting.command import Quick, Run, known
from ..reporting.figures import Curve, Drawing, Figure
from ..reporting.numbers import counted, digits, duration, times
from ..reporting.plain import plain, restored
from ..reporting.provenance import stamp
from ..reporting.questions import failure_texts
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Text, Topic
from ..timing.worker import Message
from ..worker_process import WorkerError, WorkerProcess
from . import in_node
from .in_casadi import CASADI
from .in_jax import JAX
from .in_torch import TORCH
from .race import TURNS
from .record import NATIVE, OURS, TOLERANCE, Absent, Record, Row
from .worker import work

SETTINGS: Mapping[str, Mapping[str, str]] = {
    in_node.NAME: {},
    **{one.name: one.settings for one in (JAX, TORCH, CASADI)},
}
MODELS = ("panda", "ur5")
STATES = (1, 1024)
_ONLY = f"Only this environment; repeatable. {', '.join(SETTINGS)}."
_MODEL = f"Only this model; repeatable. {', '.join(MODELS)}."


def run_environment(
    name: str, models: list[str], turns: int, record: Record, doing: Callable[[str], object] = lambda said: None
) -> None:
    """Race one environment in a process of its own, and add its results to a record.

    Args:
        name: Name of the environment.
        models: Labels of the models.
        turns: Interleaved turns of each race.
        record: Record that is added to.
        doing: Called with what comes next.

    Raises:
        RuntimeError: The process ended before its time; with its last words.
    """
    try:
        with (
            TemporaryDirectory() as folder,
            WorkerProcess(environment=SETTINGS[name], log=Path(folder) / "log") as worker,
        ):
            for message in worker.call(work, name, models, STATES, turns):
                take(message, record, doing)
    except WorkerError as error:
        raise RuntimeError(f"the process of {name}: {error}") from None


def take(message: Message, record: Record, doing: Callable[[str], object]) -> None:
    """Add a worker's message to a record."""
    kind, value = message
    if kind == "doing":
        doing(": ".join(value))
    elif kind == "version":
        record.packages[value[0]] = value[1]
    else:
        kept: dict[str, list[Any]] = {"row": record.rows, "absent": record.absent, "failed": record.failed}
        kept[kind].append(value)


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--environment", "-e", help=_ONLY)] = None,
    models: Annotated[list[str] | None, typer.Option("--model", help=_MODEL)] = None,
    turns: Annotated[int, typer.Option(min=1, help="Interleaved turns of each race.")] = TURNS,
    quick: Quick = False,
) -> Data:
    """Check and time models in JAX, PyTorch, CasADi and WebAssembly, beside native C and beside peers."""
    names = known(chosen, SETTINGS, "--environment", "environment")
    labels = known(models, MODELS, "--model", "model")
    if quick:
        labels, turns = labels[:1], min(turns, 3)
    run.writes = run.asked or not (chosen or models)
    run.expect(len(names))
    record = Record()

    def work(name: str) -> str:
        run_environment(name, labels, turns, record, lambda said: run.advance(f"{name}: {said}", steps=0))
        run.advance()
        return name

    done = run.each(names, work)
    origin: dict[str, Any] = stamp()
    origin["versions"] = origin["versions"] | record.packages
    return {**origin, **done.head(record.ok, quick), **plain(record), "turns": turns, "environments": names}


_TITLES = {in_node.NAME: in_node.TITLE} | {one.name: one.title for one in (JAX, TORCH, CASADI)}
_LIMITS = {in_node.NAME: in_node.LIMITS} | {one.name: one.limits for one in (JAX, TORCH, CASADI)}
_INTRO = """Does a model give the same numbers in every environment, and is it faster there than what one would
otherwise use? Each row is one race: the same seeded states for all sides, each side checked first against native C
(called from Python, arrays in and out), then timed in turn on one processor by the clock. Times are the least of
{turns}, of a state; in brackets the median over the turns of a side's time over ours: where it is above 1×, ours is the
faster. Native C has no framework around it: what it is faster by is what the framework costs."""
_ELSEWHERE = """C, Python, MEX, FMU: [timing](timing.html) and [exports](exports.html). CUDA, beside
MuJoCo Warp: [graphics processor](cuda.html)."""
_DIFFERENCES = f"""Largest difference from native C over the states, relative to a state's largest entry; at most
{TOLERANCE:.0e} is asked for, as solving M amplifies rounding. 0 is bit for bit."""

Races = dict[tuple[str, str, int], dict[str, Row]]


def compose(data: Data) -> Report:
    """The report of its JSON."""
    record = restored(Record, data)
    names = list(dict.fromkeys(row.environment for row in record.rows))
    own = [row for row in record.rows if row.who == OURS]
    peers = [row for row in record.rows if row.who not in (OURS, NATIVE)]
    worst = max((row.error for row in own), default=0.0)
    beaten = sum(row.ratio > 1.0 for row in peers)
    races = f"{counted(len(own), 'race')} in {counted(len(names), 'environment')}"
    wrong = f"; {counted(len(record.failed), 'side')} could not be raced" if record.failed else ""
    failures = data.get("failures", {})
    failed = f"; {counted(len(failures), 'environment')} could not be done" if failures else ""
    failed_texts = tuple(
        Text(f"{_TITLES[environment]}: {function}, {who}: {reason}", "bad")
        for environment, function, who, reason in record.failed
    )
    return Report(
        "Environments: numbers beside native C, speed beside a peer",
        f"{races}: ours differ from native C by at most {digits(worst)}; "
        f"ours is faster than the peer in {beaten} of {counted(len(peers), 'comparison')}{wrong}{failed}.",
        bool(data["ok"]),
        (_INTRO.format(turns=counted(data["turns"], "turn")), *failure_texts(failures), *failed_texts),
        (
            *(_section(name, [row for row in record.rows if row.environment == name]) for name in names),
            Section("Not here", (Bullets(tuple(map(_said, record.absent))),), "not-here"),
            Section("Elsewhere", (_ELSEWHERE,), "elsewhere"),
        ),
        facts=tuple(fact for name in names for fact in _facts(name, record.rows)),
        unfinished=tuple(data.get("unfinished", ())),
        decisions=(_overview(names, record.rows),) if names else (),
    )


def _said(one: Absent) -> str:
    who = _TITLES[one.environment] if one.who == OURS else f"{one.who} in {_TITLES[one.environment]}"
    return f"{who}: {one.reason}" + (f"; `{one.remedy}`" if one.remedy else "")


def races_of(rows: Iterable[Row]) -> Races:
    """Rows of the same race by side, keyed by model, function and number of states."""
    races: Races = {}
    for row in rows:
        races.setdefault((row.model, row.function, row.states), {})[row.who] = row
    return races


def _sides(rows: Iterable[Row]) -> list[str]:
    """Sides in the order of the columns: ours, native C, peers."""
    return sorted(dict.fromkeys(row.who for row in rows), key=lambda who: (who != OURS, who != NATIVE))


def _section(name: str, rows: list[Row]) -> Section:
    sides = _sides(rows)
    timed = _by_race(rows, sides, _time)
    differing = _by_race(rows, [who for who in sides if who != NATIVE], lambda row: digits(row.error))
    fold = Section("Differences from native C", (_DIFFERENCES, differing))
    return Section(_TITLES[name], (_LIMITS[name], timed, _figure(name, rows, sides), fold), name)


def _by_race(rows: list[Row], sides: list[str], shown: Any) -> Table:
    """A row a race, a column a side; models above their functions."""
    lines: list[tuple[str, ...]] = []
    for race in races_of(rows).values():
        first = next(iter(race.values()))
        cells = (shown(race[who]) if who in race else "-" for who in sides)
        lines.append((first.title, first.task, str(first.states), *cells))
    heads = ("model", "function", "states", *("ours" if who == OURS else who for who in sides))
    return Table.by_group(heads, lines)


def _time(row: Row) -> str:
    taken = duration(1e-9 * row.least)
    beside = f" ({times(row.ratio)})" if math.isfinite(row.ratio) else ""
    return f"**{taken}**" if row.who == OURS else f"{taken}{beside}"


def _facts(name: str, rows: Iterable[Row]) -> Iterator[Fact]:
    """How many times longer peers take, in the middle of their races of most states; none where nobody raced."""
    ratios = _ratios(name, rows)
    if ratios:
        most = max(ratios)
        said = f"{_TITLES[name]}: peers' time over ours, median with {counted(most, 'state')} a call"
        yield Fact(times(median(ratios[most])), said)


def _ratios(name: str, rows: Iterable[Row]) -> Mapping[int, list[float]]:
    """Peers' times over ours, by states in a call."""
    ratios: dict[int, list[float]] = {}
    for row in rows:
        if row.environment == name and row.who not in (OURS, NATIVE) and math.isfinite(row.ratio):
            ratios.setdefault(row.states, []).append(row.ratio)
    return ratios


def _overview(names: list[str], rows: list[Row]) -> Table:
    counts = sorted({row.states for row in rows})
    lines = []
    for name in names:
        ours = [row.error for row in rows if row.environment == name and row.who == OURS]
        ratios = _ratios(name, rows)
        spans = (f"{times(min(ratios[n]))} to {times(max(ratios[n]))}" if n in ratios else "-" for n in counts)
        lines.append((_TITLES[name], digits(max(ours, default=None)), *spans))
    heads = (f"peers' time over ours, {counted(n, 'state')} a call" for n in counts)
    return Table(("environment", "largest difference from C", *heads), tuple(lines))


def _figure(name: str, rows: list[Row], sides: list[str]) -> Figure:
    """Each side's time of each function of the first model, with most states in a call."""
    races = races_of(rows)
    model, most = rows[0].model, max(row.states for row in rows)
    shown = [race for (label, _, states), race in races.items() if label == model and states == most]
    caption = f"""{rows[0].title}, {counted(most, "state")} a call. Look at how far to the right of ours (circles) the
    marks of peers are: a decade is a factor of ten. Native C, without the framework, is what ours can come near to."""
    drawing = Drawing(
        f"{_TITLES[name]}: time of a state",
        "time of a state  [s]",
        "",
        partial(_paint, shown, sides),
        size=(640.0, 34.0 * len(shown) + 20.0),
    )
    return Figure(caption, (drawing,))


def _paint(shown: list[dict[str, Row]], sides: list[str], axes: Any) -> None:
    for k, who in enumerate(sides):
        places = [(1e-9 * race[who].least, -line) for line, race in enumerate(shown) if who in race]
        label = "ours" if who == OURS else who
        axes.plot(*zip(*places, strict=True), **style(Curve(label, (), (), k, "points"), 8.0))
    axes.set_yticks([-line for line in range(len(shown))], [next(iter(race.values())).task for race in shown])
    axes.set_ylim(0.6 - len(shown), 0.5)
    axes.set_xscale("log")
    logarithmic(axes.xaxis)


_QUESTION = "Does it give the same numbers, and fast, in JAX, PyTorch, CasADi and web pages?"
TOPIC = Topic("environments", "Speed", _QUESTION, compose, measure)
