"""Red cells as stand-alone scripts: what the engine was asked, the truth, and an assertion that fails."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...contract.raised import Raised, attempted
from ..causes.grouping import cause_of
from ..digests import digest
from ..functions import FUNCTIONS
from ..interface import Array, EnginePlugin
from ..matrix import SEED, Judged, Truths, judged
from ..plugins.writing.source import SourcePlugin
from ..verdicts import Cell
from ..workers import Crashed, Job, Worker
from .pieces import taken
from .shrink import TRIES, Case, size, smallest

# A smaller case keeps at least this part of the error, so that it shows the same fault plainly.
_KEPT = 0.05
_TIME = 120.0
# Shapes in functions' texts, such as "(L, 6, nv)".
_SHAPES = re.compile(r" \((?:10 )?(?:\d+|L|m|n[qv])(?: \+ m|, (?:10 )?(?:\d+|L|m|n[qv])(?: \+ m)?)*\)")
# Time to shrink one fault: cases of loops, and digits that are lost, take long to judge.
_PATIENCE = 60.0
# Length of a script's name without its ending and a digest: names of drawn trees list all their features.
_LONGEST = 200
# How the assertion ends that a script ends with (`text`); others are of the text that builds the tree.
_ASSERTED = r"^AssertionError: (value = |\()"
# What is said in place of the output of a script where the plug-in has none (`EngineModel.script`).
NO_SCRIPT = "no script: the plug-in states none"


@dataclass(frozen=True)
class Proof:
    """A red cell with its script.

    Attributes:
        engine: Name of the engine.
        model: Name of the tree.
        function: Name of the function.
        native: Name that the engine gives it.
        verdict: One of `verdicts.RED`.
        error: Error of the cell, as part of the largest entry.
        tolerance: Tolerance, likewise.
        file: Name of the script's file.
        text: The script; "" where there is none.
        output: What it printed, and how it ended; or why there is no script.
        proven: Whether it failed as it must.
        thread: Public thread that knows the fault, or that none was found.
    """

    engine: str
    model: str
    function: str
    native: str
    verdict: str
    error: float
    tolerance: float
    file: str
    text: str
    output: str
    proven: bool
    thread: str


@dataclass
class Prover:
    """Writes scripts of red cells, and runs them.

    Attributes:
        worker: Process that the engines run in.
        folder: Folder of the scripts.
        tries: Bound on the cases that are tried to shrink each fault.
        shown: Cases that show faults, by engine and model: the next fault of theirs is looked for there first.
    """

    worker: Worker
    folder: Path
    tries: int = TRIES
    shown: dict[tuple[str, str], list[Case]] = field(default_factory=dict)

    def prove(self, plugin: EnginePlugin, red: Judged) -> Proof:
        """A script of a red cell, run in a fresh process: the folder's where it still fails, else one of a shrunk case.

        Whatever the plug-in raises on the way is said in place of a proof.
        """
        made = attempted(self._proved, plugin, red)
        return _proof(plugin, red, "", f"no script: {made.words}", False) if isinstance(made, Raised) else made

    def _proved(self, plugin: EnginePlugin, red: Judged) -> Proof:
        path = self.folder / file_of(red)
        if path.exists():
            kept = path.read_text(encoding="utf-8")
            output, failed = fails(path, exception_of(red.cell), self.worker.python(plugin.name))
            if failed and kept.startswith(_title(plugin, red)):
                return _proof(plugin, red, kept, output, failed)
        ends = red.cell.verdict in ("crashes", "raises")
        small = _with_script(plugin, red, self.worker) if ends else self.shrunk(plugin, red)
        if not small.answer.script.strip():
            return _proof(plugin, red, "", NO_SCRIPT, False)
        self.folder.mkdir(parents=True, exist_ok=True)
        script = text(plugin, small, _thread(red))
        path.write_text(script, encoding="utf-8")
        output, failed = fails(path, exception_of(red.cell), self.worker.python(plugin.name))
        return _proof(plugin, red, script, output, failed)

    def shrunk(self, plugin: EnginePlugin, red: Judged) -> Judged:
        """The smallest case that shows the fault of a red cell; of a crash, the case itself."""
        answer, truths = red.answer, Truths()
        if (
            red.before
            or answer.layout is None
            or answer.state is None
            or red.cell.verdict not in ("wrong", "imprecise")
        ):
            return red
        # A fault that is no matter of rounding is seen without asking how far roundings go.
        quick = Truths(perturbations=0) if red.cell.verdict == "wrong" else truths
        job = Job(plugin.name, red.tree, (answer.function,), form=red.form)
        end = time.monotonic() + _PATIENCE

        def asked(case: Case, how: Truths) -> Judged:
            stated = replace(job, tree=case.tree, pieces=case.pieces, text=case.text)
            return next(judged(plugin, stated, how, self.worker))

        def shows(case: Case, how: Truths = quick) -> bool:
            if time.monotonic() > end:
                return False
            try:
                one = asked(case, how)
            except (ArithmeticError, ValueError, RuntimeError):  # Singular, or of no size, here or in the worker.
                return False
            return one.cell.verdict == red.cell.verdict and one.cell.error >= _KEPT * min(red.cell.error, 1.0)

        first = Case(red.tree, taken(answer.layout, answer.state), red.form, red.text)
        known = self.shown.setdefault((red.cell.engine, red.cell.model), [])
        begun = next((case for case in sorted(known, key=size) if size(case) < size(first) and shows(case)), first)
        case = smallest(begun, shows, self.tries) if self.tries else begun
        final = asked(case, truths)
        if final.cell.verdict != red.cell.verdict:
            # Where roundings go far, as beside what is singular, nothing is shown: asked of each case.
            end = time.monotonic() + _PATIENCE
            case = smallest(first, lambda one: shows(one, truths), self.tries)
            final = asked(case, truths)
        if case is first or final.cell.verdict != red.cell.verdict:
            return red
        known.append(case)
        return final


def _with_script(plugin: EnginePlugin, red: Judged, worker: Worker) -> Judged:
    """A cell whose engine took its script with it; where it does so as it builds, what would have been run."""
    if red.answer.script:
        return red
    layout, state = red.answer.layout, red.answer.state
    pieces = taken(layout, state) if layout is not None and state is not None else ()
    job = Job(red.cell.engine, red.tree, (red.cell.function,), SEED, pieces, red.form, red.text, called=False)
    (answer,) = worker.ask(job)
    script = answer.script
    if isinstance(answer.value, Crashed | Raised) and isinstance(plugin, SourcePlugin):
        script = plugin.building(red.tree, red.form, red.text)
    return replace(red, answer=replace(red.answer, script=script))


def _proof(plugin: EnginePlugin, red: Judged, script: str, output: str, failed: bool) -> Proof:
    cell = red.cell
    return Proof(
        engine=plugin.name,
        model=cell.model,
        function=cell.function,
        native=plugin.functions[cell.function],
        verdict=cell.verdict,
        error=cell.error,
        tolerance=cell.tolerance,
        file=file_of(red),
        text=script,
        output=output,
        proven=failed,
        thread=_thread(red),
    )


def file_of(red: Judged) -> str:
    """Name of the script's file; a long one has a digest for what is cut, as file systems take 255 bytes."""
    cell = red.cell
    whole = f"{cell.engine}-{cell.model}-{cell.function}"
    stem = "".join(letter for letter in whole.replace(":", "-").replace(" ", "_") if letter.isalnum() or letter in "-_")
    return f"{stem}.py" if len(stem) <= _LONGEST else f"{stem[:_LONGEST]}-{digest(whole)}.py"


