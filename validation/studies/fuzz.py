"""Feed hostile inputs to the readers: none may crash them, hang them, or be accepted as what it is not.

A reader's answer to any bytes is a description, a diagram or a DescriptionError, within a bounded time and memory. What
is accepted must survive being written and read again; of the accepted files, a sample must also compile. Files of the
editor and the viewer are fed as `fuzz_files` says.
"""

from __future__ import annotations

import resource
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer

import symofros as sf

from ..reporting.command import Run
from ..reporting.numbers import counted
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from .fuzz_file_inputs import FILE_KINDS, mutated_files
from .fuzz_files import feed_file
from .fuzz_inputs import KINDS as TEXT_KINDS
from .fuzz_inputs import mutated

KINDS = (*TEXT_KINDS, *FILE_KINDS)
# A reader that takes longer on some kilobytes has been made to hang.
SLOWEST = 10.0
# A reader that needs more than this beyond what all before it did has been made to swell [MiB].
MAX_MEMORY = 1024
# Compiling is slower than reading: one accepted file in so many.
COMPILED = 25
# Inputs of a whole run.
INPUTS = 120_000

_INTERPRETED = sf.Options(functions=("mass_matrix",), backend="interpreter")


@dataclass
class Answers:
    """How the inputs of one kind were answered.

    Attributes:
        read: Accepted.
        refused: Refused with a DescriptionError.
        compiled: Accepted, and also compiled, or drawn; a part of `read`.
        slowest: Longest time one input took [s].
        slowest_input: Its number.
    """

    read: int = 0
    refused: int = 0
    compiled: int = 0
    slowest: float = 0.0
    slowest_input: int = 0


@dataclass(frozen=True)
class Fault:
    """An input that crashed a reader, took too long, or changed when it was written and read again.

    Attributes:
        kind: Kind of the input.
        number: Number of the input among its kind; with the seed, it makes the input again.
        what: What happened.
        data: The input.
    """

    kind: str
    number: int
    what: str
    data: bytes


@dataclass
class FuzzResult:
    """What became of the inputs, by kind, and the faults."""

    answers: dict[str, Answers] = field(default_factory=lambda: {kind: Answers() for kind in KINDS})
    faults: list[Fault] = field(default_factory=list)


class _Hang(BaseException):
    """End of the patience: no Exception, so that no reader takes it for a fault of its input."""


class _Changed(Exception):
    """What was accepted is not what comes back after writing."""


def fuzz(count: int, seed: int, progress: Callable[[int], None] = lambda done: None) -> FuzzResult:
    """Feed `count` inputs, of each kind in turn."""
    result = FuzzResult()
    sources = {kind: mutated_files(kind, seed) if kind in FILE_KINDS else mutated(kind, seed) for kind in KINDS}
    with tempfile.TemporaryDirectory() as name, _interrupted(), warnings.catch_warnings():
        warnings.simplefilter("error")  # A warning tells the user nothing about the file.
        folder = Path(name)
        for i in range(count):
            kind, number = KINDS[i % len(KINDS)], i // len(KINDS)
            data = next(sources[kind])
            _feed(result, kind, number, data, folder)
            progress(i + 1)
    return result


def _feed(result: FuzzResult, kind: str, number: int, data: bytes, folder: Path) -> None:
    answers = result.answers[kind]
    start, before = time.perf_counter(), peak_memory()
    signal.setitimer(signal.ITIMER_REAL, SLOWEST)
    try:
        if kind == "formula":
            _formula(data)
        elif kind == "diagram":
            _diagram(folder, data)
        elif kind in FILE_KINDS:
            answers.compiled += feed_file(kind, folder, data, number)
        else:
            _file(folder / f"hostile.{kind}", data, number, answers)
        answers.read += 1
    except sf.SymofrosError as error:
        if kind in TEXT_KINDS and not isinstance(error, sf.DescriptionError):
            result.faults.append(Fault(kind, number, f"{type(error).__name__}: {error}"[:300], data))
        else:
            answers.refused += 1
    except _Hang:
        result.faults.append(Fault(kind, number, f"took longer than {SLOWEST:g} s", data))
    except Exception as error:  # noqa: BLE001 - anything but a refusal is what is looked for.
        result.faults.append(Fault(kind, number, f"{type(error).__name__}: {error}"[:300], data))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    taken, grown = time.perf_counter() - start, peak_memory() - before
    if grown > MAX_MEMORY:
        result.faults.append(Fault(kind, number, f"took {grown:.0f} MiB more than any input before", data))
    if taken > answers.slowest:
        answers.slowest, answers.slowest_input = taken, number


def peak_memory() -> float:
    """The most memory that this process had at once so far [MiB]."""
    # Linux counts kilobytes, macOS bytes.
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << (20 if sys.platform == "darwin" else 10))


def _file(path: Path, data: bytes, number: int, answers: Answers) -> None:
    path.write_bytes(data)
    floating = path.suffix == ".urdf" and number % 2 == 1
    system = sf.load(path, floating_base=floating)
    again = path.with_name("again.yaml")
    sf.save(system, again)
    if sf.load(again) != system:
        raise _Changed("accepted, written, read again: another system")
    if answers.read % COMPILED == 0:
        model = sf.compile(system, _INTERPRETED)
        model.mass_matrix(model.neutral())
        answers.compiled += 1


