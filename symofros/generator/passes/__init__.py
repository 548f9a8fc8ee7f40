"""Program -> Program: small, named, verified after each."""

from __future__ import annotations

from collections.abc import Callable

from symofros.expr.program import Program
from symofros.generator.passes.chain import chain_sums, check_packs
from symofros.generator.passes.stage import check_staged, hoist_parameters

# In order: the pass, and the check of its post-condition.
PIPELINE: tuple[tuple[Callable[[Program], Program], Callable[[Program], None]], ...] = (
    (hoist_parameters, check_staged),
    (chain_sums, check_packs),
)


def run_passes(program: Program) -> Program:
    """Apply the pipeline, verifying each pass's post-condition."""
    for apply, verify in PIPELINE:
        program = apply(program)
        verify(program)
    return program
