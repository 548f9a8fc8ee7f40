"""Vectors by the instructions of AVX2 on any x86 processor, emulated: batches give the bits of single states."""

from __future__ import annotations

import platform
from pathlib import Path

import pytest

import symofros as sf
from reference_models import MODELS
from symofros.compiler import Compilation
from symofros.generator.codegen.model import model_source
from symofros.native import native_text
from symofros.runtime.calls.kernel import LaneOptions
from tests.exports.cases import need, run

# Each function for one state to twenty, as a whole and one by one; it prints how many numbers were compared.
PROGRAM = Path(__file__).with_name("emulated_vectors.c").read_text()


@pytest.mark.tools
def test_vectors_of_an_emulated_processor_compute_the_bits_of_single_states(tmp_path: Path) -> None:
    if platform.machine().lower() not in ("x86_64", "amd64"):
        pytest.skip("the compiler is of another processor")
    need("qemu-x86_64")
    functions = ("mass_matrix", "bias", "kinetic_energy", "inverse_dynamics", "dynamics")
    stated = Compilation(MODELS["friction_arm"], sf.Options(functions=functions))
    source = model_source(stated.program, stated.record, "test", LaneOptions(), "test")
    (tmp_path / "model.c").write_text(source, encoding="utf-8")
    (tmp_path / "main.c").write_text(PROGRAM, encoding="utf-8")
    (tmp_path / "symofros_model.h").write_text(native_text("model/symofros_model.h"), encoding="utf-8")
    flags = ("-std=gnu99", "-O2", "-mavx2", "-mfma", "-ffp-contract=off", "-fno-tree-slp-vectorize", "-static")
    run("gcc", *flags, "model.c", "main.c", "-o", "program", "-lm", cwd=tmp_path)
    compared, wrong = map(int, run("qemu-x86_64", "-cpu", "Haswell", "./program", cwd=tmp_path).split())
    assert compared > 5_000 and wrong == 0
