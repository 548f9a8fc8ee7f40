"""`python -m validation all`: every report that this machine can make of the code as it is, one after the other.

What is made is kept in a file of the work folder, with the digest of the sources that it was made of: a run that was
interrupted, or killed, goes on where it was, and makes anew what code was changed for meanwhile.
"""

from __future__ import annotations

import inspect
import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from symofros.harness import command_line
from symofros.tools import present as graphics_processor
from symofros.tools import stored_json, write_atomically

from ..cuda import warp
from ..engines.plugins import OWN
from ..faults.environment import default_folder
from ..program import PROGRAM
from ..reporting import markdown, provenance
from ..reporting.command import REPORTS, Exit, Output, Quick, known, present, progress_bar
from ..reporting.record import Table, Topic
from ..studies import studio
from .catalogue import TOPICS
from .gather import Entry, gather


@dataclass(frozen=True)
class Needs:
    """What a report takes.

    Attributes:
        packages: Packages, as they are imported.
        programs: Programs.
        besides: What else is missing here, in words; "" for nothing.
    """

    packages: tuple[str, ...] = ()
    programs: tuple[str, ...] = ()
    besides: Callable[[], str] = str

    @property
    def missing(self) -> str:
        """What this machine lacks of it; "" for nothing."""
        return ", ".join(self._missing())

    def _missing(self) -> Iterator[str]:
        packages = [name for name in self.packages if find_spec(name) is None]
        yield from (f"package {name}" for name in packages)
        yield from (f"program {name}" for name in self.programs if shutil.which(name) is None)
        if not packages and (said := self.besides()):
            yield said


def _engines() -> str:
    absent = [name for name, plugin in OWN.items() if not plugin.version()]
    return f"engines {', '.join(absent)} (or parts measured elsewhere, --part)" if absent else ""


def _releases() -> str:
    return (
        ""
        if default_folder().is_dir()
        else "environments of releases: `recall` installs them, half an hour of downloads"
    )


def _processor() -> str:
    return "a graphics processor" if graphics_processor() is None else warp.missing()


_ENGINES = ("pinocchio", "mujoco", "exudyn", "casadi")
# By the names of reports; the others take none of it.
NEEDS: dict[str, Needs] = {
    "check": Needs(_ENGINES),
    "mutation": Needs(_ENGINES),
    "mutants": Needs((*_ENGINES, "pytest", "xdist")),
    "adversary": Needs(("hypothesis",)),
    "engines": Needs(besides=_engines),
    "recall": Needs(besides=_releases),
    "campaign": Needs((*_ENGINES, "pyarrow", "distributed")),
    "timing": Needs(_ENGINES, ("c++",)),
    "rollouts": Needs(("mujoco",)),
    "exports": Needs(programs=("octave-cli", "mkoctfile")),
    "environments": Needs(("jax", "torch", "casadi"), ("node", "clang")),
    "cuda": Needs(besides=_processor),
    "pareto": Needs(("mujoco", "exudyn")),
    "studio": Needs(("playwright", "pytest"), ("npm",), besides=studio.missing),
}


WORK = Path("build/reports")
# What a process that is interrupted gets to write what it has [s].
_GRACE = 60.0
# Between two looks at a process [s].
_POLL_SECONDS = 0.5
# Exit codes of reports that are written.
_WRITTEN = {Exit.GOOD: "written", Exit.MISSED: "written; something in it is missed"}
_STATE = "state.json"


@dataclass(frozen=True)
class Made:
    """One report that was made.

    Attributes:
        digest: Digest of the sources that it was made of.
        quick: Whether the short way.
        code: Exit code.
        seconds: Time that it took [s].
        date: When it was finished.
    """

    digest: str
    quick: bool
    code: int
    seconds: float
    date: str


