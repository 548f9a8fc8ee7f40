"""One library for any processor of a family: each version in it gives the same states, and the best one is chosen."""

from __future__ import annotations

import ctypes
import platform
import subprocess
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.compiler import compile_library
from symofros.generator.codegen.dispatch import dispatch_source
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import KINDS, Toolchain, cpu_identity, find_toolchain, kinds
from symofros.runtime.calls import library
from tests.late import needs_program, with_utilities

X86 = platform.machine().lower() in ("x86_64", "amd64")


def test_the_same_states_as_natively() -> None:
    native, anywhere = (
        sf.compile(MODELS["friction_arm"], sf.Options(functions=("dynamics",), processors=kind))  # type: ignore[arg-type]
        for kind in ("native", "any")
    )
    rng = np.random.default_rng(0)
    q, v = map(np.array, zip(*(native.random_state(rng) for _ in range(library.MANY)), strict=True))
    u = rng.normal(size=(library.MANY, native.nu))
    for rows in (slice(0, 3), slice(None)):  # State by state, and by vectors.
        for found, expected in zip(
            anywhere.dynamics(q[rows], v[rows], u[rows]), native.dynamics(q[rows], v[rows], u[rows]), strict=True
        ):
            # Versions differ in which products and sums are fused.
            np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * max(1.0, np.abs(expected).max()))


@pytest.mark.skipif(not X86, reason="there is one kind of other processors")
def test_every_version_is_there_and_the_best_is_chosen() -> None:
    options = sf.Options(functions=("dynamics",), processors="any")
    path, symbol = compile_library(MODELS["pendulum"], options)
    needs_program("nm")
    command = ["nm", str(path)]
    symbols = subprocess.run(command, capture_output=True, text=True, check=True, env=with_utilities()).stdout
    assert [name for name, _, _ in KINDS if f"{symbol}_{name}" in symbols] == ["avx512", "avx2", "baseline"]
    has = set(cpu_identity().split())
    best = next(name for name, needs, _ in KINDS if has.issuperset(needs))
    exported = ctypes.CDLL(str(path))[symbol]
    exported.restype = ctypes.c_void_p
    places = {words[2]: int(words[0], 16) for words in map(str.split, symbols.splitlines()) if len(words) == 3}
    start = ctypes.cast(exported, ctypes.c_void_p).value
    assert start is not None
    chosen = ctypes.CFUNCTYPE(ctypes.c_void_p)(start - places[symbol] + places[f"{symbol}_{best}"])
    assert exported() == chosen()


def test_the_key_does_not_name_the_machine(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    toolchain = find_toolchain(None)
    assert isinstance(toolchain, Toolchain)
    model = (
        '#include "symofros_model.h"\nSYM_EXPORT const sym_model *m(void);\nconst sym_model *m(void) { return 0; }\n'
    )
    header = (Path(library.__file__).parents[2] / "native/model/symofros_model.h").read_text(encoding="utf-8")
    native = build_library(model, header, toolchain)
    anywhere = build_library(model, header, toolchain, None, dispatch_source("m"), "m")
    monkeypatch.setattr("symofros.runtime.build.build.cpu_identity", lambda: "another machine")
    assert build_library(model, header, toolchain) != native
    assert build_library(model, header, toolchain, None, dispatch_source("m"), "m") == anywhere


def test_one_kind_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symofros.runtime.build.toolchain.platform.machine", lambda: "aarch64")
    assert [name for name, _, _ in kinds()] == ["baseline"]
    assert "__builtin_cpu" not in dispatch_source("m") and "return m_baseline();" in dispatch_source("m")
