"""Hostile files: mutated descriptions by the hundred thousand; none may crash the reader, hang it, or run anything.

A reader's answer to any bytes is a System or a DescriptionError, within a bounded time.
"""

from __future__ import annotations

import random
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track

import reference_models
import symofros as sf
from symofros.description.parser import ExpressionError, parse

INPUTS = 100_000
# A reader that takes longer on a file of some kilobytes has been made to hang.
SLOWEST = 5.0

_FORMULAS = (
    b"L1/2 + 0.1*cos(q1)", b"-k*(q1 - 0.3)^2", b"atan2(u1, max(a, b))/pi", b"2^-x*exp(-(v/0.01)^2)",
    b"m*(L^2/12 + r^2/4)",
)  # fmt: skip
_SNIPPETS = (
    "__import__('os').system('x')", "().__class__", "9**9**9", "!!python/object:os.system", "&a", "*a", "<<: *a", "---",
    "\t", "\x00", "{", "}", "[", "]", ":", "'", '"', "- ", "? ", "| ", "> ", "#", "%", "@", "`", "nan", ".inf", "-.inf",
    "1e400", "1e-400", "0x7fffffff", "null", "true", "include: [../../etc/passwd]", "int", "while", "größe", "\u202e",
    "a" * 500, "(" * 200, "kind: free", "parent: link", "symofros: 2", "q1", "dq1", "t", "pi", "sin(", "^",
    "\ufeff", "\r",
)  # fmt: skip


@dataclass
class FuzzResult:
    """What became of the inputs.

    Attributes:
        answers: Inputs by how they were answered: "read", "refused", "formula read", "formula refused".
        faults: Inputs that crashed the reader or took too long, with what happened.
        slowest: Longest time one input took [s].
    """

    answers: Counter[str] = field(default_factory=Counter)
    faults: list[tuple[str, bytes]] = field(default_factory=list)
    slowest: float = 0.0


def corpus() -> list[bytes]:
    """The files that mutations start from: the reference models."""
    folder = Path(reference_models.__file__).parent
    return [path.read_bytes() for path in sorted(folder.rglob("*.yaml"))]


def mutated(seed: int, files: list[bytes]) -> Iterator[bytes]:
    """Endless mutations: bytes changed, cut, repeated, lines shuffled, hostile snippets put in."""
    rng = random.Random(seed)
    while True:
        data = bytearray(rng.choice(files))
        for _ in range(rng.randint(1, 4)):
            at, kind = rng.randrange(len(data) + 1), rng.randrange(5)
            if kind == 0 and data:
                data[at % len(data)] = rng.randrange(256)
            elif kind == 1:
                del data[at : at + rng.randint(1, 40)]
            elif kind == 2:
                data[at:at] = rng.choice(_SNIPPETS).encode()
            elif kind == 3:
                data[at:at] = data[at : at + rng.randint(1, 60)] * rng.randint(1, 4)
            else:
                lines = bytes(data).split(b"\n")
                rng.shuffle(lines)
                data = bytearray(b"\n".join(lines))
        yield bytes(data)


def fuzz(count: int, seed: int) -> FuzzResult:
    """Feed mutated files to the reader, and pieces of them to the formula parser."""
    result = FuzzResult()
    files, formulas = mutated(seed, corpus()), mutated(seed + 1, list(_FORMULAS))
    console = Console(stderr=True)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hostile.yaml"
        for i in track(range(count), "feeding", console=console, transient=True, disable=not console.is_terminal):
            data = next(formulas if i % 10 else files)
            start = time.perf_counter()
            try:
                # Formulas are quicker to read than files: nine pieces of text for each file.
                answer = _formula(data) if i % 10 else _file(path, data)
            except Exception as error:  # noqa: BLE001 - anything else than a refusal is what is looked for.
                result.faults.append((f"{type(error).__name__}: {error}"[:200], data))
                continue
            taken = time.perf_counter() - start
            result.answers[answer] += 1
            result.slowest = max(result.slowest, taken)
            if taken > SLOWEST:
                result.faults.append((f"took {taken:.1f} s", data))
    return result


def _file(path: Path, data: bytes) -> str:
    path.write_bytes(data)
    try:
        sf.load(path)
    except sf.DescriptionError:
        return "file refused"
    return "file read"


def _formula(data: bytes) -> str:
    try:
        parse(data.decode("utf-8", "replace")[:2000])
    except ExpressionError:
        return "formula refused"
    return "formula read"


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("fuzz")(command)


def command(
    count: Annotated[int, typer.Option(min=1, help="Inputs.")] = INPUTS,
    seed: Annotated[int, typer.Option(min=0, help="Of the mutations.")] = 0,
) -> None:
    """Feed mutated, hostile files to the readers: none may crash or hang them."""
    start = time.perf_counter()
    result = fuzz(count, seed)
    answers = ", ".join(f"{number} {name}" for name, number in sorted(result.answers.items()))
    typer.echo(f"{count} inputs in {time.perf_counter() - start:.0f} s: {answers}; slowest {result.slowest:.2f} s.")
    for what, data in result.faults[:20]:
        typer.echo(f"fault: {what}\n  input: {data[:200]!r}")
    typer.echo(f"{len(result.faults)} crashes or hangs.")
    raise typer.Exit(1 if result.faults else 0)
