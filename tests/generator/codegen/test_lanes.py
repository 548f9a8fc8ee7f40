"""Batches by vectors give the bits of batches by a loop: every function, any number of states, any width of vectors.

Where the compiler fuses multiplications with additions it may choose other pairs on vectors: then within rounding.
"""

from __future__ import annotations

import platform
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.functions import MODEL_FUNCTIONS
from symofros.compiler import Compilation, compile_library
from symofros.generator.codegen.model import model_source
from symofros.native import native_text
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import DEFAULT_FLAGS, cpu_identity, find_toolchain
from symofros.runtime.calls import library
from symofros.runtime.calls.kernel import Array, BatchOptions, Kernel, LaneOptions
from symofros.runtime.calls.library import CompiledUnit
from tests.generator.codegen.test_source import COMPILERS, OPERATIONS, compile_strictly
from tests.models import sampled

# Two lanes, four and eight on any processor, by the macros that choose: the compiler makes them of narrower vectors
# where there are none so wide. Then four by the processor's own instructions, and what this processor has.
# gcc 12 fuses pairs of neighbouring statements even with contraction off, unless it leaves them apart.
EXACT = (*DEFAULT_FLAGS, "-ffp-contract=off", "-fno-tree-slp-vectorize")
# The same bits, of every function, compiled in half of the time.
QUICK = ("-O1", *EXACT[1:])
WIDTHS = {
    "two": ("-O1", "-ffp-contract=off"),
    "four": ("-O1", "-ffp-contract=off", "-Wno-psabi", "-D__AVX__=1"),
    "eight": ("-O1", "-ffp-contract=off", "-Wno-psabi", "-D__AVX512F__=1"),
    "avx": ("-O2", "-mavx2", "-mfma", *EXACT[-2:]),
    "native": EXACT,
}
FORCED = ("two", "four", "eight")
# Of the largest value: fused operations round once instead of twice; forward dynamics divides by M.
SHIPPED = 1e-11
CHEAP = ("mass_matrix", "bias", "generalized_force", "dynamics", "forward_dynamics")
# Results of one number a state: shorter than a vector, so that each overruns into the next.
SCALAR = ("kinetic_energy", "potential_energy")
HAS = {width: "-mavx2" not in flags or "avx2" in cpu_identity() for width, flags in WIDTHS.items()}


def stated(case: str) -> sf.System:
    return OPERATIONS if case == "operations" else MODELS[case]


def parameters(case: str) -> tuple[float, ...]:
    return Compilation(stated(case)).record.par_default


@cache
def unit(case: str, batch: str, flags: tuple[str, ...], functions: tuple[str, ...]) -> CompiledUnit:
    system = stated(case)
    options = sf.Options(functions=functions, flags=flags, batch=batch)  # type: ignore[arg-type]
    path, symbol = compile_library(system, options)
    return CompiledUnit(path, symbol, Compilation(system, options).record.hash)


def given(kernel: Kernel, n: int, shared: tuple[str, ...] = ()) -> list[Array]:
    rng = np.random.default_rng(n)
    return [rng.uniform(-2.0, 2.0, (1 if name in shared else n, size)) for name, size in kernel.signature.inputs]


def assert_alike(case: str, flags: tuple[str, ...], functions: tuple[str, ...], sizes: list[int], *shared: str) -> None:
    loops, vectors = (unit(case, batch, flags, functions) for batch in ("loop", "vector"))
    for key, kernel in loops.kernels.items():
        pre = kernel.prepare(np.array([parameters(case)]))
        for n in sizes:
            inputs = given(kernel, n, shared)
            results = [k.run(n, pre, inputs) for k in (kernel, vectors.kernels[key])]
            for expected, found in zip(*results, strict=True):
                assert np.array_equal(found, expected, equal_nan=True), (key, n)


@pytest.mark.parametrize("case", sampled(("double_pendulum", "cart_pole", "planar_robot"), ("double_pendulum",)))
def test_every_function_agrees_in_lanes(case: str) -> None:
    assert_alike(case, QUICK, MODEL_FUNCTIONS, [2, 17])


@pytest.mark.parametrize("case", sampled(("planar_robot", "friction_arm", "chain7"), ("friction_arm",)))
def test_vectors_match_loops_within_rounding(case: str) -> None:
    loops, vectors = (unit(case, batch, DEFAULT_FLAGS, CHEAP) for batch in ("loop", "vector"))
    for key, kernel in loops.kernels.items():
        pre, inputs = kernel.prepare(np.array([parameters(case)])), given(kernel, 40)
        for expected, found in zip(*(k.run(40, pre, inputs) for k in (kernel, vectors.kernels[key])), strict=True):
            np.testing.assert_allclose(found, expected, rtol=0.0, atol=SHIPPED * max(1.0, np.abs(expected).max()))


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("case", sampled(("chain7", "friction_arm", "heavy_top"), ("heavy_top",)))
def test_any_number_of_states_agrees_in_lanes(case: str, width: str) -> None:
    if not HAS[width]:
        pytest.skip("a processor without these vectors")
    assert_alike(case, WIDTHS[width], (*CHEAP, *SCALAR), list(range(1, 21)))


