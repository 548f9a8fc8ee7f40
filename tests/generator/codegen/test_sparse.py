"""Patterns of sparse factors: they hold every entry that may differ from zero, and grow with the loops alone."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from reference_models.closed.four_bars import n_four_bar, n_four_bar_absolute
from symofros.compiler import Compilation
from symofros.expr.program import Output
from symofros.generator.codegen.model import model_source
from symofros.generator.codegen.solvers import sparse_systems
from symofros.generator.codegen.sparse import Pattern, SparseSystem
from symofros.native import native_text
from tests.exports.cases import need

FORWARD = ("forward_dynamics", "project")


def system_of(system: sf.System) -> SparseSystem:
    stated = Compilation(system, sf.Options(functions=FORWARD))
    return sparse_systems(stated.program)[0]["forward_dynamics"]


@st.composite
def matrices(draw: st.DrawFn) -> np.ndarray:
    """Symmetric matrices of random patterns, diagonally dominant."""
    n = draw(st.integers(1, 12))
    pairs = draw(st.sets(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=2 * n))
    A = np.zeros((n, n))
    for i, j in pairs:
        A[i, j] = A[j, i] = 0.3 + 0.1 * ((i + j) % 3)
    np.fill_diagonal(A, 1.0 + np.abs(A).sum(axis=1))
    return A


@given(matrices())
def test_a_factor_has_no_entries_outside_its_pattern(A: np.ndarray) -> None:
    n = len(A)
    pattern = Pattern.filled([[i for i in range(k + 1, n) if A[i, k]] for k in range(n)])
    C = np.linalg.cholesky(A)
    for k, column in enumerate(pattern.columns):
        beside = set(range(k + 1, n)) - set(column)
        assert np.abs(C[sorted(beside), k]).max(initial=0.0) < 1e-14


@given(matrices())
def test_tables_factor_the_matrix(A: np.ndarray) -> None:
    """The loops of the C routine, over the tables that it is given."""
    n = len(A)
    pattern = Pattern.filled([[i for i in range(k + 1, n) if A[i, k]] for k in range(n)])
    starts, rows, targets = pattern.starts, pattern.rows, iter(pattern.targets)
    diagonal, below = np.diag(A).copy(), np.array([A[i, k] for k, column in enumerate(pattern.columns) for i in column])
    for k in range(n):
        entries = range(starts[k], starts[k + 1])
        diagonal[k] = np.sqrt(diagonal[k])
        below[list(entries)] /= diagonal[k]
        for p in entries:
            diagonal[rows[p]] -= below[p] ** 2
            for q in range(p + 1, starts[k + 1]):
                below[next(targets)] -= below[p] * below[q]
    C = np.diag(diagonal)
    C[rows, np.repeat(np.arange(n), np.diff(starts))] = below
    np.testing.assert_allclose(C, np.linalg.cholesky(A), rtol=0, atol=1e-13)
    assert next(targets, None) is None


@given(matrices(), st.sets(st.integers(0, 11)))
def test_nonzero_rows_of_a_right_hand_side_are_predicted(A: np.ndarray, support: set[int]) -> None:
    n = len(A)
    pattern = Pattern.filled([[i for i in range(k + 1, n) if A[i, k]] for k in range(n)])
    b = np.zeros(n)
    b[[i for i in support if i < n]] = 1.0
    x = np.linalg.solve(np.linalg.cholesky(A), b)
    assert set(np.flatnonzero(np.abs(x) > 1e-13)) <= set(pattern.reached(np.flatnonzero(b)))


@pytest.mark.parametrize("family", [n_four_bar, n_four_bar_absolute])
def test_work_grows_linearly_with_the_loops(family: type) -> None:
    few, many = system_of(family(10)), system_of(family(20))
    assert many.operations < 2.1 * few.operations
    assert many.entries < 2.1 * few.entries


@pytest.mark.parametrize("name", ["four_bar", "stewart", "andrews_squeezer", "two_arms"])
def test_few_loops_use_full_matrices(name: str) -> None:
    """There their loops over contiguous rows are faster."""
    stated = Compilation(MODELS[name], sf.Options(functions=FORWARD))
    assert sparse_systems(stated.program)[0] == {}
    assert "sym_sparse" not in model_source(stated.program, stated.record, "test").replace("struct sym_sparse", "")


def test_packed_matrices_hold_every_entry() -> None:
    stated = Compilation(n_four_bar(6), sf.Options(functions=("forward_dynamics",)))
    (function,) = stated.program.functions
    sparse = sparse_systems(stated.program)[0]["forward_dynamics"]
    for full, packed in zip(function.outputs, sparse.packed(function.outputs), strict=True):
        lower = _lower(full) if full.name == "M" else full.edges
        assert sorted(filter(None, lower)) == sorted(filter(None, packed.edges)), full.name


def _lower(M: Output) -> list[int]:
    n = M.shape[0]
    return [M.edges[i * n + j] for i in range(n) for j in range(i + 1)]


@pytest.mark.slow
def test_the_code_stays_within_its_scratch(tmp_path: Path) -> None:
    """In postures where sparse factors do, and in one where full matrices take over, under sanitizers."""
    need("gcc")
    stated = Compilation(n_four_bar(6), sf.Options(functions=FORWARD))
    source = model_source(stated.program, stated.record, "test", c_name="row")
    (tmp_path / "symofros_model.h").write_text(native_text("model/symofros_model.h"), encoding="utf-8")
    (tmp_path / "row.c").write_text(source + _DRIVER, encoding="utf-8")
    flags = ["-std=gnu99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    built = subprocess.run(["gcc", *flags, "row.c", "-o", "row", "-lm"], cwd=tmp_path, capture_output=True, text=True)
    if built.returncode != 0 and "sanitize" in built.stderr:
        pytest.skip("needs the sanitizers of gcc")
    assert built.returncode == 0, built.stderr
    done = subprocess.run([tmp_path / "row"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["12", "12", "6", "6"]


# Ranks of dynamics and of the projection, with all cranks at one radian, and along the ground (no rows of x are left).
_DRIVER = Path(__file__).with_name("sparse.c").read_text()
