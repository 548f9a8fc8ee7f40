"""C that judges run-time parameters by the conditions of the description."""

from __future__ import annotations

from symofros.description.system import System
from symofros.exports.c.c_text import strings
from symofros.expr.ops import OPS
from symofros.generator.codegen.names import c_string
from symofros.mechanics.topology.conditions import Condition
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.run_time import RunTimeCheck

_C = {"sub": "{0} - {1}", "neg": "-{0}"}
_HOLDS = {"positive": " && {0} > 0.0", "not negative": " && {0} >= 0.0", "any": ""}


def parameter_check_text(system: System, names: tuple[str, ...]) -> list[str]:
    """Lines of C: `sym_fmu_violated`, the number of the first condition that does not hold, and what each asks for.

    Checks without a margin (rotations, axes and smooth sections that depend on parameters) are not among them.

    Args:
        system: A sound system.
        names: Run-time parameters, in the order of their values.
    """
    conditions = RunTimeCheck(system, names).conditions
    known = {name: f"par[{i}]" for i, name in enumerate(names)}
    fixed = {name: value for name, value in system.parameter_values().items() if name not in known}
    lines = ["static int sym_fmu_violated(const double *par) { /* -1: all conditions hold */"]
    places: list[str] = []
    for step in conditions.formulas.steps:
        if isinstance(step, tuple):
            kind, operands = step
            places.append(f"e{len(places)}")
            text = _C.get(kind, OPS[kind].c if kind in OPS else "")
            lines.append(f"    const double {places[-1]} = {text.format(*(places[i] for i in operands))};")
        else:
            number = fixed.get(step, 0.0) if isinstance(step, str) else step
            places.append(known[step] if isinstance(step, str) and step in known else f"({number!r})")
    results = iter(conditions.formulas.results)
    for i, condition in enumerate(conditions.conditions):
        margins = [places[next(results)] for _ in condition.margins]
        holds = " && ".join(f"isfinite({x}){_HOLDS[condition.sign].format(x)}" for x in margins)
        lines.append(f"    if (!({holds})) return {i};")
    numbers = Numbers(system)
    says = [c_string(_rule(condition, numbers)) for condition in conditions.conditions]
    return [
        *lines,
        "    (void)par;",
        "    return -1;",
        "}",
        f"static const char *const sym_fmu_conditions[] = {{{', '.join(says) or strings([])}}};",
    ]


def _rule(condition: Condition, numbers: Numbers) -> str:
    """What a condition asks for, of which object; where it holds, its problem has numbers that mean nothing."""
    problem = condition.problem(numbers)
    return f"run-time parameters: {problem.what.partition(': ')[0]}: {problem.rule}"
