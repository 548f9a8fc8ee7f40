"""Constrained dynamics in C against NumPy, with scratch of exactly the stated size, under sanitizers."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from symofros.generator.codegen.solvers import ROUTINES
from symofros.native import native_text
from tests.runtime.test_constrained import fading_rank

DRIVER = Path(__file__).parent / "solver_routines.c"
FLAGS = ("-std=gnu99", "-O1", "-g", "-Wno-unused-function", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
# No inertia along the third speed, which the second condition binds; as in the driver.
MASS = np.array([[2, 0.5, 0], [0.5, 1, 0], [0, 0, 0]])
G = np.array([[1.0, 1, 0], [0, 1, 2]])
FORCE, RIGHT = np.array([1.0, -2, 3]), np.array([0.7, -0.4])
KKT = np.block([[MASS, -G.T], [G, np.zeros((2, 2))]])


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    """Name -> numbers that the driver prints; a read or write beyond its scratch would have ended it."""
    gcc = shutil.which("gcc")
    if gcc is None:
        pytest.skip("needs gcc")
    folder = tmp_path_factory.mktemp("routines")
    # The systems of packed matrices have the names of the full ones: tests/generator/codegen/test_sparse.py.
    files = dict.fromkeys(file for needed in ROUTINES.values() for file in needed if file != "sparse_system")
    routines = "\n".join(native_text(f"model/{file}.c.in") for file in ("pack", *files))
    head = "#include <math.h>\n#include <string.h>\n" + native_text("model/symofros_model.h")
    (folder / "driver.c").write_text(head + routines + DRIVER.read_text(encoding="utf-8"), encoding="utf-8")
    built = subprocess.run([gcc, *FLAGS, "-o", "driver", "driver.c", "-lm"], cwd=folder, capture_output=True, text=True)
    if built.returncode != 0 and "sanitize" in built.stderr:
        pytest.skip("needs the sanitizers of gcc")
    assert built.returncode == 0, built.stderr
    done = subprocess.run([folder / "driver"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = (line.split() for line in done.stdout.splitlines())
    return {name: np.array(values, dtype=np.float64) for name, *values in rows}


@pytest.mark.parametrize("form", ["", "null_"], ids=["multipliers", "null space"])
def test_a_singular_mass_matrix_gives_the_accelerations_and_multipliers_of_the_kkt_system(
    results: dict[str, np.ndarray], form: str
) -> None:
    """M is singular alone: by multipliers, too, the speeds that the conditions leave free are solved for."""
    expected = np.linalg.solve(KKT, np.concatenate([FORCE, RIGHT]))
    assert results[f"{form}rank"] == 2
    np.testing.assert_allclose(results[f"{form}a"], expected[:3], rtol=0, atol=1e-13)
    np.testing.assert_allclose(results[f"{form}lam"], expected[3:], rtol=0, atol=1e-13)


def test_projection_is_the_least_change_in_the_metric_of_the_mass_matrix(results: dict[str, np.ndarray]) -> None:
    q0, v0 = np.array([0.3, 0.1, -0.2]), np.array([1.0, 2, 3])
    for name, start, right in (("q", q0, RIGHT - G @ q0), ("v", v0, -G @ v0)):
        change = np.linalg.solve(KKT, np.concatenate([np.zeros(3), right]))[:3]
        np.testing.assert_allclose(results[name], start + change, rtol=0, atol=1e-13)
    assert results["residual"] < 1e-13 and results["project_rank"] == 2


def test_derivatives_of_accelerations_and_multipliers_solve_the_kkt_system(results: dict[str, np.ndarray]) -> None:
    slopes = np.vstack([-np.eye(3), np.zeros((2, 3))])  # dR/dx, as in the driver.
    derivative = results["derivative"].reshape(5, 3)
    np.testing.assert_allclose(derivative, np.linalg.solve(KKT, -slopes), rtol=0, atol=1e-13)


def test_second_derivatives_of_many_columns_are_made_of_first_ones(results: dict[str, np.ndarray]) -> None:
    """H = B^T z_x + z_x^T B where R_xx = 0. Functions may write all of their scratch, which holds nothing else then."""
    row, column = np.arange(5)[:, None], np.arange(60)
    slopes, mixed = (7 * row + 3 * column) % 5 - 2, (3 * row + 5 * column) % 7 - 3  # As in the driver.
    half = mixed.T @ np.linalg.solve(KKT, -slopes)
    np.testing.assert_allclose(results["hessian"].reshape(60, 60), half + half.T, rtol=0, atol=1e-12)


def test_beside_the_constraints_the_rank_is_that_on_them(results: dict[str, np.ndarray]) -> None:
    """q0 = 0 and q0 (1 + q1) = 0 repeat each other where they hold, and leave q1 free there."""
    assert results["motion_rank"] == 1
    np.testing.assert_allclose(results["motion_a"], [0.0, -2.0, 2.0], rtol=0, atol=1e-3)


def test_the_rank_beside_rows_that_fade_is_that_of_the_routines_in_numpy(results: dict[str, np.ndarray]) -> None:
    """From rounding to where the state is too far from the constraints to have drifted; as in the driver."""
    states = [np.array([10.0 ** (-3 - i), 0, 0, 2e-4 * 1.5**j]) for i in range(3) for j in range(24)]
    ranks = [fading_rank(q) for q in states]
    np.testing.assert_array_equal(results["fading_ranks"], ranks)
    assert set(ranks) == {2, 3}


def test_projection_returns_the_initial_residual(results: dict[str, np.ndarray]) -> None:
    q0 = np.array([0.3, 0.1, -0.2])
    np.testing.assert_allclose(results["gap"], np.linalg.norm(G @ q0 - RIGHT), rtol=1e-14)


@pytest.mark.parametrize("k", [1, 8, 19])
def test_blocks_of_a_factor_solve_for_any_number_of_rows_and_columns(results: dict[str, np.ndarray], k: int) -> None:
    """Rows that fill up a block, and columns that fill up a vector; zeros below the diagonal; as in the driver."""
    for n in range(1, 10):
        row, column, right = np.arange(n)[:, None], np.arange(n), np.arange(k)
        L = np.tril((3 * row + 5 * column) % 4 - 1, -1) + np.diag(2 + column % 3)
        X = (5 * row + 3 * right) % 7 - 3
        np.testing.assert_allclose(results[f"blocks_{n}_{k}"].reshape(n, k), -np.linalg.solve(L.T @ L, X), atol=1e-11)
