"""One way to make a command of a report: the same options, progress, files, output and exit codes everywhere."""

from __future__ import annotations

import inspect
import json
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

import symofros as sf
from symofros.tools import write_atomically

from ..program import PROGRAM
from . import html, markdown, terminal
from .evidence import MIXED, digest
from .provenance import Provenance, stamp
from .record import Data, Report, Topic

REPORTS = Path("reports")
# Seconds between two lines of progress, of which work in short steps would write thousands into a file.
_PAUSE = 10.0


class Exit(IntEnum):
    """Exit codes."""

    GOOD = 0
    MISSED = 1
    BAD_INPUT = 2
    INTERRUPTED = 130


_FOLDER = typer.Option("--output", "-o", "--report", help=f"Folder of the report's files; {REPORTS} by default.")
Output = Annotated[Path, _FOLDER]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")]
Quick = Annotated[bool, typer.Option("--quick", help="A short way to the same questions: fewer points and runs.")]
_CODES = "Exit code: 0 everything asked for is met, 1 something is not, 2 bad input, 130 interrupted."


@dataclass
class Done:
    """Results of several parts by their names, reasons why others failed, and names that Ctrl-C cut."""

    results: dict[str, Any] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)
    unfinished: tuple[str, ...] = ()

    def head(self, ok: bool, quick: bool) -> dict[str, Any]:
        """Summary of the results' success for JSON; `ok`: whether the results are what was asked for."""
        good = ok and bool(self.results) and not self.failures and not self.unfinished
        return {"ok": good, "quick": quick, "failures": self.failures, "unfinished": self.unfinished}


def progress_bar(console: Console) -> Progress:
    """A bar with names and time left for a terminal; other outputs get a line each ten seconds (`Run.advance`)."""
    left = TextColumn("left"), TimeRemainingColumn()
    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width=16),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        *left,
    )
    return Progress(*columns, console=console, transient=True, disable=not console.is_terminal)


class Run:
    """What a command gives the function that measures: progress, and a place for results.

    Args:
        topic: The report that is made.
        folder: Folder of its files, if one was asked for.

    Attributes:
        folder: Folder of its files; a part of a report may choose another.
        asked: Whether the folder was asked for.
        writes: Whether files are written: what measures part of a report only, unasked, leaves the whole one.
    """

    def __init__(self, topic: Topic, folder: Path | None = None) -> None:
        self.topic, self.folder, self.asked, self.writes = topic, folder or REPORTS, folder is not None, True
        self.start, self._done, self._total = time.perf_counter(), 0, 0
        self._digest = present(topic)
        self._console = Console(stderr=True)
        self.bar = progress_bar(self._console)
        self._task = self.bar.add_task(topic.name, total=None)
        self._told = -_PAUSE

    def expect(self, total: int, doing: str | None = None) -> None:
        """State how many steps are to be done."""
        self._done, self._total = 0, total
        self.bar.reset(self._task, total=total, description=doing or self.topic.name)
        self._tell(f"{doing or self.topic.name}: {total} in all")

    def advance(self, doing: str | None = None, steps: int = 1) -> None:
        """Count finished steps; `doing` names the next one, or a result."""
        self._done += steps
        self.bar.update(self._task, advance=steps, description=doing)
        is_last = steps > 0 and self._done == self._total
        if is_last or self.seconds - self._told >= _PAUSE:
            self._tell(doing and f"[{self._done}/{self._total}] {doing}")

    def _tell(self, text: str | None) -> None:
        """A line of progress where no bar can be drawn, with the time since the start."""
        if self.bar.disable and text:
            self._told = self.seconds
            self._console.print(f"{self.seconds:7.1f} s  {text}", markup=False, highlight=False, soft_wrap=True)

    def reached(self, number: int) -> None:
        """State how many steps are done in all."""
        self._done = number
        self.bar.update(self._task, completed=number)

    def say(self, text: str, bad: bool = False) -> None:
        """A line on the error stream."""
        self._console.print(text, style="bold red" if bad else "yellow", markup=False)

    def each(self, names: Sequence[str], work: Callable[[str], Any], after: Callable[[Done], object] = id) -> Done:
        """Results of `work` on names, one by one: one that fails does not keep the others from being done.

        `after` is called after each with what is done so far; Ctrl-C ends them.
        """
        done = Done()
        for position, name in enumerate(names):
            try:
                done.results[name] = work(name)
            except (sf.SymofrosError, ArithmeticError, ValueError, RuntimeError) as error:
                done.failures[name] = f"{type(error).__name__}: {error}"
            except KeyboardInterrupt:
                done.unfinished = tuple(names[position:])
                break
            after(Done(done.results, done.failures, tuple(names[position + 1 :])))
        return done

    @property
    def seconds(self) -> float:
        """Wall time so far."""
        return round(time.perf_counter() - self.start, 1)

    def stamped(self, data: Data) -> Data:
        """All of the JSON: with the origin of the numbers, where the data does not state it."""
        digest = self._digest if self._digest == present(self.topic) else MIXED
        return {"seconds": self.seconds, **stamp(), "digest": digest, **data}

    def save(self, data: Data) -> None:
        """Write the report as far as it is."""
        write(self.topic, self.stamped(data), self.folder)