def _thread(red: Judged) -> str:
    """The public thread that knows the cause of a cell."""
    cause = cause_of(red.cell)
    return cause.known if cause else "not searched: its cause is not yet found"


def _title(plugin: EnginePlugin, red: Judged) -> str:
    """What a script begins with: the engine and its version."""
    return f"# {plugin.name} {plugin.version()}, {red.cell.model}: "


def _worst(red: Judged) -> tuple[tuple[int, ...] | None, Array]:
    """The place where an answer is off most, None for another shape than the truth's, and the answer in its shape."""
    value = np.asarray(red.answer.value)
    assert red.want is not None
    want = red.want.value
    # A matrix of one column comes as a vector where arrays are Eigen's (`verdicts.judge`).
    if value.shape != want.shape and value.size == want.size:
        value = value.reshape(want.shape)
    if value.shape != want.shape:
        return None, value
    off = np.nan_to_num(np.abs(value - want), nan=np.inf)
    return tuple(int(k) for k in np.unravel_index(int(np.argmax(off)), want.shape)), value


def text(plugin: EnginePlugin, red: Judged, known: str) -> str:
    """The script of a case: the engine's answer, the truth where it is off most, to 17 digits, and an assertion.

    Args:
        plugin: The engine.
        red: The case.
        known: Public thread that knows the fault, or that none was found.
    """
    function = FUNCTIONS[red.cell.function.partition(":")[0]]
    verdict = red.cell.verdict if red.cell.verdict in ("crashes", "raises") else f"is {red.cell.verdict}"
    about = _SHAPES.sub("", function.text)
    head = f"{_title(plugin, red)}{plugin.functions[red.cell.function]} {verdict} ({about}).\n"
    if red.cell.words and red.want is not None:
        head += f"# {red.cell.words}.\n"
    if known.startswith("https://"):
        head += f"# Known: {known}.\n"
    if red.want is None:
        return f"{head}{red.answer.script}\n"
    place, value = _worst(red)
    if place is None:
        lines = [f"assert np.shape(value) == {red.want.value.shape}, np.shape(value)"]
    else:
        lines = [
            f"value, expected = np.reshape(value, {value.shape})[{place}], {float(red.want.value[place])!r}",
            f'assert abs(value - expected) <= {red.want.allowed:.1e}, f"{{value = }}, {{expected = }}"',
        ]
    return "\n".join([head + red.answer.script.rstrip(), "import numpy as np", *lines, ""])


def exception_of(cell: Cell) -> str:
    """Type of the exception that a red cell is; "" for none."""
    return cell.words.partition(":")[0] if cell.verdict == "raises" else ""


def fails(
    path: Path, exception: str = "", python: str = sys.executable, variables: Mapping[str, str] | None = None
) -> tuple[str, bool]:
    """Run a script in a fresh process: what it says, and whether it fails as it must.

    Args:
        path: The script.
        exception: Type of the exception that it must end in; "" for its assertion or a crash.
        python: The interpreter that runs it.
        variables: Variables of its process; None: those of this one.
    """
    try:
        done = subprocess.run([python, str(path)], capture_output=True, text=True, timeout=_TIME, env=variables)
    except subprocess.TimeoutExpired:
        return f"no end in {_TIME:g} s, which proves nothing", False
    said = done.stdout + done.stderr.replace(str(path.absolute()), path.name).replace(str(path), path.name)
    said = re.sub(r"\S*/site-packages/", "", said)  # Warnings of engines name where they are installed here.
    said = said.replace(str(Path.home()), "~")  # Banners of engines name their caches.
    ending = re.compile(rf"^(\w+\.)*{exception}\b" if exception else _ASSERTED, re.MULTILINE)
    failed = done.returncode != 0 and (done.returncode < 0 or ending.search(done.stderr) is not None)
    return f"{said.strip()}\nexit code {done.returncode}", failed