@pytest.mark.parametrize("width", sampled(tuple(WIDTHS), FORCED))
def test_columns_of_any_number_of_states_agree_with_rows(width: str) -> None:
    """In place, but for fewer states than lanes; entries that are always zero are cleared."""
    if not HAS[width]:
        pytest.skip("a processor without these vectors")
    vectors = unit("friction_arm", "vector", WIDTHS[width], (*CHEAP, *SCALAR))
    for kernel in vectors.compiled.values():
        pre = kernel.prepare(np.array([parameters("friction_arm")]))
        for n in (1, 2, 3, 7, 8, 9, 16, 21):
            inputs = given(kernel, n)
            columns = kernel._by_lanes(n, pre, [*map(np.asfortranarray, inputs)], BatchOptions(columns=True), ())
            for found, expected in zip(columns, kernel._by_rows(n, [pre, *inputs], 1), strict=True):
                assert np.array_equal(found, expected) and (found.strides[0] == 8 or n == 1)


@pytest.mark.parametrize("width", sampled(tuple(WIDTHS), FORCED))
def test_every_operation_agrees_in_lanes(width: str) -> None:
    if not HAS[width]:
        pytest.skip("a processor without these vectors")
    assert_alike("operations", WIDTHS[width], ("generalized_force", "mass_matrix"), [5, 16])


def test_nothing_is_written_beyond_the_last_state() -> None:
    """Short rows are written by whole vectors, which must not reach past the array."""
    kernel = unit("double_pendulum", "vector", QUICK, MODEL_FUNCTIONS).kernels["bias", ""]
    ffi, function = kernel._unit.ffi, kernel._function  # type: ignore[attr-defined]
    pre = kernel.prepare(np.array([parameters("double_pendulum")]))
    for n in range(1, 30):
        inputs = [pre, *given(kernel, n)]
        guarded = np.full(2 * n + 16, 7.0)
        buffers = [ffi.from_buffer("double[]", np.ascontiguousarray(x)) for x in inputs]
        strides = [0, *(x.shape[1] for x in inputs[1:])]
        function.batch(
            n,
            ffi.new("double *[]", buffers),
            ffi.new("size_t[]", strides),
            ffi.new("double *[]", [ffi.from_buffer("double[]", guarded)]),
            ffi.new("double[]", function.work),
        )
        assert np.all(guarded[2 * n :] == 7.0) and not np.any(guarded[: 2 * n] == 7.0)


@pytest.mark.parametrize("case", sampled(("rx90", "friction_arm", "operations"), ("friction_arm", "operations")))
def test_each_state_may_have_its_own_parameters(case: str) -> None:
    """One set for each state, and one for all through the same library."""
    model, loop = (sf.compile(stated(case), sf.Options(batch=batch, flags=EXACT)) for batch in ("vector", "loop"))  # type: ignore[arg-type]
    # Parameters that change one by one are no body's inertia.
    model, loop = model.with_parameter_checks(False), loop.with_parameter_checks(False)
    rng = np.random.default_rng(0)
    n = library.MANY + 3
    q, v = rng.uniform(-2.0, 2.0, (2, n, model.nq))
    u, par = rng.uniform(-2.0, 2.0, (n, model.nu)), model.parameter_values * rng.uniform(0.5, 1.5, (n, model.npar))
    assert model.npar > 0
    for found, expected in zip(model.dynamics(q, v, u, par=par), loop.dynamics(q, v, u, par=par), strict=True):
        assert np.array_equal(found, expected, equal_nan=True)
    kernel = model.kernel("dynamics")
    pre, inputs = kernel.prepare(par[:1]), [q, v, u, np.zeros((1, 1))]
    own = kernel.in_lanes(LaneOptions(own_parameters=True))  # type: ignore[attr-defined]
    for found, expected in zip(own.run(n, pre, inputs), kernel.run(n, pre, inputs), strict=True):
        assert own is not kernel and np.array_equal(found, expected, equal_nan=True)


@pytest.mark.parametrize("case", ("double_pendulum", "heavy_top"))
def test_where_vectors_are_all_one_state_is_evaluated_by_them(case: str) -> None:
    """One alone, and states with parameters of their own that the lanes can't hold: what a loop gives, to the bit."""
    names = ("bias", "potential_energy")
    models = {b: sf.compile(stated(case), sf.Options(names, batch=b, flags=QUICK)) for b in ("vector", "loop")}  # type: ignore[arg-type]
    for name in names:
        loop, kernel = models["loop"].kernel(name), models["vector"].kernel(name)
        alone = kernel.in_lanes()  # type: ignore[attr-defined]
        text = alone.library.with_suffix(".c").read_text(encoding="utf-8")
        assert alone is not kernel and text.count("_batch(1, in, stride, out, work);") == 1
        n, par = 3, np.array(parameters(case))
        pre = loop.prepare(par * np.linspace(1.0, 1.5, n)[:, None])
        inputs = given(loop, n)
        results = alone._by_rows(n, [pre, *inputs], 1), loop._by_rows(n, [pre, *inputs], 1)  # type: ignore[attr-defined]
        for found, expected in zip(*results, strict=True):
            assert np.array_equal(found, expected, equal_nan=True)
        outputs = [np.full(value.shape[1:], 7.0) for value in results[1]]
        alone.bind(pre[:1], [x[0] for x in inputs], outputs)()
        for output, expected in zip(outputs, results[1], strict=True):
            assert np.array_equal(output, expected[0], equal_nan=True)


