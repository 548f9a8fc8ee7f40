"""What became of a hundred thousand hostile inputs."""

from __future__ import annotations

from ...reporting.numbers import counted
from ...reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from ..fuzz import COMPILED, MAX_MEMORY, SLOWEST, measure

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
