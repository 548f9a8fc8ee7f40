"""Program -> Program: small, named, verified after each."""

from __future__ import annotations

from collections.abc import Callable

from symofros.expr.packs.check import check_packs
from symofros.expr.program import Program
from symofros.generator.passes.chain import chain_sums
from symofros.generator.passes.stage import check_parameters_unread, check_staged, hoist_parameters

# In order: a pass, and the check of its post-condition. Packs are verified besides, where a pass changed the graph. In
# chains terms cancel that were apart, which leaves further values to parameters alone.
PIPELINE: tuple[tuple[Callable[[Program], Program], Callable[[Program], None]], ...] = (
    (hoist_parameters, check_staged),
    (chain_sums, check_parameters_unread),
    (hoist_parameters, check_staged),
)


def run_passes(program: Program) -> Program:
    """Apply the pipeline; after each pass, verify its post-condition, and the packs of a graph that it changed."""
    verified = None
    for apply, check in PIPELINE:
        program = apply(program)
        check(program)
        graph = program.graph
        found = graph.op.copy(), graph.args.copy(), graph.value.copy(), graph.packs.copy()
        if found != verified:
            check_packs(program)
        verified = found
    return program
