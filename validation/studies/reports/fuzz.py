"""What became of a hundred thousand hostile inputs."""

from __future__ import annotations

import resource
import sys
from dataclasses import asdict
from typing import Annotated

import typer

from validation.reporting.command import Run
from validation.reporting.numbers import counted
from validation.reporting.record import Bullets, Cell, Column, Data, Fact, Report, Section, Table, Topic
from validation.studies.fuzz import COMPILED, SLOWEST, fuzz

INPUTS = 120_000
_FAULTS_SHOWN = 20
_TEXT = (
    "An input is one of the package's own descriptions with one to four random changes: of bytes, words, numbers, "
    "pieces, lines, or a hostile snippet (code, bombs, document types, endless numbers) put in. A fault is any "
    f"exception but the refusal, a warning, an input that takes longer than {SLOWEST:g} s, or an accepted input that "
    f"is another one after it was written and read again. Of the accepted files, one in {COMPILED} is also compiled, "
    "to the interpreter, and its mass matrix evaluated."
)
_COLUMNS: dict[str, Column] = {
    "kind": "{kind}",
    "#inputs": "{inputs}",
    "#refused": "{refused}",
    "#read": "{read}",
    "#compiled": "{compiled}",
    "#faults": lambda row: Cell(str(row["faults"]), not row["faults"]),
    "#slowest [ms]": "{slowest:1e3*.0f}",
    "#its number": "{slowest_input}",
}


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
    # Linux counts kilobytes, macOS bytes.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << (20 if sys.platform == "darwin" else 10))
    return {
        "ok": not result.faults,
        "inputs": sum(row["inputs"] for row in kinds.values()),
        "seed": seed,
        "peak_memory_mib": round(peak),
        "kinds": kinds,
        "faults": [
            {"kind": f.kind, "number": f.number, "what": f.what, "input": f.data.decode("latin-1")}
            for f in result.faults
        ],
    }


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, faults = [{"kind": kind, **row} for kind, row in data["kinds"].items()], data["faults"]
    slowest = max(row["slowest"] for row in rows)
    read, refused = (sum(row[answer] for row in rows) for answer in ("read", "refused"))
    listed = Bullets(tuple(f"{f['kind']} no. {f['number']}: `{f['what']}`" for f in faults[:_FAULTS_SHOWN]))
    return Report(
        "Fuzz test of the readers",
        f"{counted(data['inputs'], 'hostile input')}: {len(faults)} crashed or hung a reader.",
        bool(data["ok"]),
        (_TEXT,),
        (
            Section("By kind of input", (Table.of(rows, _COLUMNS),)),
            *([Section("Faults", (listed,))] if faults else []),
        ),
        facts=(
            Fact(str(refused), "refused with a description of their faults"),
            Fact(str(read), "read"),
            Fact(f"{slowest:.1f} s", f"the slowest, of at most {SLOWEST:g} s", slowest <= SLOWEST),
            Fact(f"{data['peak_memory_mib']} MiB", f"peak memory; seed {data.get('seed', 0)}"),
        ),
    )


TOPIC = Topic("fuzz", "Correctness", "Is every hostile file read, or refused in words?", compose, measure)
