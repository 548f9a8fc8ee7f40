"""Tables of docs/environments.md: `python -m docs.site_extensions.environments` writes them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from symofros.base.functions import FUNCTIONS, exported
from symofros.base.model_function import ModelFunction
from symofros.exports.cuda.cuda_package import FUNCTIONS as CUDA
from symofros.exports.exporting import REACTIONS
from symofros.exports.wasm import wasm
from symofros.interop.rules import RULES

PAGE = Path(__file__).parents[1] / "environments.md"
_MARKS = "<!-- environments: begin -->", "<!-- environments: end -->"


class Environment(NamedTuple):
    """Where a model runs.

    Attributes:
        name: Name, the head of its column.
        made_by: What makes it.
        functions: Functions that it has.
        derivatives: Derivatives that it offers.
        tests: Files that hold it to the native numbers.
    """

    name: str
    made_by: str
    functions: frozenset[str]
    derivatives: str
    tests: tuple[str, ...]


def environments() -> tuple[Environment, ...]:
    """All of them, in the order of the columns."""
    differentiated = frozenset(RULES)
    return (
        Environment(
            "Python",
            "`sf.compile(system)`",
            frozenset(FUNCTIONS),
            "exact, of first and second order; `model.vjp`; `sf.rollout`",
            ("tests/runtime", "tests/identities", "tests/mechanics/dynamics/derivatives"),
        ),
        Environment(
            "C, C++",
            '`sf.export(system, "c", folder)`; `mex`, `sfunction`, `fmu2`, `fmu3` wrap it, without reactions',
            frozenset((*exported(constrained=True), *REACTIONS)),
            "exact, by the functions below",
            ("tests/exports/c", "tests/exports/fmi"),
        ),
        Environment(
            "WebAssembly",
            '`sf.export(system, "wasm", folder)`, those below, and others by `functions=`',
            frozenset(wasm.functions(constrained=True)),
            "exact, by `functions=`",
            ("tests/exports/wasm/test_wasm.py",),
        ),
        Environment(
            "CUDA",
            '`model.cuda()`, any function that needs no solver; `sf.export(system, "cuda", folder)`, those below',
            frozenset(CUDA),
            "exact, by the functions below",
            ("tests/runtime/cuda", "tests/exports/cuda/test_cuda_package.py"),
        ),
        Environment(
            "JAX",
            "`sf.interop.jax`",
            differentiated,
            "exact JVP and VJP, of first order",
            ("tests/interop/test_jax.py",),
        ),
        Environment(
            "PyTorch",
            "`sf.interop.torch`",
            differentiated,
            "exact, of first order",
            ("tests/interop/test_torch.py",),
        ),
        Environment(
            "CasADi",
            "`sf.interop.casadi`; of acados, `write_acados_library`",
            differentiated | {"frame_pose"},
            "exact Jacobians and Hessians with their sparsity; of frames the position",
            ("tests/interop/test_casadi.py", "tests/interop/test_acados.py"),
        ),
    )


def tables() -> str:
    """Both tables as Markdown."""
    columns = environments()
    first = ["| environment | made by | derivatives | tests |", "|---|---|---|---|"]
    for one in columns:
        tests = ", ".join(f"`{test}`" for test in one.tests)
        first.append(f"| {one.name} | {one.made_by} | {one.derivatives} | {tests} |")
    second = [
        "| function | " + " | ".join(one.name for one in columns) + " | its derivatives |",
        "|---|" + "---|" * (len(columns) + 1),
    ]
    for row in FUNCTIONS.values():
        if not row.transposes:
            marks = " | ".join("x" if row.name in one.functions else "" for one in columns)
            second.append(f"| `{row.name}` | {marks} | {_derivatives(row)} |")
    return "\n".join([*first, "", *second])


def _derivatives(row: ModelFunction) -> str:
    """Functions that give the derivatives of one, by their names."""
    longer = {other for other in FUNCTIONS if other.startswith(f"{row.name}_") and other != row.name}
    named = [name for name in FUNCTIONS if name in longer and _is_derivative(name, row.name)]
    return ", ".join(f"`{name}`" for name in named)


def _is_derivative(name: str, of: str) -> bool:
    words = ("derivatives", "derivative", "by_par", "second_derivatives", "hvp", "hessian", "vjp", "jvp")
    return name.removeprefix(f"{of}_") in words


def rendered(page: str) -> str:
    """A page with the tables in their place."""
    begin, end = _MARKS
    before, _, rest = page.partition(begin)
    _, _, after = rest.partition(end)
    return f"{before}{begin}\n{tables()}\n{end}{after}"


if __name__ == "__main__":
    PAGE.write_text(rendered(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
