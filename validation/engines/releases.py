"""Releases of engines, each asked in an environment of its own: they are engines of the matrix as any others.

A release's process has its own interpreter, packages and NumPy, and of this one's packages our own alone: it answers;
truths are worked out and answers are judged here.
"""

from __future__ import annotations

import copy
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from importlib import metadata
from pathlib import Path

import symofros as sf
from symofros.harness import folder_of

from ..faults.environment import NotAskedError, default_folder, kept, own_variables
from ..worker_process import WorkerError
from .interface import EnginePlugin
from .workers import LIMIT, Answer, Crashed, Job, Worker, registry

# So many questions that crash are an answer, and so many crashes at one; what else could be asked of a release is not.
CRASHES = 3
# What ends the name of a package in a requirement.
_NAME = re.compile(r"[^\w.-]")
# The harness's own packages, which a release's process gets beside `symofros`.
_OWN = ("validation", "reference_models")


@dataclass(frozen=True)
class Release:
    """One release of an engine.

    Attributes:
        package: Name on PyPI.
        version: The release; "" for the newest that can be installed.
        requires: Further requirements of its environment, as pip takes them.
    """

    package: str
    version: str = ""
    requires: tuple[str, ...] = ()

    @property
    def requirements(self) -> list[str]:
        """What pip installs; our own code takes NumPy, of whatever version the engine does."""
        return [f"{self.package}=={self.version}" if self.version else self.package, *self.requires, "numpy"]

    def __str__(self) -> str:
        return f"{self.package} {self.version}".strip()


def plugins_of(package: str) -> list[EnginePlugin]:
    """The plug-ins that ask a package."""
    return [plugin for plugin in registry().plugins.values() if plugin.package == package]


def stated(text: str, requires: Sequence[str] = ()) -> list[tuple[EnginePlugin, Release]]:
    """The release that NAME==VERSION states, with each plug-in that asks it.

    Args:
        text: Name of a plug-in, or of its package, with a version; without one, the newest release.
        requires: Further requirements; none: what the extra of the plug-in has beside the engine.

    Raises:
        ValueError: There is no such engine.
    """
    name, _, version = (part.strip() for part in text.partition("=="))
    own = registry().plugins.get(name)
    plugins = [own] if own else plugins_of(name)
    if not plugins:
        known = ", ".join(sorted({one.package for one in registry().plugins.values()} | set(registry().plugins)))
        raise ValueError(f"no engine '{name}'; there are {known}")
    release = Release(plugins[0].package, version, tuple(requires) or _beside(plugins[0]))
    return [(plugin, release) for plugin in plugins]


def _beside(plugin: EnginePlugin) -> tuple[str, ...]:
    """What the extra of an engine has beside it: what it is asked by."""
    distribution, _, extra = plugin.extra.rstrip("]").partition("[")
    with suppress(metadata.PackageNotFoundError):
        rows = (
            [row.partition(";") for row in metadata.requires(distribution) or ()] if extra.startswith("engine-") else []
        )
        own = [name.strip() for name, _, marker in rows if f"extra == '{extra}'" in marker.replace('"', "'")]
        return tuple(one for one in own if _NAME.split(one, maxsplit=1)[0] not in (plugin.package, distribution))
    return ()


class _Process(Worker):
    """The process of one release.

    Attributes:
        crashes: Questions at which the engine took it along, or gave no answer in time.
        seconds: Time of a processor that its answers took; a busy machine makes it no longer.
    """

    crashes, seconds, _last = 0, 0.0, 0.0

    def ask(self, job: Job) -> Iterator[Answer]:
        """Ask as any engine does, until it has crashed too often; the state of each crash is still searched for."""
        answers, answer, own = super().ask(job), None, 0
        looks = not job.further and (bool(job.pieces) or len(job.functions) == 1)
        while max(self.crashes, own) < CRASHES or looks:
            answer = next(answers, None)
            if answer is None:
                self._count()
                return
            if not looks and isinstance(answer.value, Crashed):
                self.crashes, own = self.crashes + (not own), own + 1
            yield answer

    def _count(self) -> None:
        """Count the time that the process has taken since; a new one begins at nothing."""
        with suppress(WorkerError):
            (now,) = self.call(("time", "process_time"))
            self.seconds, self._last = self.seconds + now - (self._last if now >= self._last else 0.0), now

    def memory(self) -> float:
        """The most that it has held so far [MB]; 0 where the system does not say."""
        with suppress(WorkerError):
            unit = 1e6 if sys.platform == "darwin" else 1e3
            return float(next(self.call(("resource", "getrusage"), 0)).ru_maxrss) / unit
        return 0.0


class ReleasesWorker(Worker):
    """A worker that asks each engine by the process of its release.

    Args:
        processes: Name of an engine here -> its plug-in's name there, and its process.
    """

    def __init__(self, processes: Mapping[str, tuple[str, _Process]]) -> None:
        super().__init__()
        self._processes = processes
        self._judging = dict.fromkeys(processes, 0.0)
        self._last = "", time.process_time()

    def ask(self, job: Job) -> Iterator[Answer]:
        """The answers of the engine's own release."""
        self._attribute(job.engine)
        name, process = self._processes[job.engine]
        return process.ask(replace(job, engine=name))

    def _attribute(self, engine: str) -> None:
        """Count what this process has worked since as judging the engine that was asked before."""
        (before, since), now = self._last, time.process_time()
        if before:
            self._judging[before] += now - since
        self._last = engine, now

    def alone(self) -> dict[str, float]:
        """Seconds that each would have taken by itself: those that ask the same of one tree share its truths."""
        self._attribute(self._last[0])
        longest = max(self._judging.values(), default=0.0)
        return {label: process.seconds + longest for label, (_, process) in self._processes.items()}

    def python(self, engine: str) -> str:
        """The interpreter that an engine runs in."""
        return self._processes[engine][1].python(engine)

    def close(self) -> None:
        """End all processes."""
        for _, process in self._processes.values():
            process.close()
        super().close()


