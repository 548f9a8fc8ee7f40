"""Engines in processes of their own: one that crashes or hangs is an answer, too."""

from __future__ import annotations

import re
import shutil
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, TypeVar

import numpy as np

from ..contract.raised import Raised, attempted
from ..worker_process import WorkerError, WorkerProcess
from .functions import FUNCTIONS
from .interface import CALLS, Array, EngineModel, Registry, Slot, State, Tree, Unsupported, installed
from .plugins import OWN
from .plugins.writing.source import SourceModel
from .proving.pieces import Layout, Pieces, assembled
from .states import AMONG, Visit, visits
from .truth.charts import CHARTS
from .truth.constraints import closed
from .truth.dynamics import random_state

# Time for one answer; the first includes the import of the engine, and Warp and JAX compile then: minutes on a busy
# machine.
LIMIT = 300.0
# The most that is kept of what JAX compiles [bytes], and what has it keep small programs.
_COMPILED = 1_000_000_000
_ALL_COMPILED = {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0", "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1"}
T = TypeVar("T")
Ask = Callable[[State], Array | Unsupported | Raised]


@dataclass(frozen=True)
class Crashed:
    """An engine took its process with it, or gave no answer in time.

    Attributes:
        reason: Signal, exit code or limit.
    """

    reason: str


@dataclass(frozen=True)
class Job:
    """Functions of one tree in one engine.

    Attributes:
        engine: Name of the plug-in.
        tree: The tree.
        functions: Names of functions.
        seed: Seed of a random state.
        pieces: The state joint by joint, in place of a random one.
        form: Format of a file that the engine reads; "" to build the tree by its API.
        text: The file.
        called: Whether functions are called; otherwise only their scripts are written.
        further: Whether each is asked at further states on the same model (`states.visits`).
        before: Functions that are asked first on the same model, each at a state, likewise joint by joint.
    """

    engine: str
    tree: Tree
    functions: tuple[str, ...]
    seed: int = 0
    pieces: Pieces = ()
    form: str = ""
    text: str = ""
    called: bool = True
    further: bool = False
    before: tuple[tuple[str, Pieces], ...] = ()


@dataclass(frozen=True)
class Answer:
    """What came of a function.

    Attributes:
        function: Its name.
        value: The result, or what came in its place.
        layout: Layout of the model; None where there is no model.
        state: The state that it was evaluated at.
        script: Text that does the same, for a value, or an exception inside the engine.
        at: Name of the state, for words; "" for the first.
        further: Answers at further states, in the order in which they were asked.
        warned: Warnings that the engine gave as the model was made.
    """

    function: str
    value: Array | Unsupported | Crashed | Raised
    layout: Layout | None = None
    state: State | None = None
    script: str = ""
    at: str = ""
    further: tuple[Answer, ...] = ()
    warned: tuple[str, ...] = ()


@cache
def registry() -> Registry:
    """The plug-ins, looked up once a process: that reads the metadata of all packages."""
    return installed(OWN, FUNCTIONS)


def made(job: Job) -> EngineModel | Unsupported:
    """The model of a job."""
    plugin = registry().plugins[job.engine]
    return plugin.read(job.tree, job.form, job.text) if job.form else plugin.build(job.tree)


def answered(job: Job) -> Iterator[Answer]:
    """Do a job in this process; whatever a plug-in raises is its answer."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        prepared = _told(job, attempted(_prepared, job))
    warned = tuple(str(one.message) for one in caught)
    if isinstance(prepared, Raised | Unsupported):
        yield from (Answer(function, prepared) for function in job.functions)
        return
    model, layout, state = prepared
    many = getattr(registry().plugins[job.engine], "calls", CALLS)
    further = list(visits(job.tree, layout, state, job.seed, many)) if job.further and job.called else []
    for function in job.functions:
        first = replace(_answer(job, model, layout, function, Visit("", state)), warned=warned)
        if isinstance(first.value, np.ndarray) and further:
            first = replace(first, further=tuple(_at_all(job, model, layout, function, further)))
        yield first


def _answer(job: Job, model: EngineModel, layout: Layout, function: str, visit: Visit) -> Answer:
    """An answer with its script, of a model whose last call was of another function, or those that are to be before."""
    before = [(name, at) for name, pieces in job.before if isinstance(at := assembled(layout, pieces), State)]
    value: Array | Unsupported | Raised = Unsupported("not called")
    if job.called and before:
        kept = {name: _asker(job, model, name) for name in dict.fromkeys((*(name for name, _ in before), function))}
        for name, at in before:
            _called(job, kept[name], at)
        value = _called(job, kept[function], visit.state)
    elif job.called:
        value = _called(job, lambda state: model.call(function, state), visit.state)
    is_told = isinstance(value, np.ndarray) or (isinstance(value, Raised) and value.kind == "raises")
    script: str | Raised = ""
    if is_told or not job.called:
        if isinstance(model, SourceModel):
            script = attempted(model.script, function, visit.state, before)
        elif not before:  # Whoever writes scripts of one call writes none of several.
            script = attempted(model.script, function, visit.state)
    if isinstance(script, Raised):
        value, script = Raised(f"the script of {function}: {script.words}"), ""
    return Answer(function, value, layout, visit.state, script, visit.name)


def _at_all(job: Job, model: EngineModel, layout: Layout, function: str, further: Sequence[Visit]) -> Iterator[Answer]:
    """Answers on what the calls before left; of the random states among many, those that are no numbers."""
    ask = _asker(job, model, function)
    for visit in further:
        value = _called(job, ask, visit.state)
        if visit.name != AMONG or not isinstance(value, np.ndarray) or not np.all(np.isfinite(value)):
            yield Answer(function, value, layout, visit.state, at=visit.name)


def _asker(job: Job, model: EngineModel, function: str) -> Ask:
    """Calls of a function that share the engine's data, as far as the plug-in can."""
    if not isinstance(model, SourceModel):
        return lambda state: model.call(function, state)
    made = attempted(model.kept, function)
    return (lambda state: made) if isinstance(made, Unsupported | Raised) else made


def _called(job: Job, ask: Ask, state: State) -> Array | Unsupported | Raised:
    """What a call returns; an array of numbers, if it is one."""
    given = State(*(np.array(part) for part in vars(state).values()))
    value = attempted(ask, given)
    if isinstance(value, np.ndarray | Unsupported | Raised):
        return _told(job, value)
    return attempted(np.array, value, dtype=float)


def _told(job: Job, made: T) -> T | Raised | Unsupported:
    """What was made; an exception by which the engine refuses is its refusal."""
    if not isinstance(made, Raised):
        return made
    patterns = getattr(registry().plugins[job.engine], "refusals", ())
    is_refusal = made.kind == "refuses" or any(re.search(pattern, made.words) for pattern in patterns)
    return Unsupported(made.words) if is_refusal else made


def _prepared(job: Job) -> tuple[EngineModel, Layout, State] | Unsupported:
    """The model of a job, and the state that it is asked at."""
    model = made(job)
    if isinstance(model, Unsupported):
        return model
    layout = layout_of(job.tree, model)
    state = assembled(layout, job.pieces) if job.pieces else random_state(job.tree, layout, job.seed)
    if job.tree.constraints and not isinstance(state, Unsupported):
        state = closed(job.tree, layout, state, restarts=0 if job.pieces else 20)
    return state if isinstance(state, Unsupported) else (model, layout, state)


def layout_of(tree: Tree, model: EngineModel) -> Layout:
    """How a model keeps the joints of a tree.

    Raises:
        ValueError: It is a layout of no such tree; the message says where.
    """
    slots = tuple(tuple(Slot(one.chart, tuple(one.q), tuple(one.v)) for one in link) for link in model.slots)
    layout = Layout(int(model.nq), int(model.nv), slots)
    _require(tree, layout)
    return layout


def _require(tree: Tree, layout: Layout) -> None:
    """Refuse a layout that is none of the tree.

    Raises:
        ValueError: It is none; the message says where.
    """
    if len(layout.slots) != len(tree.links):
        raise ValueError(f"slots of {len(layout.slots)} links for a tree of {len(tree.links)}")
    for link, slots in zip(tree.links, layout.slots, strict=True):
        moving = [joint for joint in link.joints if joint.kind != "fixed" and joint.locked is None]
        if len(slots) != len(moving):
            raise ValueError(f"{len(slots)} slots for link '{link.name}', which has {len(moving)} moving joints")
        for slot in slots:
            chart = CHARTS.get(slot.chart)
            if chart is None:
                raise ValueError(f"slot of link '{link.name}': no chart '{slot.chart}'; they are in truth/charts.py")
            if (len(slot.q), len(slot.v)) != (chart.nq, chart.nv):
                stated = f"{len(slot.q)} coordinates and {len(slot.v)} speeds"
                raise ValueError(
                    f"slot of link '{link.name}': {stated}, not the {chart.nq} and {chart.nv} of its chart"
                )
            for place, size in ((slot.q, layout.nq), (slot.v, layout.nv)):
                if not set(place) <= set(range(size)):
                    raise ValueError(f"slot of link '{link.name}': places {place} of {size}")


def compiled() -> dict[str, str]:
    """Variables by which JAX keeps what it compiles, of engines' functions of one structure, for all processes."""
    from symofros import SymofrosError  # Where a release answers there is NumPy alone.
    from symofros.tools import cache_folder, create_cache_folder  # For the same reason.

    folder = cache_folder() / "compiled"
    try:
        create_cache_folder(folder)
        if sum(path.stat().st_size for path in folder.iterdir() if path.is_file()) > _COMPILED:
            shutil.rmtree(folder)
    except (OSError, SymofrosError):  # All is then compiled by each process.
        return {}
    return {"JAX_COMPILATION_CACHE_DIR": str(folder), **_ALL_COMPILED}


class Worker(WorkerProcess):
    """A process that engines run in, started anew after a crash; an engine that crashed has one of its own from then.

    So the others need not be imported, nor their functions compiled, once more for each crash.

    Args:
        limit: Seconds for one answer.
        shared: Whether several engines run in it.
        options: Of `WorkerProcess`.
    """

    def __init__(self, limit: float = LIMIT, shared: bool = True, **options: Any) -> None:
        if shared:
            options = {"environment": compiled(), **options}
        super().__init__(**options)
        self._limit, self._shared, self._options = limit, shared, options
        self._apart: dict[str, WorkerProcess] = {}

    def python(self, engine: str) -> str:
        """The interpreter that an engine runs in."""
        return self._python

    def ask(self, job: Job) -> Iterator[Answer]:
        """An answer for each function of a job, in order; what a crash left is asked of a new process."""
        remaining = job.functions
        while remaining:
            answers: list[Answer] = []
            try:
                process = self._apart.get(job.engine, self)
                for answer in process.call(answered, replace(job, functions=remaining), limit=self._limit):
                    answers.append(answer)
            except WorkerError as error:
                if self._shared and job.engine not in self._apart:
                    self._apart[job.engine] = WorkerProcess(**self._options)
                answers += [Answer(function, Crashed(str(error))) for function in remaining[len(answers) :][:1]]
            yield from answers
            remaining = remaining[len(answers) :]

    def close(self) -> None:
        """End all processes."""
        for process in self._apart.values():
            process.close()
        super().close()