@dataclass(frozen=True)
class Job:
    """Folders of a run that makes reports, and whether it takes the short ways.

    Attributes:
        output: Folder of the reports.
        work: Folder of the state, of logs, and of what long reports keep.
        quick: Whether the short ways are taken, of reports that have one.
    """

    output: Path
    work: Path
    quick: bool = False

    def state(self) -> dict[str, Made]:
        """Reports that were made, by name; empty where no readable state is stored."""
        made = stored_json(self.work / _STATE, lambda rows: {name: Made(**row) for name, row in rows.items()})
        return made or {}

    def keep(self, name: str, made: Made) -> None:
        """Add a report to the state."""
        rows = {one: asdict(row) for one, row in {**self.state(), name: made}.items()}
        write_atomically(self.work / _STATE, json.dumps(rows, indent=1))

    def is_made(self, topic: Topic) -> bool:
        """Whether a report of the code as it is, made in the same way, is in the folder."""
        made = self.state().get(topic.name)
        return made is not None and (made.digest, made.quick) == (present(topic), self.quick) and self._written(topic)

    def _written(self, topic: Topic) -> bool:
        try:
            data = json.loads((self.output / f"{topic.name}.json").read_text(encoding="utf-8"))
            return bool(data.get("digest") == present(topic) and not topic.compose(data).unfinished)
        except (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError):
            return False

    def command(self, topic: Topic) -> list[str]:
        """The process that makes a report."""
        return command_line(self.arguments(topic))

    def arguments(self, topic: Topic) -> list[str]:
        """Arguments of the command that makes a report; campaign and mutants keep their work by digest of the code."""
        own = self.work / f"{topic.name}-{present(topic)[:8]}"
        if topic.name == "campaign":
            arguments = ["campaign", "run", "--models", "all", "--report", str(self.output), "-o", str(own)]
        else:
            arguments = [*topic.command.removeprefix(PROGRAM).split(), "--output", str(self.output)]
        arguments += ["--work", str(own)] if topic.name == "mutants" else []
        arguments += ["--quick"] if self.quick and has_quick(topic) else []
        return arguments

    def make(self, topic: Topic, doing: Any = id) -> tuple[int, str]:
        """Make one report: its exit code, and how it ended in words.

        Args:
            topic: The report.
            doing: Told the last line that the process has printed.

        Raises:
            KeyboardInterrupt: Ctrl-C; the process has ended, and written what it had.
        """
        start, digest = time.perf_counter(), present(topic)
        log = self.work / f"{topic.name}.log"
        with log.open("wb") as said:
            process = subprocess.Popen(self.command(topic), stdout=said, stderr=subprocess.STDOUT)
            code = _followed(process, log, doing)
        seconds = round(time.perf_counter() - start, 1)
        if code in _WRITTEN and self._written(topic):
            self.keep(topic.name, Made(digest, self.quick, code, seconds, provenance.now()))
            return code, f"{_WRITTEN[Exit(code)]}, {seconds:.0f} s"
        if code in _WRITTEN and digest != present(topic):
            return Exit.MISSED, f"written, but the code has changed meanwhile, {seconds:.0f} s"
        return code or Exit.MISSED, "\n".join([f"failed ({code}), {seconds:.0f} s; all of it: {log}", *_last(log, 5)])


def _followed(process: subprocess.Popen[bytes], log: Path, doing: Any) -> int:
    """The exit code of a process; an interrupt, which it gets as well, is passed on when it has ended."""
    try:
        while True:
            try:
                return process.wait(_POLL_SECONDS)
            except subprocess.TimeoutExpired:
                doing(next(iter(_last(log, 1)), ""))
    except KeyboardInterrupt:
        try:
            process.wait(_GRACE)
        except (subprocess.TimeoutExpired, KeyboardInterrupt):
            process.kill()
            process.wait()
        raise


def _last(log: Path, count: int) -> list[str]:
    """The last lines of a log."""
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 4000))
        return file.read().decode(errors="replace").strip().splitlines()[-count:]


def has_quick(topic: Topic) -> bool:
    """Whether a report has a short way."""
    return topic.measure is not None and "quick" in inspect.signature(topic.measure).parameters


def listed(job: Job, topics: Iterable[Topic], entries: Mapping[str, Entry]) -> Table:
    """A line a report: what there is of it, of which code, what makes it, what it lacks here."""
    rows = []
    for topic in topics:
        entry, made = entries[topic.name], job.state().get(topic.name)
        took = entry.data.get("seconds", made.seconds if made else None)
        rows.append(
            (
                topic.name,
                entry.provenance.date.removesuffix(" UTC") or "-",
                entry.standing or ("yes" if entry.report else "-"),
                f"{took:.0f} s" if took else "-",
                " ".join([PROGRAM, *job.arguments(topic)]),
                NEEDS.get(topic.name, Needs()).missing or "-",
            )
        )
    return Table.of("report | made (UTC) | of this code | took | command | missing here", rows)


