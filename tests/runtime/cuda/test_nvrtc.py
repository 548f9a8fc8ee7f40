"""Kernels compile for two architectures, within known registers; no graphics processor takes part."""

from __future__ import annotations

from functools import cache

import pytest

from symofros.base.options import Options
from symofros.compiler import GENERATOR, Compilation
from symofros.errors import CompileError
from symofros.generator.codegen.cuda import device_code
from symofros.runtime.calls.kernel import Precision
from symofros.runtime.cuda.device_code import DeviceCode
from symofros.runtime.cuda.nvrtc import compile_cuda, usage_of
from tests.exports.cases import system_of
from tests.late import require
from tests.models import system

require("nvidia.cuda_nvrtc", "cuda")

ARCHITECTURES = ("sm_80", "sm_90")
# Most registers and bytes of spills (stores + loads) a kernel, with room for what versions of NVRTC differ by: that of
# 12.4 keeps some numbers of a rollout in memory across the call of the forward dynamics.
MOST: dict[tuple[str, Precision], dict[str, tuple[int, int]]] = {
    ("double_pendulum", "double"): {
        "dynamics": (64, 0),
        "forward_dynamics": (64, 0),
        "rollout_rk4": (128, 32),
        "rollout_semi_implicit": (128, 32),
    },
    ("double_pendulum", "single"): {
        "dynamics": (48, 0),
        "forward_dynamics": (48, 0),
        "rollout_rk4": (96, 0),
        "rollout_semi_implicit": (96, 0),
    },
    ("panda", "double"): {"dynamics": (255, 0)},
    ("panda", "single"): {"dynamics": (128, 0)},
}


@cache
def code(name: str, precision: Precision) -> DeviceCode:
    functions = ("dynamics", "forward_dynamics") if name == "double_pendulum" else ("dynamics",)
    made = Compilation(system(name) if name == "double_pendulum" else system_of(name), Options(functions))
    return device_code(made.program, made.record, GENERATOR, precision)


@pytest.mark.parametrize("architecture", ARCHITECTURES)
@pytest.mark.parametrize(("name", "precision"), MOST)
def test_registers_and_spills_match_the_table(name: str, precision: Precision, architecture: str) -> None:
    """Spills are zero where the table says so: such a kernel moves nothing but its arrays."""
    usage = usage_of(code(name, precision).text, architecture)
    assert set(usage) == {f"{name}_{kernel}" for kernel in MOST[name, precision]}
    for kernel, (registers, spills) in MOST[name, precision].items():
        taken = usage[f"{name}_{kernel}"]
        assert 0 < taken.registers <= registers, (kernel, taken)
        assert taken.spill_stores + taken.spill_loads <= spills, (kernel, taken)


def test_invalid_cuda_text_is_refused_with_the_compiler_message() -> None:
    with pytest.raises(CompileError, match='identifier "nothing" is undefined'):
        compile_cuda('extern "C" __global__ void k(int *x) { *x = nothing; }', "sm_90")


@pytest.mark.parametrize("architecture", ["sm_", "90", "sm_90 -lineinfo"])
def test_architectures_are_names_of_compute_capabilities(architecture: str) -> None:
    with pytest.raises(CompileError, match="no architecture"):
        compile_cuda("", architecture)


def test_fused_products_are_taken_only_when_asked_for() -> None:
    """Else the kernels round as the C code does."""
    text = 'extern "C" __global__ void k(double *x) { *x = x[1] * x[2] + x[3]; }'
    assert compile_cuda(text, "sm_90", contract=True) != compile_cuda(text, "sm_90")
