"""The score of the mutation test: planted faults, and how many of them the cross-check catches."""

from __future__ import annotations

from validation.reporting.numbers import counted
from validation.reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic
from validation.studies.mutation import measure

_COLUMNS = "#planted; #caught; #silent; #too small = {too_small}"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    models = [{"alive": len(row["survived"]), **row} for row in data["models"]]
    alive = [(row["model"], fault) for row in models for fault in row["survived"]]
    silent, small = (sum(row[fate] for row in models) for fate in ("silent", "too_small"))
    matter = data["planted"] - silent - small
    caught = matter - len(alive)
    kinds = [{"kind": kind} | numbers for kind, numbers in data["kinds"].items()]
    text = (
        "A fault replaces one operation of the generated program. It is caught if any output then differs from the "
        "independent engine's by more than the cross-check's own tolerance over 60 random states. "
        f"{silent} are silent: the program with the fault computes the same outputs to 40 digits, so there is nothing "
        f"to catch. {small} are too small: they change no output by more than its tolerance (largest change "
        f"{max((row.get('largest_too_small', 0.0) for row in models), default=0.0):.1e}, which only forward dynamics "
        "tolerates)."
    )
    listed = tuple(f"{model}: {f['kind']} at node {f['node']}: {f['error']:.1e}" for model, f in alive[:99])
    by_model = Table.of(models, f"model; reference = {{engine}}; {_COLUMNS}; #survived = {{alive}} ? no alive")
    return Report(
        "Mutation test of the cross-check",
        f"{caught} of {matter} faults that matter are caught ({100.0 * caught / max(1, matter):.6g} %), "
        f"in {counted(len(models), 'model')}.",
        bool(data["ok"]),
        (text,),
        (
            Section("By model", (by_model,)),
            Section("By kind of fault", (Table.of(kinds, f"kind of fault = {{kind}}; {_COLUMNS}"),)),
            Section("What survived", (Bullets(listed),)),
        ),
        facts=(
            Fact(str(data["planted"]), "single faults planted"),
            Fact(str(len(alive)), "survived; none may", not alive),
            Fact(str(silent + small), "change nothing, or less than a tolerance"),
        ),
    )


TOPIC = Topic("mutation", "Correctness", "Would the cross-check see a fault?", compose, measure)
