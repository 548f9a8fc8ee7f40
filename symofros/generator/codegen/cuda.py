"""Program -> CUDA C++: one kernel a function, one thread a state.

The text of a function is that of the C code by vectors (docs/theory/code.md), whose vectors have one lane here: arrays
are addressed by entry and step, so that threads of neighbouring states read neighbouring numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from string import Template

from symofros.base.c_text import comment
from symofros.base.names import function_symbols, identifier
from symofros.base.rotations import TINY
from symofros.expr.program import Function, Program
from symofros.generator.codegen import trigonometry
from symofros.generator.codegen.function import FunctionWriter
from symofros.generator.codegen.interpreted import InterpretedKernel
from symofros.generator.codegen.lanes import called_functions
from symofros.generator.codegen.model import legend, operations_text
from symofros.native import native_text
from symofros.runtime.calls.kernel import Precision, Signature
from symofros.runtime.cuda.device_code import BLOCK, DeviceCode, DeviceKernel
from symofros.runtime.record import ModelRecord, Segment

_REAL: dict[Precision, str] = {"double": "double", "single": "float"}
# A hand-written function of the device with the comment above it.
_FUNCTION = re.compile(
    r"(?:^/\*(?:(?!\*/).)*\*/\n)?^static __device__ [^;{}()]*\b(?P<name>sym_\w+)\([^;{}]*\) "
    r"\{(?:[^\n]*\}\n|\n.*?^\}\n)\n?",
    re.MULTILINE | re.DOTALL,
)
_STATIC = re.compile(r"^static ", re.MULTILINE)
_DECIMAL = re.compile(r"(?<![\w.])\d+(?:\.\d+(?:e[-+]?\d+)?|e[-+]?\d+)(?![\w.])")
# Methods that roll out, by their names in sf.simulate.
ROLLOUTS = {"rk4": "rk4", "semi_implicit_euler": "semi_implicit"}


def device_code(
    program: Program, record: ModelRecord, generator: str, precision: Precision, c_name: str | None = None
) -> DeviceCode:
    """The kernels of a program.

    Args:
        program: Staged program; functions that a solver finishes have no kernel.
        record: Names and sizes of the model.
        generator: Name and version of the generator.
        precision: Precision of the numbers.
        c_name: Prefix of symbols; made of the record's name by default.
    """
    name = c_name or identifier(record.name)
    functions = [function for function in program.functions if function.solver is None]
    signatures = [_signature(program, function) for function in functions]
    kernels = list(map(DeviceKernel, function_symbols(name, ((f.name, f.frame) for f in functions)), signatures))
    texts = [
        "\n".join(
            [
                *legend(record, function.summary or function.name, function.inputs, function.returns),
                _on_device(_function(program, function, kernel.symbol, precision)),
                _kernel(kernel),
            ]
        )
        for function, kernel in zip(functions, kernels, strict=True)
    ]
    routines = "\n".join([*_called(texts), trigonometry.on_device(precision)])
    head = Template(native_text("cuda/kernels.cu.in")).substitute(
        title=comment(record.name),
        precision=precision,
        generator=generator,
        hash=record.hash,
        operations=operations_text(program),
        block=BLOCK,
        real=_REAL[precision],
        routines=routines,
    )
    rollouts = {}
    if any(function.name == "forward_dynamics" for function in functions):
        texts.append(_on_device(_rollout(name, record, functions, precision)))
        rollouts = {method: f"{name}_rollout_{suffix}" for method, suffix in ROLLOUTS.items()}
    prepare = InterpretedKernel(program, program.functions[0]).prepare
    whole = _with_called_functions("\n\n".join([_on_device(head), *texts]))
    return DeviceCode(whole, precision, tuple(kernels), rollouts, prepare)


def _on_device(text: str) -> str:
    """C text as functions of the device; constants within functions stay as they are."""
    return _STATIC.sub("static __device__ ", text)


def _with_called_functions(text: str) -> str:
    """The text without functions that nothing calls, of which nvcc warns, unlike compilers of C of inline ones."""
    while True:
        unused = [match for match in _FUNCTION.finditer(text) if text.count(f"{match['name']}(") == 1]
        if not unused:
            return text
        for match in reversed(unused):
            text = text[: match.start()] + text[match.end() :]


def _called(texts: Iterable[str]) -> list[str]:
    """Functions of CUDA's library under the names that some texts call them by."""
    code = "\n".join(texts)
    arguments = {1: ("sym_v x", "x"), 2: ("sym_v x, sym_v y", "x, y")}
    return [
        f"static inline sym_v sym_v_{name}({arguments[arity][0]}) {{ return {function}({arguments[arity][1]}); }}"
        for name, function, arity in called_functions()
        if f"sym_v_{name}(" in code
    ]


