"""Engines in processes of their own: one that crashes or hangs is an answer, too."""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from multiprocessing.connection import Connection
from typing import Any

from .interface import Array, EngineModel, Registry, State, Tree, Unsupported, installed
from .plugins import OWN
from .proving.pieces import Layout, Pieces, assembled
from .truth.constraints import closed
from .truth.dynamics import random_state

# Time for one answer; the first includes the import of the engine, and Warp and JAX compile then: minutes on a busy
# machine.
LIMIT = 300.0


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
    """

    engine: str
    tree: Tree
    functions: tuple[str, ...]
    seed: int = 0
    pieces: Pieces = ()
    form: str = ""
    text: str = ""
    called: bool = True


@dataclass(frozen=True)
class Answer:
    """What came of a function.

    Attributes:
        function: Its name.
        value: The result.
        layout: Layout of the model; None where there is no model.
        state: The state that it was evaluated at.
        script: Text that does the same, for a value only.
    """

    function: str
    value: Array | Unsupported | Crashed
    layout: Layout | None = None
    state: State | None = None
    script: str = ""


@cache
def registry() -> Registry:
    """The plug-ins, looked up once a process: that reads the metadata of all packages."""
    return installed(OWN)


def made(job: Job) -> EngineModel | Unsupported:
    """The model of a job."""
    plugin = registry().plugins[job.engine]
    return plugin.read(job.tree, job.form, job.text) if job.form else plugin.build(job.tree)


def answered(job: Job) -> Iterator[Answer]:
    """Do a job in this process."""
    model = made(job)
    if isinstance(model, Unsupported):
        yield from (Answer(function, model) for function in job.functions)
        return
    layout = Layout(model.nq, model.nv, model.slots)
    state = assembled(layout, job.pieces) if job.pieces else random_state(job.tree, model, job.seed)
    if job.tree.constraints and not isinstance(state, Unsupported):
        state = closed(job.tree, layout, state, restarts=0 if job.pieces else 20)
    if isinstance(state, Unsupported):
        yield from (Answer(function, state) for function in job.functions)
        return
    for function in job.functions:
        value = model.call(function, state) if job.called else Unsupported("not called")
        silent = job.called and isinstance(value, Unsupported)
        script = "" if silent else model.script(function, state)
        yield Answer(function, value, layout, state, script)


def serve(pipe: Connection) -> None:
    """Do jobs as they come; what can't be sent back is no answer."""
    while True:
        try:
            job = pipe.recv()
        except EOFError:
            return
        try:
            for answer in answered(job):
                pipe.send(answer)
        except Exception as error:  # A fault of ours, or of a plug-in: reported, not hidden.
            pipe.send(Unsupported(f"{type(error).__name__}: {error}"))
        pipe.send(None)


class Worker:
    """A process that engines run in, started anew after a crash.

    Args:
        limit: Seconds for one answer.
    """

    def __init__(self, limit: float = LIMIT) -> None:
        self._limit = limit
        self._process: Any = None
        self._pipe: Connection | None = None

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
        if self._pipe is not None:
            self._pipe.close()
        self._process = self._pipe = None

    def ask(self, job: Job) -> Iterator[Answer]:
        """An answer for each function of a job, in order."""
        remaining = list(job.functions)
        while remaining:
            done = 0
            for answer in self._once(replace(job, functions=tuple(remaining))):
                yield answer
                done += 1
            remaining = remaining[done:]

    def _once(self, job: Job) -> Iterator[Answer]:
        pipe = self._started()
        pipe.send(job)
        for left, function in zip(range(len(job.functions) - 1, -1, -1), job.functions, strict=True):
            message: Any = None
            reason = f"no answer in {self._limit:g} s"
            if pipe.poll(self._limit):
                with contextlib.suppress(EOFError, ConnectionResetError):
                    message = pipe.recv()
            if message is None:
                if not pipe.closed and self._process.is_alive():
                    self._process.join(0.2)
                code = self._process.exitcode
                self.close()
                yield Answer(function, Crashed(reason if code is None else _exit_reason(code)))
                return
            if isinstance(message, Unsupported):
                self.close()
                raise RuntimeError(f"{job.engine}, {function}: {message.reason}")
            # The end of the job is read before its last answer is handed out: who takes that and no more leaves nothing
            # in the pipe that the next job would take for its own.
            if not left and pipe.poll(self._limit):
                pipe.recv()
            try:
                yield message
            except GeneratorExit:
                if left:
                    self.close()
                raise

    def _started(self) -> Connection:
        if self._process is not None and not self._process.is_alive():
            self.close()
        if self._pipe is None:
            context = multiprocessing.get_context("spawn")
            self._pipe, other = context.Pipe()
            self._process = context.Process(target=serve, args=(other,), daemon=True)
            self._process.start()
            other.close()
        return self._pipe


def _exit_reason(code: int) -> str:
    return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
