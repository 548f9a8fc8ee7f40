"""C of CasADi's functions, and what it counts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca


def operations(function: Any) -> Mapping[str, int]:
    """How many operations of each kind one evaluation of a CasADi function takes."""
    kinds = {
        ca.OP_ADD: "add",
        ca.OP_SUB: "add",
        ca.OP_TWICE: "add",
        ca.OP_MUL: "mul",
        ca.OP_SQ: "mul",
        ca.OP_DIV: "div",
        ca.OP_INV: "div",
        ca.OP_SIN: "call",
        ca.OP_COS: "call",
    }
    counts = dict.fromkeys(("mul", "add", "div", "call"), 0)
    for k in range(function.n_instructions()):
        kind = kinds.get(function.instruction_id(k))
        if kind is not None:
            counts[kind] += 1
    return counts


def c_text(function: Any) -> str:
    """CasADi's C of a function."""
    generator = ca.CodeGenerator(f"{function.name()}.c", {"with_header": False})
    generator.add(function)
    return str(generator.dump())


def work_sizes(function: Any) -> tuple[int, int]:
    """Sizes of the integer and double work arrays that the function's C code needs."""
    return int(function.sz_iw()), int(function.sz_w())
