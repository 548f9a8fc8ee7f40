"""The other back end: a Program that is interpreted instead of compiled."""

from __future__ import annotations

import numpy as np

from symofros.expr.evaluate import evaluate_edges, interpret
from symofros.expr.program import Function, Program
from symofros.runtime.constrained import constrained
from symofros.runtime.kernel import Array, Kernel, Signature


class InterpretedUnit:
    """The functions of a program, by NumPy."""

    def __init__(self, program: Program) -> None:
        self.kernels: dict[tuple[str, str], Kernel] = {
            (function.name, function.frame): InterpretedKernel(program, function) for function in program.functions
        }


class InterpretedKernel:
    """One function of a program."""

    def __init__(self, program: Program, function: Function) -> None:
        self._program = program
        self._function = function
        self.signature = Signature(
            function.name,
            function.frame,
            tuple((name, program.sizes[name]) for name in function.inputs),
            function.returns,
        )

    def prepare(self, par: Array) -> Array:
        """The parameter-only part of the work."""
        pre = np.empty((len(par), len(self._program.init)))
        for i, column in enumerate(evaluate_edges(self._program, self._program.init, {"par": par}, {})):
            pre[:, i] = column
        return pre

    def run(self, n: int, pre: Array, inputs: list[Array]) -> list[Array]:
        """Evaluate n states."""
        named = dict(zip(self._function.inputs, inputs, strict=True)) | {"pre": pre}
        outputs = interpret(self._program, self._function, named, n)
        return constrained(*outputs) if self._function.solve else outputs
