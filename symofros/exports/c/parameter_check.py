"""C that judges run-time parameters by the conditions of the description."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from symofros.base.c_text import c_string
from symofros.description import System
from symofros.expr import OPS
from symofros.mechanics.topology import Condition, Numbers, RunTimeCheck

_C = {"sub": "{0} - {1}", "neg": "-{0}"}
_HOLDS = {"positive": " && {0} > 0.0", "not negative": " && {0} >= 0.0", "any": ""}


class Judged(NamedTuple):
    """A description whose run-time parameters are judged.

    Attributes:
        system: A sound system.
        names: Run-time parameters, in the order of their values.
        places: Their indices among all parameters in C; None: the same.
    """

    system: System
    names: tuple[str, ...]
    places: tuple[int, ...] | None = None


def parameter_check_text(name: str, judged: Sequence[Judged]) -> list[str]:
    """Lines of C: `NAME_violated`, the number of the first condition that does not hold, and what each asks for.

    Checks without a margin (rotations, axes and smooth sections that depend on parameters) are not among them.

    Args:
        name: Prefix of the names in C.
        judged: Descriptions.
    """
    lines = [f"static int32_t {name}_violated(const double *par) {{ /* -1: all conditions hold */"]
    says: list[str] = []
    for one in judged:
        if one.names:
            text, rules = _conditions_text(one, len(says))
            lines += ["    {", *text, "    }"]
            says += rules
    return [
        *lines,
        "    (void)par;",
        "    return -1;",
        "}",
        f"static const char *const {name}_conditions[] = {{{', '.join(says) or 'NULL'}}};",
    ]


def _conditions_text(judged: Judged, offset: int) -> tuple[list[str], list[str]]:
    """Lines that judge one description, whose conditions are numbered from an offset on, and what each asks for."""
    system, names, places_in_c = judged
    conditions = RunTimeCheck(system, names).conditions
    known = {name: f"par[{i}]" for name, i in zip(names, places_in_c or range(len(names)), strict=True)}
    fixed = {name: value for name, value in system.parameter_values().items() if name not in known}
    lines = [f"    if (!isfinite({place})) return {offset};" for place in known.values()]
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
    for i, condition in enumerate(conditions.conditions, offset + 1):
        margins = [places[next(results)] for _ in condition.margins]
        holds = " && ".join(f"isfinite({x}){_HOLDS[condition.sign].format(x)}" for x in margins)
        lines.append(f"    if (!({holds})) return {i};")
    numbers = Numbers(system)
    rules = ["run-time parameters: a parameter is one finite number"]
    rules += [_rule(condition, numbers) for condition in conditions.conditions]
    return lines, [c_string(rule) for rule in rules]


def _rule(condition: Condition, numbers: Numbers) -> str:
    """Object and rule of a condition, without the values found, which are meaningless where the condition holds."""
    problem = condition.problem(numbers)
    return f"run-time parameters: {problem.what.partition(': ')[0]}: {problem.rule}"
