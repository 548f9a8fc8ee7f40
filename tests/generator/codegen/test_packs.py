"""Values that share vectors keep their bits; vectors are formed where they save work, and only there."""

from __future__ import annotations

import platform
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.compiler import Compilation
from symofros.expr.edges import ONE, ZERO
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.generator.codegen.model import Packs, model_source
from symofros.generator.codegen.packs import PackPlan
from symofros.native import native_text
from tests.models import sampled

# Fused multiplications and additions would round differently in vectors.
EXACT = ("-O1", "-ffp-contract=off")
# Parts of two lanes, four and eight on any processor, by the macros that choose, as in test_lanes.py.
PARTS = {2: EXACT, 4: (*EXACT, "-Wno-psabi", "-D__AVX__=1"), 8: (*EXACT, "-Wno-psabi", "-D__AVX512F__=1")}
FUNCTIONS = ("mass_matrix", "dynamics", "forward_dynamics")
CASES = (
    "chain22",
    "spdm",
    "mss",
    "flexible_arm",
    "random_tree1",
    "joint_zoo",
    "chain7",
    "planar_robot",
    "grasp",
)


def source(system: sf.System, functions: tuple[str, ...], packs: Packs = "where they pay") -> str:
    stated = Compilation(system, sf.Options(functions=functions, forward_dynamics="factors"))
    return model_source(stated.program, stated.record, "test", packs=packs)


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("name", sampled(CASES, ("chain7", "planar_robot")))
def test_packed_results_equal_scalar_bits(name: str, part: int) -> None:
    rng = np.random.default_rng(7)
    system = MODELS[name]
    assert "SYM_PACK(" in source(system, ("dynamics",))
    options = sf.Options(functions=FUNCTIONS, flags=PARTS[part], forward_dynamics="factors")  # These have packs.
    packed, single = sf.compile(system, options), sf.compile(system, replace(options, packs=False))
    q, v, u = (rng.uniform(-1.0, 1.0, (5, n)) for n in (packed.nq, packed.nv, packed.nu))
    q = packed.normalized(q)
    np.testing.assert_array_equal(packed.mass_matrix(q), single.mass_matrix(q))
    for ours, theirs in zip(packed.dynamics(q, v, u), single.dynamics(q, v, u), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    assert repr(packed.forward_dynamics(q, v, u)) == repr(single.forward_dynamics(q, v, u))


@pytest.mark.parametrize(
    "name",
    sampled(("puma560", "spdm", "mss", "flexible_pendulum", "joint_zoo"), ("puma560",)),
)
def test_packed_derivatives_equal_scalar_bits(name: str) -> None:
    rng = np.random.default_rng(8)
    functions = ("inverse_dynamics_derivatives", "forward_dynamics_derivatives")
    options = sf.Options(functions=functions, flags=EXACT)
    packed, single = sf.compile(MODELS[name], options), sf.compile(MODELS[name], replace(options, packs=False))
    q, v, x = (rng.uniform(-1.0, 1.0, n) for n in (packed.nq, packed.nv, packed.nv))
    for function, last in zip(functions, (x, x[: packed.nu]), strict=True):
        for ours, theirs in zip(
            getattr(packed, function)(q, v, last), getattr(single, function)(q, v, last), strict=True
        ):
            np.testing.assert_array_equal(ours, theirs)


def test_equal_limbs_of_constrained_models_share_vectors() -> None:
    """Six legs of a Stewart platform, three in a vector."""
    functions = ("forward_dynamics",)
    assert "sym_quad p" in source(MODELS["stewart"], functions)
    assert "sym_quad p" not in source(MODELS["stewart"], functions, "none")


def test_no_vector_is_wider_than_the_processor_has(tmp_path: Path) -> None:
    """gcc keeps wider ones in memory, and spreads a factor over them by a store for each lane."""
    compiler = shutil.which("gcc")
    if compiler is None or platform.machine() != "x86_64":
        pytest.skip("needs gcc on x86-64")
    text = """void f(double a, const double *x, const double *y, double *to) {
        sym_pack_store(to, sym_plus(sym_scaled(a, sym_pack_load(x)), a, sym_pack_load(y)));\n}\n"""
    (tmp_path / "f.c").write_text(f"#include <string.h>\n{native_text('model/pack.c.in')}\n{text}")
    for flags, vectors in ((("-mavx512f",), 1), (("-mavx2", "-mfma"), 2), ((), 4)):
        command = [compiler, "-std=gnu99", "-O2", *flags, "-S", "f.c", "-o", "f.s"]
        subprocess.run(command, cwd=tmp_path, check=True)
        assembly = (tmp_path / "f.s").read_text()
        assert not re.search(r"\(%[er]sp\)", assembly), "the stack is used"
        assert len(re.findall(r"^\s+v?mulpd", assembly, re.MULTILINE)) in (vectors, 2 * vectors)


@pytest.mark.parametrize(
    ("name", "function", "with_packs", "without"),
    [
        ("puma560", "mass_matrix", False, True),  # More is put into lanes than is saved.
        ("planar_robot", "dynamics", True, True),  # Which is faster is decided by the width of vectors.
        ("puma560", "inverse_dynamics_derivatives", True, False),
    ],
)
def test_packs_are_left_out_where_they_do_not_pay(name: str, function: str, with_packs: bool, without: bool) -> None:
    def first_chunk(packs: Packs) -> str:
        return source(MODELS[name], (function,), packs).partition(f"_{function}_f0_0(")[2].partition("\n}")[0]

    text, packed, plain = source(MODELS[name], (function,)), first_chunk("all"), first_chunk("none")
    assert packed != plain
    assert (packed in text, plain in text) == (with_packs, without)
    assert ("#if SYM_PART < 8" in text) == (with_packs and without)


@pytest.mark.slow
def test_vectors_cross_chunks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A function in many chunks passes whole vectors from one to the next."""
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))  # What is kept there was made by a generator as it is.
    monkeypatch.setattr("symofros.generator.codegen.function.MAX_STATEMENTS", 60)
    text = source(MODELS["chain22"], ("mass_matrix",))
    assert "sym_pack_load(work + " in text
    rng = np.random.default_rng(3)
    model = sf.compile(MODELS["chain22"], sf.Options(functions=("mass_matrix",), flags=EXACT))
    q = rng.uniform(-1.0, 1.0, model.nq)
    plain = sf.compile(MODELS["chain22"], sf.Options(functions=("mass_matrix",), backend="interpreter"))
    np.testing.assert_array_equal(model.mass_matrix(q), plain.mass_matrix(q))


def test_operands_of_folded_lanes_stay_scalar() -> None:
    """Lane 1 is put in from scalars, because d (0.3 z) was folded, and lane 0's c x is a part of it: had lane 0 its
    home in the vector, the vector would wait for itself."""
    g = Graph()
    c, d = g.input("c", 0), g.constant(0.7)
    x = [g.input("x", i) for i in range(WIDTH)]
    first = Pack((x[0], x[0], *x[2:]))
    second = Pack((ZERO, g.mul(g.constant(0.3), x[1]), *x[2:]))
    _, pack = linear_combination(g, [(c, (ONE, first)), (d, (ONE, second))])
    assert 0 in pack.new_lanes
    assert 1 not in pack.new_lanes
    edges = [abs(edge) for edge in pack.lanes]
    plan = PackPlan(g, needed_nodes(g, edges), {}, edges)
    assert set(plan.vector_of_node) == set(edges[2:])
