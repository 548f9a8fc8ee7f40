"""What each pass makes of a program, as text; the cases are in the files of the same names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from symofros.expr.numerics.evaluate import evaluate_edges, interpret
from symofros.expr.program import Program
from symofros.generator.passes import run_passes
from symofros.generator.passes.chain import chain_sums
from symofros.generator.passes.count import count_program
from symofros.generator.passes.stage import check_staged, hoist_parameters
from tests.program_text import Case, assert_golden, golden_cases, parse_program, program_text

PASSES: dict[str, Callable[[Program], Program]] = {
    "stage": hoist_parameters,
    "chain": chain_sums,
    "pipeline": run_passes,
}


@pytest.mark.parametrize("case", [case for name in PASSES for case in golden_cases(__file__, name)])
def test_programs_are_rewritten_as_stated(case: Case, request: pytest.FixtureRequest) -> None:
    assert_golden(case, lambda text: program_text(PASSES[case.path.stem](parse_program(text))), request)


@pytest.mark.parametrize("case", [case for name in PASSES for case in golden_cases(__file__, name)])
def test_rewritten_programs_have_the_same_values(case: Case) -> None:
    """At whole numbers, of which sums and products are exact; functions and quotients round in another order."""
    stated = parse_program(case.stated)
    rng = np.random.default_rng(4)
    given = {group: rng.integers(1, 9, (3, size)).astype(float) for group, size in stated.sizes.items()}
    expected = [interpret(stated, function, given, 3) for function in stated.functions]
    program = PASSES[case.path.stem](stated)
    pre = [np.broadcast_to(value, 3) for value in evaluate_edges(program, program.init, given, {})]
    given["pre"] = np.array(pre).reshape(len(pre), 3).T
    for function, values in zip(program.functions, expected, strict=True):
        for value, wanted in zip(interpret(program, function, given, 3), values, strict=True):
            np.testing.assert_allclose(value, wanted, rtol=1e-14)


@pytest.mark.parametrize("case", golden_cases(__file__, "chain"))
def test_chain_sums_add_no_operations(case: Case) -> None:
    stated = parse_program(case.stated)
    before, after = count_program(stated), count_program(chain_sums(stated))
    assert all(after[key].total <= operations.total for key, operations in before.items())


@pytest.mark.parametrize("case", [case for name in PASSES for case in golden_cases(__file__, name)])
def test_operations_are_counted_by_their_kinds(case: Case) -> None:
    """The counts of a program are those of the lines that its functions take one by one."""
    program = PASSES[case.path.stem](parse_program(case.stated))
    for function in program.functions:
        lines = program_text(replace(program, functions=(function,), init=())).splitlines()
        stated = " ".join(line.partition(" = ")[2] for line in lines)
        operations = count_program(program)[function.name, ""]
        signs = [stated.count(f" {sign} ") for sign in "*+-/"]
        assert (operations.mul, operations.add, operations.div) == (signs[0], signs[1] + signs[2], signs[3])
        assert operations.call == stated.count("(")


@pytest.mark.parametrize("case", golden_cases(__file__, "chain"))
def test_chain_sums_are_idempotent(case: Case) -> None:
    once = chain_sums(parse_program(case.stated))
    assert count_program(chain_sums(once)) == count_program(once)


def test_a_function_that_still_reads_a_parameter_is_refused() -> None:
    program = parse_program("f(q, par):\n  y: par[0]*q[0]")
    with pytest.raises(AssertionError, match="f reads par at node"):
        check_staged(program)
    check_staged(hoist_parameters(program))