# What the diagrams are about.
_ARM = """\
symofros: 1
parameters: {m: 1}
bodies:
  link:
    joint: {kind: revolute, name: q, axis: [0, 0, 1], actuated: true}
    inertia: {mass: m, moments: [0.1, 0.1, 0.1]}
    frames: {tip: {position: [1, 0, 0]}}
"""


def _diagram(folder: Path, data: bytes) -> None:
    """A file, the diagram as a whole, and the file that is written of it."""
    path = folder / "hostile.yaml"
    path.write_bytes(data)
    (folder / "arm.yaml").write_text(_ARM)
    diagram = sf.load_diagram(path)
    sf.Simulation(diagram)
    again = path.with_name("again.yaml")
    sf.save_diagram(diagram, again)
    read = sf.load_diagram(again)
    if (read.wires, read.outlets, read.simulation) != (diagram.wires, diagram.outlets, diagram.simulation):
        raise _Changed("accepted, written, read again: another diagram")


def _formula(data: bytes) -> None:
    text = str(sf.formula(data.decode("utf-8", "replace")))
    if str(sf.formula(text)) != text:
        raise _Changed(f"accepted, printed, read again: not '{text}'")


@contextmanager
def _interrupted() -> Iterator[None]:
    """While inside, the alarm clock interrupts whatever runs."""

    def ring(signum: int, frame: FrameType | None) -> None:
        raise _Hang

    before = signal.signal(signal.SIGALRM, ring)
    try:
        yield
    finally:
        signal.signal(signal.SIGALRM, before)


def measure(
    run: Run,
    count: Annotated[int, typer.Option(min=1, help="Inputs, all kinds together.")] = INPUTS,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the mutations.")] = 0,
) -> Data:
    """Feed mutated, hostile files and formulas to the readers: none may crash or hang them."""
    run.expect(count, "feeding")
    result = fuzz(count, seed, run.reached)
    kinds = {}
    for kind, answers in result.answers.items():
        faults = sum(fault.kind == kind for fault in result.faults)
        inputs = answers.read + answers.refused + faults
        kinds[kind] = {**asdict(answers), "inputs": inputs, "faults": faults, "slowest": round(answers.slowest, 4)}
    return {
        "ok": not result.faults,
        "inputs": sum(row["inputs"] for row in kinds.values()),
        "seed": seed,
        "peak_memory_mib": round(peak_memory()),
        "kinds": kinds,
        "faults": [
            {"kind": f.kind, "number": f.number, "what": f.what, "input": f.data.decode("latin-1")}
            for f in result.faults
        ],
    }


_FAULTS_SHOWN = 20
_TEXT = f"""An input is one of the package's own descriptions with one to four random changes: of bytes, words, numbers,
pieces, lines, or a hostile snippet (code, bombs, document types, endless numbers) put in. A fault is any exception but
the refusal, a warning, an input that takes longer than {SLOWEST:g} s or {MAX_MEMORY} MiB, or an accepted one that is
another after it was written and read again. Of the accepted files, one in {COMPILED} is also compiled, to the
interpreter, and its mass matrix evaluated. Meshes, recorded motions, samples of blocks, and the editor's documents with
their side files and parts are given to what reads them for the viewer and the editor; mutations are also of bits,
lengths and counts, and some inputs are no files: folders, pipes, devices, loops of links. Of the meshes that are read
some are drawn."""
_HEAD = "kind | inputs | refused | read | compiled or drawn | faults | slowest [ms] | its number"
_ROW = "{} | {inputs} | {refused} | {read} | {compiled} | {} | {:.0f} | {slowest_input}"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    kinds, faults = data["kinds"], data["faults"]
    rows = (
        _ROW.format(kind, verdict(row["faults"], not row["faults"]), 1e3 * row["slowest"], **row)
        for kind, row in kinds.items()
    )
    slowest = max(row["slowest"] for row in kinds.values())
    listed = tuple(f"{fault['kind']} no. {fault['number']}: `{fault['what']}`" for fault in faults[:_FAULTS_SHOWN])
    return Report(
        "Fuzz test of the readers",
        f"{counted(data['inputs'], 'hostile input')}: {len(faults)} crashed or hung a reader.",
        bool(data["ok"]),
        (_TEXT,),
        (Section("By kind of input", (Table.of(_HEAD, rows),)), Section("Faults", (Bullets(listed),))),
        facts=(
            Fact(str(sum(row["refused"] for row in kinds.values())), "refused with a description of their faults"),
            Fact(str(sum(row["read"] for row in kinds.values())), "read"),
            Fact(f"{slowest:.1f} s", f"the slowest, of at most {SLOWEST:g} s", slowest <= SLOWEST),
            Fact(f"{data['peak_memory_mib']} MiB", f"peak memory; seed {data.get('seed', 0)}"),
        ),
    )


TOPIC = Topic("fuzz", "Correctness", "Is every hostile file read, or refused in words?", compose, measure)
