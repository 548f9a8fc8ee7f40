"""The CUDA package: its example compares kernels with C, its text compiles, its table is that of the kernels."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import symofros as sf
from reference_models import MODELS
from tests.cuda_on_host import PLAIN, SHIM, WARNINGS
from tests.exports.cases import STRICT, run
from tests.late import needs_program, require
from tests.models import system

HERE = Path(__file__).parent
# The launcher of the example, as loops over threads.
LAUNCHER = """
extern "C" int double_pendulum_dynamics_launch(void *, long long n, const double *pre, sym_strided q, sym_strided v,
                                               sym_strided u, sym_strided t, sym_strided M, sym_strided h,
                                               sym_strided Q) {
    const unsigned block = SYM_BLOCK, grid = (unsigned)((n + block - 1) / block);
    SYM_THREADS(double_pendulum_dynamics(n, pre, q, v, u, t, M, h, Q));
    return 0;
}
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sf.export(system("double_pendulum"), "cuda", tmp_path_factory.mktemp("package") / "gpu").folder


def test_the_cuda_example_reproduces_the_c_results(package: Path, tmp_path: Path) -> None:
    """Run with kernels as loops; the launcher that is tested so is declared as in the header."""
    kernels = tmp_path / "kernels.cpp"
    kernels.write_text(f'#include "{SHIM}"\n{PLAIN}\n#include "{package}/double_pendulum_double.cu"\n{LAUNCHER}')
    run("gcc", *STRICT, "-O0", "-c", "double_pendulum.c", "-o", tmp_path / "model.o", cwd=package)
    flags = ("-std=c++17", "-O0", "-ffp-contract=off", *WARNINGS)
    sources = ("-x", "c++", package / "main.cu", kernels, "-x", "none", tmp_path / "model.o")
    run("g++", *flags, f"-I{package}", f"-I{HERE}", *sources, "-lm", "-o", tmp_path / "example", cwd=tmp_path)
    output = run(tmp_path / "example", "1000", cwd=tmp_path)
    assert re.match(r"1000 states in 1 ms: 1e\+06 states/s, 0\.\d+ GB/s; against C at most 0\n", output), output


@pytest.mark.tools
@pytest.mark.parametrize("name", ["double_pendulum", "four_bar", "heavy_top", "cart_pole"])
def test_nvcc_compiles_without_warnings(name: str, tmp_path: Path) -> None:
    """Where it is installed; CI's machines need no driver for that."""
    needs_program("nvcc")
    folder = sf.export(MODELS[name], "cuda", tmp_path / name).folder
    for source in sorted(folder.glob("*.cu")):
        run(
            "nvcc",
            "-c",
            "-Werror",
            "all-warnings",
            "-Xcompiler",
            "-Wall,-Wextra",
            source,
            "-o",
            "/dev/null",
            cwd=folder,
        )


def test_files_compile_without_any_header(package: Path) -> None:
    require("nvidia.cuda_nvrtc", "cuda")
    from symofros.runtime.cuda.nvrtc import usage_of

    usage = usage_of((package / "double_pendulum_single.cu").read_text(), "sm_90")
    assert {"double_pendulum_single_dynamics", "double_pendulum_single_rollout_rk4"} <= set(usage)
    assert all(taken.spill_stores == 0 for taken in usage.values())


def test_the_table_states_the_order_of_the_arguments(package: Path) -> None:
    text, header = (package / "README.md").read_text(), (package / "double_pendulum_cuda.h").read_text()
    rows = re.findall(r"^\| `(\w+)` \| (.*?) \| (.*?) \|", text, re.MULTILINE)
    stated = {symbol: re.findall(r"`(\w+)`", inputs + outputs) for symbol, inputs, outputs in rows if "_" in symbol}
    declared = {
        symbol: re.findall(r"sym_strided (\w+)", arguments)
        for symbol, arguments in re.findall(r"^int (\w+)_launch\((.*)\);", header, re.MULTILINE)
    }
    assert stated and all(declared[symbol] == arrays for symbol, arrays in stated.items())
    assert all(symbol.replace("pendulum", "pendulum_single") in declared for symbol in stated)


def test_notes_say_that_constrained_motion_stays_in_c(tmp_path: Path) -> None:
    exported = sf.export(system("four_bar"), "cuda", tmp_path)
    assert "no kernels of forward_dynamics, forward_dynamics_derivatives" in exported.notes[0]
    assert "no rollouts" in (tmp_path / "README.md").read_text()
    assert "four_bar_dynamics" in (tmp_path / "four_bar_double.cu").read_text()


@pytest.mark.parametrize(("name", "bends"), [("double_pendulum", False), ("flexible_pendulum", True)])
def test_notes_say_that_beam_rollouts_are_not_judged(tmp_path: Path, name: str, bends: bool) -> None:
    notes = sf.export(system(name), "cuda", tmp_path).notes
    assert bool([note for note in notes if "rollouts do not judge how far beams bend" in note]) == bends


def test_hostile_names_are_escaped(tmp_path: Path) -> None:
    """Names reach text as identifiers, or as cells of tables and comments that they can't leave."""
    name = "a */ int x; `| <b> # b"
    body = sf.RigidBody(name, sf.Joint("q1", "revolute"), sf.Inertia(1.0, (0.5, 0, 0), (0, 0.1, 0.1)))
    exported = sf.export(sf.System(name, (body,)), "cuda", tmp_path)
    assert exported.name == "a_int_x_b_b"
    assert "int x;" not in re.sub(r"/\*.*?\*/", "", (tmp_path / "a_int_x_b_b_double.cu").read_text(), flags=re.DOTALL)
    assert "<b>" not in (tmp_path / "README.md").read_text()