# Vectors of each width in every run with one way of passing parameters or the other.
OWN_IN_EVERY_RUN = {(): True, ("-std=gnu99", "-O2"): False, ("-std=gnu99", "-O2", "-mavx512f"): True}


@pytest.mark.parametrize(
    ("flags", "lanes"),
    [
        pytest.param(
            flags,
            LaneOptions(own, precision),
            id=f"{' '.join(flags)}-{'own' if own else 'shared'}-{precision}",
            marks=() if OWN_IN_EVERY_RUN.get(flags, False) is own else pytest.mark.slow,
        )
        for flags in ((), ("-std=gnu99", "-O2"), ("-std=gnu99", "-O2", "-mavx512f"), ("-std=gnu99", "-mavx"))
        for own in (False, True)
        for precision in ("double", "single")
    ]
    + [
        pytest.param(("-std=gnu99", "-O2", "-mavx2"), LaneOptions(in_rows=True), id="rows"),
        pytest.param(("-std=gnu99", "-O2", "-mavx2"), LaneOptions(are_all=True), id="all"),
        pytest.param((), LaneOptions(are_all=True), id="all, without vectors"),
    ],
)
def test_vector_code_compiles_without_warnings(flags: tuple[str, ...], lanes: LaneOptions, tmp_path: Path) -> None:
    """As strict C99, where batches are loops, and on vectors of every width."""
    if not any(word in platform.machine() for word in ("x86", "AMD64")) and len(flags) > 1:
        pytest.skip("flags of another processor")
    stated = Compilation(MODELS["double_pendulum"], sf.Options(functions=("dynamics", "forward_dynamics")))
    source = model_source(stated.program, stated.record, "test", in_lanes=lanes)
    compile_strictly(tmp_path, source, COMPILERS[0], *flags)


def test_sines_of_sines_are_evaluated_later() -> None:
    """The sine of an angle that another sine leads to is not among the first."""
    joint = sf.Joint("x", "prismatic", effort=("sin(2*x + sin(x))*sin(3*x)",))
    system = sf.System("nested", [sf.RigidBody("b", joint, sf.Inertia(1.0))])
    options = sf.Options(("generalized_force",), batch="vector", flags=EXACT)
    path, symbol = compile_library(system, options)
    first, _, others = path.with_suffix(".c").read_text(encoding="utf-8").partition("_v_0(")[2].partition("_v_1(")
    assert "sym_sincos_v(2," in first and "sym_sincos_v(1," not in first and "sym_sincos_v(1," in others
    kernel = CompiledUnit(path, symbol, Compilation(system, options).record.hash).kernels["generalized_force", ""]
    x = np.linspace(-3.0, 3.0, 999)[:, None]
    inputs = [x if name == "q" else np.zeros((1, size)) for name, size in kernel.signature.inputs]
    (found,) = kernel.run(len(x), kernel.prepare(np.zeros((1, 0))), inputs)
    np.testing.assert_allclose(found, np.sin(2 * x + np.sin(x)) * np.sin(3 * x), rtol=0, atol=1e-14)


@pytest.mark.parametrize("case", sampled(("friction_arm", "heavy_top", "planar_robot"), ("friction_arm",)))
def test_lanes_stored_by_rows_give_the_bits_of_a_loop(case: str) -> None:
    """Two states where they lie, as in modules for WebAssembly: the bits of a loop, odd states at the end."""
    loops = unit(case, "loop", WIDTHS["two"], (*CHEAP, *SCALAR))
    stated = Compilation(MODELS[case], sf.Options((*CHEAP, *SCALAR)))
    source = model_source(stated.program, stated.record, "test", LaneOptions(in_rows=True), "rows")
    toolchain = find_toolchain()
    assert toolchain is not None and "sym_lanes rows" not in source
    path = build_library(source, native_text("model/symofros_model.h"), toolchain, WIDTHS["two"])
    rows = CompiledUnit(path, "rows_model", stated.record.hash)
    for key, kernel in loops.kernels.items():
        pre = kernel.prepare(np.array([parameters(case)]))
        for n, shared in ((1, ()), (2, ()), (3, ("v", "t")), (4, ("q",)), (37, ())):
            inputs = given(kernel, n, shared)
            results = [each.kernels[key].run(n, pre, inputs) for each in (loops, rows)]
            for expected, found in zip(*results, strict=True):
                assert np.array_equal(found, expected, equal_nan=True), (key, n)
