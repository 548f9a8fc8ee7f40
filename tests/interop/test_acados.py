"""What acados calls: external functions by its C interface, and C that it has CasADi generate, linked with the library.

acados is on no package index. Its `external_function_casadi` has pointers to NAME, NAME_work, NAME_sparsity_in,
NAME_sparsity_out, NAME_n_in and NAME_n_out, all with whole numbers of type `int`, and an address in place of CasADi's
memory index; its templates generate with casadi_int="int". The program below is written against these types.
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

PROGRAM = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* WHOLE, MEMORY: int and void * of acados, long long and int of CasADi. */
typedef struct {
    int (*fun)(const double **, double **, WHOLE *, double *, MEMORY);
    int (*work)(WHOLE *, WHOLE *, WHOLE *, WHOLE *);
    const WHOLE *(*sparsity_in)(WHOLE), *(*sparsity_out)(WHOLE);
    WHOLE (*n_in)(void), (*n_out)(void);
} external;
#define DECLARE(f) int f(const double **, double **, WHOLE *, double *, MEMORY); \\
    int f##_work(WHOLE *, WHOLE *, WHOLE *, WHOLE *); \\
    const WHOLE *f##_sparsity_in(WHOLE), *f##_sparsity_out(WHOLE); WHOLE f##_n_in(void), f##_n_out(void);
#define LIST(f) {f, f##_work, f##_sparsity_in, f##_sparsity_out, f##_n_in, f##_n_out},
FUNCTIONS(DECLARE)
static const external functions[] = {FUNCTIONS(LIST)};
/* Entries of a pattern: dense by columns where its third number is 1, else rows of each column. */
static WHOLE entries(const WHOLE *s) { return s[2] == 1 ? s[0] * s[1] : s[2 + s[1]]; }
enum { BEHIND = 1000 }; /* numbers behind the scratch, which no function may write */
int main(void) {
    size_t f;
    for (f = 0; f < sizeof functions / sizeof *functions; ++f) {
        const external *each = &functions[f];
        WHOLE guard[6] = {-7, 0, 0, 0, 0, -7}, i, k; /* numbers of another size would be written over the guards */
        const double **in;
        double **out, *work;
        WHOLE *iw;
        if (each->work(guard + 1, guard + 2, guard + 3, guard + 4) || guard[0] != -7 || guard[5] != -7) return 1;
        in = calloc((size_t)guard[1] + 1, sizeof *in), out = calloc((size_t)guard[2] + 1, sizeof *out);
        iw = calloc((size_t)guard[3] + 1, sizeof *iw), work = calloc((size_t)guard[4] + BEHIND, sizeof *work);
        for (k = 0; k < BEHIND; ++k) work[guard[4] + k] = -7.0;
        for (i = 0; i < each->n_in(); ++i) {
            const WHOLE n = entries(each->sparsity_in(i));
            double *x = calloc((size_t)n + 1, sizeof *x);
            for (k = 0; k < n; ++k)
                if (scanf("%lf", x + k) != 1) return 2;
            in[i] = x;
        }
        for (i = 0; i < each->n_out(); ++i) out[i] = calloc((size_t)entries(each->sparsity_out(i)) + 1, sizeof **out);
        if (each->fun(in, out, iw, work, 0)) return 3;
        for (k = 0; k < BEHIND; ++k)
            if (work[guard[4] + k] != -7.0) return 4;
        for (i = 0; i < each->n_out(); ++i) {
            const WHOLE *s = each->sparsity_out(i), *colind = s + 2, *row = colind + s[1] + 1;
            WHOLE c, at = 0;
            printf("%ld %ld", (long)s[0], (long)s[1]);
            for (c = 0; c < s[1]; ++c)
                for (k = s[2] == 1 ? 0 : colind[c]; k < (s[2] == 1 ? s[0] : colind[c + 1]); ++k)
                    printf(" %ld %ld %.17g", (long)(s[2] == 1 ? k : row[k]), (long)c, out[i][at++]);
            printf("\\n");
        }
    }
    return 0;
}
"""
# Types of whole numbers and of the memory's argument.
ACADOS, CASADI = ("int", "void *"), ("long long", "int")


@pytest.fixture(scope="module")
def model() -> sf.Model:
    return sf.compile(MODELS["cart_pole"])


@pytest.fixture(scope="module")
def dynamics() -> Any:
    return sf.interop.casadi.Dynamics(MODELS["cart_pole"], frames=["tip"])


def called(
    folder: Path, link: Sequence[str], types: tuple[str, str], functions: dict[str, list[np.ndarray]]
) -> list[np.ndarray]:
    """All outputs of some functions, one after the other, by the program."""
    compiler = shutil.which("cc") or pytest.skip("needs a program called cc")
    listed = f"#define FUNCTIONS(each) {' '.join(f'each({name})' for name in functions)}"
    text = PROGRAM.replace("WHOLE", types[0]).replace("MEMORY", types[1])
    (folder / "main.c").write_text(f"{listed}\n{text}")
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


@pytest.mark.parametrize("types", [ACADOS, CASADI], ids=["acados", "casadi"])
def test_functions_and_derivatives_by_the_c_interface(dynamics: Any, types: tuple[str, str], tmp_path: Path) -> None:
    """The values and patterns that CasADi reads itself, of every function of the library."""
    if types == ACADOS:
        name = dynamics.write_acados_library(tmp_path / "library")
        link = [f"-L{tmp_path / 'library'}", f"-l{name}", f"-Wl,-rpath,{tmp_path / 'library'}"]
    else:
        link = [str(dynamics.library), f"-Wl,-rpath,{dynamics.library.parent}"]
    rng, functions, right = np.random.default_rng(8), {}, []
    for own in dynamics.names.values():
        for prefix in ("", "jac_", "adj1_", "jac_jac_", "jac_adj1_"):
            function = casadi.external(f"{prefix}{own}", str(dynamics.library))
            given = [rng.uniform(0.5, 1.0, function.nnz_in(i)) for i in range(function.n_in())]
            functions[f"{prefix}{own}"] = given
            right += function.call([casadi.DM(function.sparsity_in(i), each) for i, each in enumerate(given)])
    found = called(tmp_path, link, types, functions)
    assert len(found) == len(right)
    for ours, theirs in zip(found, right, strict=True):
        np.testing.assert_array_equal(ours, np.array(theirs))


@pytest.mark.parametrize("name", ["cart_pole", "hopper"])
def test_what_acados_generates_of_the_dynamics(name: str, tmp_path: Path) -> None:
    """x' = f(x, u, p), its sensitivities and its Hessian, as acados states them for explicit integrators."""
    system = MODELS[name] if name in MODELS else SYSTEMS[name]()
    model, dynamics = (
        sf.compile(system),
        sf.interop.casadi.Dynamics(system, frames=["tip" if name in MODELS else "toe"]),
    )
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
    found = called(tmp_path, link, ACADOS, functions)
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