def present(topic: Topic) -> str:
    """Digest of the sources of a report as they are."""
    return digest(topic.home, *topic.beside)


def composed(topic: Topic, data: Data) -> Report:
    """The report composed from data as JSON restores them."""
    return topic.compose(json.loads(json.dumps(data, allow_nan=False)))


def write(topic: Topic, data: Data, folder: Path, report: Report | None = None) -> Report:
    """Write NAME.json (everything), NAME.md (texts and tables), NAME.html (one self-contained page).

    Raises:
        OSError: The folder can't be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / f"{topic.name}.json", f"{json.dumps(data, allow_nan=False)}\n")
    return render(topic, data, folder, report or composed(topic, data))


def render(topic: Topic, data: Data, folder: Path, report: Report) -> Report:
    """Write NAME.md and NAME.html."""
    written = f"Written by `{topic.command}`; everything is in `{topic.name}.json`, figures in `{topic.name}.html`."
    for kind, renderer in (("html", html), ("md", markdown)):
        origin = Provenance.of(data, present(topic))
        write_atomically(folder / f"{topic.name}.{kind}", renderer.page(report, origin, written))
    return report


def code(report: Report) -> Exit:
    """The exit code of a report."""
    if report.unfinished:
        return Exit.INTERRUPTED
    missed = Exit.BAD_INPUT if report.refused else Exit.MISSED
    return missed if report.ok is False else Exit.GOOD


def execute(topic: Topic, folder: Path | None, as_json: bool, **options: Any) -> None:
    """Measure a topic, write its report and print it (only the data as JSON if `as_json`), and exit."""
    run = Run(topic, folder)
    try:
        with run.bar:
            data = run.stamped(topic.measure(run, **options) if topic.measure else {})
    except KeyboardInterrupt:
        run.say(f"{topic.name}: interrupted, nothing is written", bad=True)
        raise typer.Exit(Exit.INTERRUPTED) from None
    report, page = composed(topic, data), f"{run.folder / topic.name}.html"
    said = f"Report: {page}"
    if not run.writes:
        said = "--report FOLDER writes the whole report"
    elif _keeps_whole(run, report):
        said = f"{page} stays that of a whole run; --report FOLDER writes this one"
    else:
        write(topic, data, run.folder, report)
    if as_json:
        typer.echo(json.dumps({name: data[name] for name in topic.printed or data}, allow_nan=False))
    else:
        terminal.show(report)
        typer.echo(said)
    raise typer.Exit(code(report))


def _keeps_whole(run: Run, report: Report) -> bool:
    """Whether a run that was cut short leaves a whole one of the same name as it is."""
    if not report.unfinished:
        return False
    try:
        stored = json.loads((run.folder / f"{run.topic.name}.json").read_text(encoding="utf-8"))
        return not run.topic.compose(stored).unfinished
    except (OSError, ValueError, KeyError, TypeError, AttributeError):  # None there, or none that can be read.
        return False


def add_command(app: typer.Typer, topic: Topic) -> None:
    """Add a report's command, if it has one: the options of what measures, the folder, and --json."""
    if topic.measure is None:
        return
    keyword = inspect.Parameter.KEYWORD_ONLY
    _, *own = inspect.signature(topic.measure, eval_str=True).parameters.values()
    options = [
        *(parameter.replace(kind=keyword) for parameter in own),
        inspect.Parameter("folder", keyword, default=None, annotation=Annotated[Path | None, _FOLDER]),
        inspect.Parameter("as_json", keyword, default=False, annotation=AsJson),
    ]

    def command(**given: Any) -> None:
        execute(topic, **given)

    command.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in options}
    said = (inspect.getdoc(topic.measure) or "").partition("\n\nArgs:")[0]
    app.command(topic.name, help=f"{said}\n\n{_CODES}")(command)


def known(
    chosen: Sequence[str] | None,
    names: Collection[str],
    option: str,
    noun: str,
    retired: Mapping[str, str] = MappingProxyType({}),
) -> list[str]:
    """The chosen names, or all if none is chosen.

    Raises:
        BadParameter: One of them does not exist; of one that is `retired`, with the command that answers its question.
    """
    for name in chosen or ():
        if name in retired:
            said = f"no {noun} '{name}': its question is answered by `{PROGRAM} {retired[name]}`"
            raise typer.BadParameter(said, param_hint=option)
        if name not in names:
            raise typer.BadParameter(f"no {noun} '{name}'; there are {', '.join(names)}", param_hint=option)
    return list(chosen or names)
