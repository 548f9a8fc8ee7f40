"""What acados calls: external functions by its C interface, and C that it has CasADi generate, linked with the library.

acados is on no package index. Its `external_function_casadi` has pointers to NAME, NAME_work, NAME_sparsity_in,
NAME_sparsity_out, NAME_n_in and NAME_n_out, all with whole numbers of type `int`, and an address in place of CasADi's
memory index; its templates generate with casadi_int="int". acados_call.c is written against these types.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.interop.turning import SYSTEMS, states
from tests.late import late

casadi = late("casadi", extra="casadi")

PROGRAM = Path(__file__).with_name("acados_call.c").read_text()


@pytest.fixture(scope="module")
def dynamics() -> Any:
    return sf.interop.casadi.Dynamics(MODELS["cart_pole"], frames=["tip"])


def called(folder: Path, link: Sequence[str], functions: dict[str, list[np.ndarray]]) -> list[np.ndarray]:
    """All outputs of some functions, one after the other, by the program."""
    compiler = shutil.which("cc") or pytest.skip("needs a program called cc")
    listed = f"#define FUNCTIONS(each) {' '.join(f'each({name})' for name in functions)}"
    (folder / "main.c").write_text(f"{listed}\n{PROGRAM}")
    run = [compiler, "-std=c99", "-Wall", "-Werror", "main.c", *link, "-lm", "-o", "main"]
    subprocess.run(run, cwd=folder, check=True)
    given = " ".join(f"{x:.17g}" for inputs in functions.values() for each in inputs for x in each.ravel(order="F"))
    done = subprocess.run(["./main"], cwd=folder, check=True, capture_output=True, text=True, input=given)
    outputs = []
    for line in done.stdout.splitlines():
        rows, columns, *cells = line.split()
        outputs.append(np.zeros((int(rows), int(columns))))
        for row, column, value in zip(*(cells[i::3] for i in range(3)), strict=True):
            outputs[-1][int(row), int(column)] = float(value)
    return outputs


def test_functions_and_derivatives_by_the_c_interface(dynamics: Any, tmp_path: Path) -> None:
    """The values and patterns that CasADi reads itself, of every function of the library."""
    name = dynamics.write_acados_library(tmp_path / "library")
    link = [f"-L{tmp_path / 'library'}", f"-l{name}", f"-Wl,-rpath,{tmp_path / 'library'}"]
    rng, functions, right = np.random.default_rng(8), {}, []
    for own in dynamics.names.values():
        for prefix in ("", "jac_", "adj1_", "jac_jac_", "jac_adj1_"):
            function = casadi.external(f"{prefix}{own}", str(dynamics.library))
            given = [rng.uniform(0.5, 1.0, function.nnz_in(i)) for i in range(function.n_in())]
            functions[f"{prefix}{own}"] = given
            right += function.call([casadi.DM(function.sparsity_in(i), each) for i, each in enumerate(given)])
    found = called(tmp_path, link, functions)
    assert len(found) == len(right)
    for ours, theirs in zip(found, right, strict=True):
        np.testing.assert_array_equal(ours, np.array(theirs))


@pytest.mark.parametrize("name", ["cart_pole", "hopper"])
def test_acados_functions_match_the_dynamics(name: str, tmp_path: Path) -> None:
    """x' = f(x, u, p), its sensitivities and its Hessian, as acados states them for explicit integrators."""
    system = MODELS[name] if name in MODELS else SYSTEMS[name]()
    model, dynamics = sf.compile(system), sf.interop.casadi.Dynamics(system)
    nx, nu, npar = model.nq + model.nv, model.nu, len(model.parameter_values)
    sym = casadi.MX.sym
    x, u, p, Sx, Su, lam = (
        sym("x", nx),
        sym("u", nu),
        sym("p", npar),
        sym("Sx", nx, nx),
        sym("Su", nx, nu),
        sym("l", nx),
    )
    f = dynamics.state_derivative(x, u, p)
    by_state, by_input = casadi.jtimes(f, x, Sx), casadi.jacobian(f, u) + casadi.jtimes(f, x, Su)
    xu = casadi.vertcat(x, u)
    adjoint = casadi.jtimes(f, xu, lam, True)
    generated = {
        "expl_ode_fun": ([x, u, p], [f]),
        "expl_vde_forw": ([x, Sx, Su, u, p], [f, by_state, by_input]),
        "expl_ode_hess": ([x, lam, u, p], [adjoint, casadi.jacobian(adjoint, xu, {"symmetric": True})]),
    }
    for name, (inputs, outputs) in generated.items():
        function = casadi.Function(name, inputs, outputs)
        code = casadi.CodeGenerator(name, {"mex": False, "casadi_int": "int", "casadi_real": "double"})
        code.add(function)
        code.generate(f"{tmp_path}/")
    rng = np.random.default_rng(2)
    q, v = (each[0] for each in states(model, 1, rng))
    force, weights = rng.standard_normal(nu), rng.standard_normal(nx)
    state, par, identity, none = np.concatenate([q, v]), model.parameter_values, np.eye(nx), np.zeros((nx, nu))
    functions = {
        "expl_ode_fun": [state, force, par],
        "expl_vde_forw": [state, identity, none, force, par],
        "expl_ode_hess": [state, weights, force, par],
    }
    library = dynamics.write_acados_library(tmp_path)
    sources = [f"{name}.c" for name in generated]
    link = [*sources, "-Wno-unused", f"-L{tmp_path}", f"-l{library}", f"-Wl,-rpath,{tmp_path}"]
    found = called(tmp_path, link, functions)
    right = [each for own, given in functions.items() for each in casadi.Function(own, *generated[own]).call(given)]
    for ours, theirs in zip(found, right, strict=True):
        np.testing.assert_allclose(ours, np.array(theirs), rtol=1e-12, atol=1e-11)
    if model.nq != model.nv:
        return
    rate, rate_again, A, B, adj, hessian = found
    slopes = model.linearize(q, v, force)
    right = np.concatenate([v, model.forward_dynamics(q, v, force)])
    np.testing.assert_allclose(rate.ravel(), right, rtol=1e-12)
    np.testing.assert_array_equal(rate_again, rate)
    np.testing.assert_allclose(A, slopes[0], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(B, slopes[1], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(adj.ravel(), np.hstack(slopes).T @ weights, rtol=1e-12, atol=1e-12)
    at = {"q": q, "v": v, "u": force, "par": par, "a_bar": weights[model.nq :], "lam_bar": np.zeros(0)}
    (second,) = model.evaluate("forward_dynamics_hessian", **at)
    np.testing.assert_allclose(hessian, second[: nx + nu, : nx + nu], rtol=1e-12, atol=1e-12)