@dataclass
class Opened:
    """Releases that can be asked.

    Attributes:
        plugins: Plug-ins by the names that engines have here.
        release: The release of each, as it was stated.
        processes: The plug-in's name there, and the process, of each.
        failures: Releases that can't be asked -> why.
        worker: Asks them all.
    """

    plugins: dict[str, EnginePlugin] = field(default_factory=dict)
    release: dict[str, Release] = field(default_factory=dict)
    processes: dict[str, tuple[str, _Process]] = field(default_factory=dict)
    failures: dict[Release, str] = field(default_factory=dict)
    worker: Worker = field(default_factory=Worker)

    def alone(self) -> dict[str, float]:
        """Seconds that each release would have taken by itself."""
        return self.worker.alone() if isinstance(self.worker, ReleasesWorker) else {}

    def stated(self, name: str) -> dict[str, bool]:
        """What a report has of an engine that is a release: that it is one, and whether it crashed too often."""
        if name not in self.processes:
            return {}
        return {"release": True, "gave_up": self.processes[name][1].crashes >= CRASHES}


def newest() -> list[str]:
    """The packages of all plug-ins that an index may have, for the newest release of each."""
    packages = dict.fromkeys(
        plugin.package for plugin in registry().plugins.values() if not plugin.extra.startswith("(")
    )
    return [package for package in packages if package != "symofros"]


@contextmanager
def in_reach(
    present: Mapping[str, EnginePlugin], pairs: Sequence[tuple[EnginePlugin, Release]], folder: Path | None
) -> Iterator[Opened]:
    """Engines that can be asked: those of this environment, or the releases that are stated.

    Args:
        present: Engines of this environment.
        pairs: Plug-ins with releases; none: the engines of this environment.
        folder: Folder of the environments; None: in the cache folder.
    """
    if not pairs:
        with Worker() as worker:
            yield Opened(dict(present), worker=worker)
        return
    with opened(pairs, folder or default_folder()) as made:
        yield made


@contextmanager
def opened(
    wanted: Iterable[tuple[EnginePlugin, Release]], folder: Path, limit: float = LIMIT, beside: Sequence[Path] = ()
) -> Iterator[Opened]:
    """Releases, each in a process of its own environment; those that can't be installed are among the failures.

    An engine has its plug-in's name here, with its release where another release is asked, too.

    Args:
        wanted: Plug-ins with releases.
        folder: Folder of the environments.
        limit: Seconds for one answer.
        beside: Further packages that the processes get.
    """
    asked, made = list(dict.fromkeys((plugin.name, release) for plugin, release in wanted)), Opened()
    plugins = {plugin.name: plugin for plugin, _ in wanted}
    with ExitStack() as stack:
        ours = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="symofros-own-")))
        _lend(ours, beside)
        for name, release in asked:
            several = sum(one == name for one, _ in asked) > 1
            try:
                process = stack.enter_context(_process(plugins[name], release, folder, ours, limit))
                version = str(next(process.call(("importlib.metadata", "version"), release.package)))
            except (NotAskedError, WorkerError) as error:
                made.failures[release] = str(error)
                continue
            label = f"{name} {version}" if several else name
            while label in made.plugins:  # The same release beside other packages.
                label += "'"
            made.plugins[label] = _as_release(plugins[name], label, version)
            made.release[label] = release
            made.processes[label] = name, process
        made.worker = ReleasesWorker(made.processes)
        yield made


def _lend(folder: Path, beside: Sequence[Path]) -> None:
    """Give a folder our own packages alone: what is installed beside them is not the release's."""
    packages = {folder_of(name) for name in _OWN} | {Path(sf.__file__).parent, *beside}
    for package in packages:
        if package.parent == Path(sf.__file__).parent:  # Within the package, where a wheel installed it.
            continue
        try:
            (folder / package.name).symlink_to(package, target_is_directory=True)
        except OSError:  # Not every system lets every user make links.
            shutil.copytree(package, folder / package.name, ignore=shutil.ignore_patterns("__pycache__"))


def _process(plugin: EnginePlugin, release: Release, folder: Path, ours: Path, limit: float) -> _Process:
    """A process that can import what it takes to ask a plug-in.

    Raises:
        NotAskedError: The release can't be installed, or our own code can't be imported beside it.
    """
    python = kept(folder, release.requirements)
    variables = own_variables() | {"PYTHONPATH": str(ours)}
    # A checkout's package is known by both of its names once it is loaded.
    process = _Process(
        limit, shared=False, python=python, path=(), environment=variables, preload=(folder_of("validation").name,)
    )
    try:
        list(process.call(Job, plugin.name, None, ()))
    except WorkerError as error:
        process.close()
        rule = "a release's environment has a NumPy that our own code can use"
        remedy = "state the NumPy that fits, by --with 'numpy<2' or in 'requires'"
        raise NotAskedError(str(sf.Problem(f"ask {release}", str(error), rule, remedy))) from None
    return process


def _as_release(plugin: EnginePlugin, name: str, version: str) -> EnginePlugin:
    """A plug-in that has a name and a version of its own."""
    other = copy.copy(plugin)
    for attribute, value in {"name": name, "version": lambda: version}.items():
        object.__setattr__(other, attribute, value)
    return other
