"""What became of a hundred thousand hostile inputs."""

from __future__ import annotations

from validation.reporting.numbers import counted
from validation.reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic
from validation.studies.fuzz import COMPILED, SLOWEST, measure

_FAULTS_SHOWN = 20
_TEXT = (
    "An input is one of the package's own descriptions with one to four random changes: of bytes, words, numbers, "
    "pieces, lines, or a hostile snippet (code, bombs, document types, endless numbers) put in. A fault is any "
    f"exception but the refusal, a warning, an input that takes longer than {SLOWEST:g} s, or an accepted input that "
    f"is another one after it was written and read again. Of the accepted files, one in {COMPILED} is also compiled, "
    "to the interpreter, and its mass matrix evaluated."
)
_COLUMNS = """kind; #inputs; #refused; #read; #compiled; #faults ? no faults; #slowest [ms] = {slowest:1e3*.0f};
    #its number = {slowest_input}"""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, faults = [{"kind": kind, **row} for kind, row in data["kinds"].items()], data["faults"]
    slowest = max(row["slowest"] for row in rows)
    listed = tuple(f"{fault['kind']} no. {fault['number']}: `{fault['what']}`" for fault in faults[:_FAULTS_SHOWN])
    return Report(
        "Fuzz test of the readers",
        f"{counted(data['inputs'], 'hostile input')}: {len(faults)} crashed or hung a reader.",
        bool(data["ok"]),
        (_TEXT,),
        (Section("By kind of input", (Table.of(rows, _COLUMNS),)), Section("Faults", (Bullets(listed),))),
        facts=(
            Fact(str(sum(row["refused"] for row in rows)), "refused with a description of their faults"),
            Fact(str(sum(row["read"] for row in rows)), "read"),
            Fact(f"{slowest:.1f} s", f"the slowest, of at most {SLOWEST:g} s", slowest <= SLOWEST),
            Fact(f"{data['peak_memory_mib']} MiB", f"peak memory; seed {data.get('seed', 0)}"),
        ),
    )


TOPIC = Topic("fuzz", "Correctness", "Is every hostile file read, or refused in words?", compose, measure)