def _signature(program: Program, function: Function) -> Signature:
    inputs = tuple((group, program.sizes[group]) for group in function.inputs)
    return Signature(function.name, function.frame, inputs, function.returns)


def _function(program: Program, function: Function, symbol: str, precision: Precision) -> str:
    writer = FunctionWriter(program, symbol, ["pre", *function.inputs], function.outputs)
    return writer.text_on_device(precision).code


def _kernel(kernel: DeviceKernel) -> str:
    """The kernel: the state of the thread, its place in each array, the call."""
    names = [name for name, _ in (*kernel.signature.inputs, *kernel.signature.outputs)]
    arguments = ", ".join(["long long n", "const sym_p *restrict pre", *(f"sym_strided {name}" for name in names)])
    places = ", ".join(["pre", *(f"sym_of(&{name}, state), {name}.step" for name in names)])
    return "\n".join(
        [
            f'extern "C" __global__ void __launch_bounds__(SYM_BLOCK) {kernel.symbol}({arguments}) {{',
            "    const ptrdiff_t state = sym_state();",
            f"    if (state < n) {kernel.symbol}_of_state({places});",
            "}",
        ]
    )


def _rollout(name: str, record: ModelRecord, functions: Sequence[Function], precision: Precision) -> str:
    """Kernels that step states by the forward dynamics among the functions."""
    forward = next(function for function in functions if function.name == "forward_dynamics")
    turning = any(segment.kind != "linear" for segment in record.segments)
    rotations = native_text("stepping/state/rotations.c").replace("double", "sym_number") if turning else ""
    if precision == "single":
        # A float has no 1e-300; its 1e-30 is lost beside any angle that sin(a)/a would notice.
        rotations = _DECIMAL.sub(r"\g<0>f", rotations.replace(repr(TINY), "1e-30"))
    return Template(native_text("cuda/rollout.cu.in")).substitute(
        name=name,
        nq=max(1, len(record.q_names)),
        nv=max(1, len(record.v_names)),
        rotations=rotations,
        retract="\n".join(map(_retracted, record.segments)),
        chart_rate="\n".join(map(_chart_rate, record.segments)),
        stage=_forward_arguments(forward, "stage_q", "stage_v"),
        present=_forward_arguments(forward, "q", "v"),
    )


def _forward_arguments(forward: Function, q: str, v: str) -> str:
    """Arguments of the forward dynamics of one thread, at arrays of that thread."""
    places = {"q": f"{q}, 1", "v": f"{v}, 1", "u": "u, u_step", "t": "&time, 1"}
    return ", ".join(["pre", *(places[group] for group in forward.inputs), "a, 1"])


def _retracted(segment: Segment) -> str:
    """A segment's part of q1 = q0 (+) theta, as in native/stepping/state/manifold.c."""
    q, v = segment.q, segment.v
    if segment.kind == "linear":
        return f"    for (i = 0; i < {segment.size}; ++i) q1[{q} + i] = q0[{q} + i] + theta[{v} + i];"
    return f"    sym_retract_{segment.kind}(q0 + {q}, theta + {v}, q1 + {q});"


def _chart_rate(segment: Segment) -> str:
    """A segment's part of the rate of theta."""
    v = segment.v
    if segment.kind == "linear":
        return f"    for (i = 0; i < {segment.size}; ++i) rate[{v} + i] = v[{v} + i];"
    return f"    sym_chart_rate_{segment.kind}(theta + {v}, v + {v}, rate + {v});"
