"""Red cells as stand-alone scripts: about ten lines that import the engine and NumPy only, and fail."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import EnginePlugin
from validation.engines.matrix import SEED, Judged, Truths, judged
from validation.engines.plugins.writing.source import SourcePlugin
from validation.engines.proving.pieces import taken
from validation.engines.proving.pruning import pruned
from validation.engines.proving.shrink import TRIES, Case, smallest
from validation.engines.proving.threads import thread
from validation.engines.workers import Crashed, Job, Worker

# A result of more entries is shown by its worst one.
_SHOWN = 16
# A smaller case keeps at least this part of the error, so that it shows the same fault plainly.
_KEPT = 0.05
_TIME = 120.0
# Cases tried where each takes long.
_SLOW = 24


@dataclass(frozen=True)
class Proof:
    """A red cell with its script.

    Attributes:
        engine: Name of the engine.
        model: Name of the tree.
        function: Name of the function.
        native: Name that the engine gives it.
        verdict: "wrong", "imprecise" or "crashes".
        error: Error of the cell, as part of the largest entry.
        tolerance: Tolerance, likewise.
        file: Name of the script's file.
        text: The script.
        output: What it printed, and how it ended.
        proven: Whether it failed as it must.
        thread: Public thread that knows the fault, or "none found".
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


def shrunk(plugin: EnginePlugin, red: Judged, worker: Worker, truths: Truths, tries: int = TRIES) -> Judged:
    """The smallest case that shows the fault of a red cell; of a crash, the case itself."""
    answer = red.answer
    if answer.layout is None or answer.state is None or red.cell.verdict not in ("wrong", "imprecise"):
        return red
    best, final = red, red
    wrong = red.cell.verdict == "wrong"
    # A fault that is no matter of rounding is seen without asking how far roundings go.
    quick = Truths(perturbations=0) if wrong else truths
    job = Job(plugin.name, red.tree, (answer.function,))
    if red.form:
        return red

    # A state of a loop is closed anew for each case; lost digits are told from roundings for each.
    most = min(tries, _SLOW) if red.tree.constraints or not wrong else tries

    def shows(case: Case) -> bool:
        nonlocal best
        one = next(judged(plugin, replace(job, tree=case.tree, pieces=case.pieces), quick, worker))
        if one.cell.verdict != red.cell.verdict or one.cell.error < _KEPT * min(red.cell.error, 1.0):
            return False
        best = one
        return True

    case = smallest(Case(red.tree, taken(answer.layout, answer.state)), shows, most)
    if best is not red:
        final = next(judged(plugin, replace(job, tree=case.tree, pieces=case.pieces), truths, worker))
    return final if final.cell.verdict == red.cell.verdict else red


def prove(plugin: EnginePlugin, red: Judged, worker: Worker, truths: Truths, folder: Path, tries: int = TRIES) -> Proof:
    """A script of a red cell, run in a fresh process: the folder's, where it still fails, or else a new one, shrunk."""
    name = red.cell.function
    known = thread(plugin.name, red.cell.model, name)
    path = folder / file_of(red)
    if path.exists():
        kept = path.read_text(encoding="utf-8")
        output, failed = fails(path)
        if failed and f"{plugin.name} {plugin.version()}:" in kept and pruned(kept) == kept:
            return _proof(plugin, red, kept, output, failed, known)
    small = (
        _with_script(plugin, red, worker)
        if red.cell.verdict == "crashes"
        else shrunk(plugin, red, worker, truths, tries)
    )
    folder.mkdir(parents=True, exist_ok=True)
    path.write_text(pruned(text(plugin, small, known)), encoding="utf-8")
    output, failed = fails(path)
    return _proof(plugin, red, path.read_text(encoding="utf-8"), output, failed, known)


def _with_script(plugin: EnginePlugin, red: Judged, worker: Worker) -> Judged:
    """A cell whose engine took its script with it; where it does so as it builds, what would have been run."""
    job = Job(red.cell.engine, red.tree, (red.cell.function,), SEED, form=red.form, text=red.text, called=False)
    (answer,) = worker.ask(job)
    script = answer.script
    if isinstance(answer.value, Crashed) and isinstance(plugin, SourcePlugin):
        script = plugin.building(red.tree, red.form, red.text)
    return replace(red, answer=replace(red.answer, script=script))


def _proof(plugin: EnginePlugin, red: Judged, script: str, output: str, failed: bool, known: str) -> Proof:
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
        thread=known,
    )


def file_of(red: Judged) -> str:
    """Name of the script's file."""
    cell = red.cell
    stem = f"{cell.engine}-{cell.model}-{cell.function}".replace(":", "-").replace(" ", "_")
    return "".join(letter for letter in stem if letter.isalnum() or letter in "-_") + ".py"


def text(plugin: EnginePlugin, red: Judged, known: str) -> str:
    """The script of a case: the engine's answer, the truth to 17 digits, and an assertion that fails."""
    function = FUNCTIONS[red.cell.function.partition(":")[0]]
    head = (
        f'"""{plugin.name} {plugin.version()}: {plugin.functions[red.cell.function]}, {red.cell.model}.\n\n'
        f"Result: {function.text}.\nKnown: {known}.\n"
        f'"""\n\n'
    )
    if red.want is None:
        return f"{head}{red.answer.script}\n"
    value = np.asarray(red.answer.value)
    want = red.want.value
    # A matrix of one column comes as a vector where arrays are Eigen's (`verdicts.judge`).
    reshaped = value.shape != want.shape and value.size == want.size
    if reshaped:
        value = value.reshape(want.shape)
    shape = f".reshape({want.shape})" if reshaped else ""
    lines = [red.answer.script.rstrip(), f"value = np.array(value, dtype=float){shape}"]
    if want.shape == value.shape and want.size > _SHOWN:
        place = np.unravel_index(int(np.argmax(np.abs(value - want))), want.shape)
        at = ", ".join(str(int(k)) for k in place)
        lines += [f"value = value[{at}]", f"expected = {float(want[place])!r}"]
    else:
        lines.append(f"expected = np.array({want.tolist()!r})" if want.ndim else f"expected = {float(want)!r}")
    lines += [
        "error = np.max(np.abs(value - expected))",
        'print(f"{value = }\\n{expected = }\\n{error = :.3g}")',
        f"assert error <= {red.want.allowed:.1e}",
    ]
    return head + "\n".join(lines) + "\n"


def fails(path: Path) -> tuple[str, bool]:
    """Run a script in a fresh process: what it says, and whether it fails by its assertion or by a crash."""
    try:
        done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, timeout=_TIME)
    except subprocess.TimeoutExpired:
        return f"no end in {_TIME:g} s", True
    said = done.stdout + done.stderr.replace(str(path.absolute()), path.name).replace(str(path), path.name)
    said = re.sub(r"\S*/site-packages/", "", said)  # Warnings of engines name where they are installed here.
    said = said.replace(str(Path.home()), "~")  # Banners of engines name their caches.
    failed = done.returncode < 0 or (done.returncode != 0 and "AssertionError" in done.stderr)
    return f"{said.strip()}\nexit code {done.returncode}", failed
