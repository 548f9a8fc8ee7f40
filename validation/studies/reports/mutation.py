"""The score of the mutation test: planted faults, and how many of them the cross-check catches."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Annotated, Any

import typer

import reference_models
from validation.inputs.cases import standard_set
from validation.reporting.command import Run
from validation.reporting.numbers import counted
from validation.reporting.record import Bullets, Cell, Column, Data, Fact, Report, Section, Table, Topic
from validation.studies.mutation import MutationScore, mutate

# Models that an independent engine can represent whole, small and large, fixed and floating.
MODELS = tuple(
    "pendulum double_pendulum cart_pole open_chain_5r space_arm rx90 chain7 mss ur5 panda solo12 bolt".split()
)
PER_MODEL = 700
_FATES = ("planted", "caught", "silent", "too_small")
_COLUMNS: dict[str, Column] = {f"#{fate.replace('_', ' ')}": f"{{{fate}}}" for fate in _FATES}
_SURVIVED: dict[str, Column] = {"#survived": lambda row: Cell(str(len(row["survived"])), not row["survived"])}


def measure(
    run: Run,
    faults: Annotated[int, typer.Option(min=1, help="Faults a model, at most.")] = PER_MODEL,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the choice of faults and of the states.")] = 0,
) -> Data:
    """Plant single faults in generated programs; the cross-check must catch every one that matters."""
    cases = {case.label: case for case in standard_set()}
    scores = []
    run.expect(len(MODELS), "planting faults")
    for name in MODELS:
        system = cases[name].load().system if name in cases else reference_models.MODELS[name]
        scores.append(mutate(name, system, faults, seed))
        run.advance()
    return as_data(scores) | {"faults_per_model": faults, "seed": seed}


def as_data(scores: Sequence[MutationScore]) -> dict[str, Any]:
    """The scores as plain data."""
    rows = [
        {
            "model": score.model,
            "engine": score.engine,
            **{fate: getattr(score, fate).total() for fate in _FATES},
            "largest_too_small": score.largest_small,
            "survived": [{"kind": f.kind, "node": f.node, "error": error} for f, error in score.survivors],
        }
        for score in scores
    ]
    totals = {fate: sum((getattr(score, fate) for score in scores), Counter[str]()) for fate in _FATES}
    kinds = sorted({kind for total in totals.values() for kind in total})
    return {
        "ok": all(score.ok for score in scores),
        "planted": totals["planted"].total(),
        "models": rows,
        "kinds": {kind: {fate: total[kind] for fate, total in totals.items()} for kind in kinds},
    }


def compose(data: Data) -> Report:
    """The report of its JSON."""
    models = data["models"]
    survivors = [(row["model"], fault) for row in models for fault in row["survived"]]
    silent, small = (sum(row[fate] for row in models) for fate in ("silent", "too_small"))
    matter = data["planted"] - silent - small
    largest = max((row.get("largest_too_small", 0.0) for row in models), default=0.0)
    by_model = Table.of(models, {"model": "{model}", "reference": "{engine}"} | _COLUMNS | _SURVIVED)
    kinds = [{"kind": kind} | numbers for kind, numbers in data["kinds"].items()]
    by_kind = Table.of(kinds, {"kind of fault": "{kind}"} | _COLUMNS)
    text = (
        "A fault replaces one operation of the generated program. It is caught if any output then differs from the "
        "independent engine's by more than the cross-check's own tolerance over 60 random states. "
        f"{silent} are silent: the program with the fault computes the same outputs to 40 digits, so there is nothing "
        f"to catch. {small} are too small: they change no output by more than its tolerance (largest change "
        f"{largest:.1e}, which only forward dynamics tolerates)."
    )
    alive = Bullets(tuple(f"{model}: {f['kind']} at node {f['node']}: {f['error']:.1e}" for model, f in survivors[:99]))
    share = 100.0 * (matter - len(survivors)) / max(1, matter)
    return Report(
        "Mutation test of the cross-check",
        f"{matter - len(survivors)} of {matter} faults that matter are caught ({share:.6g} %), "
        f"in {counted(len(models), 'model')}.",
        bool(data["ok"]),
        (text,),
        (
            Section("By model", (by_model,)),
            Section("By kind of fault", (by_kind,)),
            *([Section("What survived", (alive,))] if survivors else []),
        ),
        facts=(
            Fact(str(data["planted"]), "single faults planted"),
            Fact(str(len(survivors)), "survived; none may", not survivors),
            Fact(str(silent + small), "change nothing, or less than a tolerance"),
        ),
    )


TOPIC = Topic("mutation", "Correctness", "Would the cross-check see a fault?", compose, measure)