def make_all(
    only: Annotated[list[str] | None, typer.Option(help=f"Only this report; repeatable. {', '.join(TOPICS)}.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Leave what is made already of the code as it is.")] = False,
    quick: Quick = False,
    show: Annotated[bool, typer.Option("--list", help="Only say what there is, of which code, and what makes it.")] = (
        False
    ),
    background: Annotated[
        bool, typer.Option("--background", help="Go on when the terminal is closed; progress goes to a file.")
    ] = False,
    output: Output = REPORTS,
    work: Annotated[Path, typer.Option(help="Folder of what is made so far, and of logs.")] = WORK,
) -> None:
    """Make every report that this machine can make of the code as it is: hours.

    Each is made in a process of its own, one after the other; --resume goes on after an end of any kind. What this
    machine lacks something for is named, with the age of the report that there is, which stays: its own command, which
    --list shows, makes what can be made of it.

    Exit code: 0 all were made and miss nothing, 1 one was not or does, 2 bad input, 130 interrupted.
    """
    topics = [TOPICS[name] for name in known(only, TOPICS, "--only", "report")]
    job = Job(output, work, quick)
    if show:
        entries = gather(output, provenance.current_versions(), names=[topic.name for topic in topics])
        typer.echo(markdown.table(listed(job, topics, entries)))
        raise typer.Exit(Exit.GOOD)
    work.mkdir(parents=True, exist_ok=True)
    output.mkdir(parents=True, exist_ok=True)
    if background:
        _detached(work)
    missing = {topic.name: NEEDS.get(topic.name, Needs()).missing for topic in topics}
    made = _all(job, [topic for topic in topics if not missing[topic.name]], resume)
    unable = {name: what for name, what in missing.items() if what}
    if made != Exit.INTERRUPTED:
        _print_unavailable(output, unable)
    raise typer.Exit(Exit.MISSED if only and unable and made == Exit.GOOD else made)


def _print_unavailable(output: Path, unable: Mapping[str, str]) -> None:
    """Name what this machine can't make, with what there is of it; where it stays that of a machine that can."""
    entries = gather(output, provenance.current_versions(), names=unable)
    for name, missing in unable.items():
        entry = entries[name]
        age = f"made {entry.provenance.date or 'on an unknown day'}, {entry.standing or 'of this code'}"
        there = f"the report that there is: {age}" if entry.report else "there is no report"
        typer.echo(f"{name}: not made, this machine lacks {missing}; {there}", err=True)


def _all(job: Job, topics: Sequence[Topic], resume: bool) -> Exit:
    """Make reports, as far as they are not made: the worst that came out."""
    console = Console(stderr=True)
    left = [topic for topic in topics if not (resume and job.is_made(topic))]
    for topic in topics:
        if topic not in left:
            console.print(f"{topic.name}: made already of this code", markup=False)
    worst, digests = Exit.GOOD, {topic.name: present(topic) for topic in topics}
    with progress_bar(console) as bar:
        task = bar.add_task("", total=len(left))

        def doing(name: str, line: str) -> None:
            bar.update(task, description=f"{name}: {line[:60]}")

        for number, topic in enumerate(left, 1):
            doing(topic.name, "")
            try:
                code, said = job.make(topic, lambda line, name=topic.name: doing(name, line))
            except KeyboardInterrupt:
                console.print(f"{topic.name}: interrupted; --resume goes on with it", markup=False)
                return Exit.INTERRUPTED
            worst = worst if code == Exit.GOOD else Exit.MISSED
            console.print(f"[{number}/{len(left)}] {topic.name}: {said}", markup=False, soft_wrap=True)
            bar.advance(task)
    changed = [topic.name for topic in topics if digests[topic.name] != present(topic)]
    if changed:
        said = f"the code has changed meanwhile: {', '.join(changed)} are of another state of it; --resume makes them"
        console.print(said, markup=False, soft_wrap=True)
        worst = Exit.MISSED
    console.print(f"{PROGRAM} dashboard gathers them on one page", markup=False)
    return worst


def _detached(work: Path) -> None:
    """Start the same command without a terminal, and end this one."""
    arguments = [word for word in sys.argv[1:] if word != "--background"]
    log = work / "all.log"
    with log.open("ab") as said:
        process = subprocess.Popen(
            command_line(arguments),
            stdout=said,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
    typer.echo(f"process {process.pid} makes them; its progress: {log}")
    raise typer.Exit(Exit.GOOD)
