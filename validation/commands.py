"""The commands by name: where each is, and what it does in a line; none is imported before it is asked for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """One command.

    Attributes:
        module: Its module, from this package on; it has a TOPIC, or a function `register`.
        summary: First sentence of its help, for lists: to read it off the module would import every engine.
    """

    module: str
    summary: str


COMMANDS = {
    "check": Command("cross_check.report", "Compare our C of each MODEL with every engine that can represent it."),
    "oracle": Command(
        "studies.oracle",
        "Compare with SymPy's derivations by Kane's method, in extended precision.",
    ),
    "mutation": Command(
        "studies.mutation",
        "Plant single faults in generated programs; the cross-check must catch every one that matters.",
    ),
    "mutants": Command(
        "mutation.report",
        "Plant single faults in the source, Python and C: `check` or the tests must see each that changes a result.",
    ),
    "fuzz": Command(
        "studies.fuzz",
        "Feed mutated, hostile files and formulas to the readers: none may crash or hang them.",
    ),
    "adversary": Command(
        "adversary.report",
        "Search for scenes that we answer as good where an independent route says otherwise; write each as a test.",
    ),
    "engines": Command(
        "engines.report",
        "Hold engines against thirty digits of truth: every kind of joint, every function that they offer.",
    ),
    "faults": Command(
        "faults.command",
        "List real faults of public releases of engines, or reproduce some, each in an environment of its own.",
    ),
    "recall": Command(
        "recall.report",
        "Score the harness, or another test suite, by real faults of engines' releases: which does it see?",
    ),
    "diff": Command(
        "comparison.as_read",
        "Compare what an engine's own reader makes of a file with what ours does, as `symofros diff` compares files.",
    ),
    "accuracy": Command("accuracy.catalogue", "Measure beams against closed forms, tables and exact rods."),
    "diagrams": Command("diagrams.catalogue", "Run the paper's simulations from their block diagrams."),
    "stability": Command("stability.report", "Map where simulations fail, against closed forms and other engines."),
    "timing": Command(
        "timing.report",
        "Time generated C against Pinocchio's C++, MuJoCo's C, and C by CasADi and by SymPy.",
    ),
    "rollouts": Command("studies.rollouts", "Time thousands of motions of an arm, against mujoco.rollout."),
    "exports": Command(
        "studies.exports",
        "Time calls of an exported seven-joint arm: C, Python, MEX, FMU; and the worst case in C.",
    ),
    "environments": Command(
        "environments.report",
        "Check and time models in JAX, PyTorch, CasADi and WebAssembly, beside native C and beside peers.",
    ),
    "cuda": Command(
        "cuda.report",
        "Check and time kernels on a graphics processor, beside C and MuJoCo Warp; without one: registers and spills.",
    ),
    "pareto": Command(
        "pareto.report",
        "Compare speed at equal accuracy: our models and methods, and engines with their own integrators.",
    ),
    "studio": Command(
        "studies.studio",
        "Measure the studio in a browser: times to the first picture and of edits, frames, sizes, clicks of sessions.",
    ),
    "dashboard": Command("dashboard.command", "Gather the reports on one page."),
    "all": Command("dashboard.command", "Make every report that this machine can make of the code as it is: hours."),
    "render": Command(
        "dashboard.command",
        "Write the HTML and Markdown of reports anew from their JSON, without measuring anything.",
    ),
    "truth": Command(
        "truth_data.command",
        "Write models, states and right answers to thirty digits as Parquet and JSON, for engines in any language.",
    ),
    "campaign": Command("campaigns.command", "Long campaigns: checkpointed, resumable, over processes or a cluster."),
}

# Command that is gone -> what answers its question.
RETIRED = {
    "simulation": "'pareto'",
    "realtime": "`symofros simulate DIAGRAM --realtime --jitter FILE`, of your own diagram",
    "passes": "docs/theory/code.md, which says what each gained, and 'timing', which races what they make",
}

# Package, by the name that it is imported under -> the extra that brings it, of those that `validation` does not.
EXTRAS = {"dask": "campaign", "distributed": "campaign", "pyarrow": "parquet", "pytest": "test"}
