"""Functions of a package with named arguments: in C, and on Eigen's maps in C++, the numbers of the interpreter."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import STRICT, run
from tests.late import needs_extra
from tests.models import GUESSES, model, system

NAMES = ("double_pendulum", "four_bar")
SHOW = """
#include <stdio.h>
static void show(int n, const double *x) { for (int i = 0; i < n; ++i) printf("%.17g ", x[i]); printf("\\n"); }
"""
C = Path(__file__).with_name("typed.c.in").read_text()
CPP = Path(__file__).with_name("typed.cpp.in").read_text()


@pytest.fixture(scope="module", params=NAMES)
def package(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    folder = tmp_path_factory.mktemp("typed")
    start = dict(zip(model(request.param).names.q, GUESSES.get(request.param, ()), strict=False))
    sf.export(system(request.param), "c", folder, start=start)
    return request.param, folder


def program(text: str, name: str, folder: Path, q: np.ndarray, file: str) -> None:
    text = text.replace("SHOW", SHOW).replace("NAME_N", f"{name.upper()}_N").replace("NAME", name)
    start = f"static const double Q_START[] = {{{', '.join(map(repr, q.tolist()))}}};\n"
    (folder.parent / file).write_text(start + text)


def printed(folder: Path) -> list[np.ndarray]:
    return [np.array(line.split(), dtype=float) for line in run("./example", cwd=folder.parent).splitlines()]


def check(name: str, q: np.ndarray, found: list[np.ndarray]) -> None:
    v = 0.1 * (np.arange(model(name).nv) + 1)
    wanted = (model(name).mass_matrix(q).ravel(), model(name).bias(q, v), [model(name).kinetic_energy(q, v)])
    for ours, theirs in zip(found, wanted, strict=True):
        assert np.abs(ours - theirs).max() <= 1e-13 * max(1.0, np.abs(theirs).max())


def configuration(name: str) -> np.ndarray:
    return model(name).random_state(np.random.default_rng(2))[0]


def test_c_calls_functions_with_named_arguments(package: tuple[str, Path]) -> None:
    name, folder = package
    q = configuration(name)
    program(C, name, folder, q, "main.c")
    sources = (folder / f"{name}.c", folder.parent / "main.c")
    run("gcc", *STRICT, "-O0", f"-I{folder}", *sources, "-lm", "-o", "example", cwd=folder.parent)
    check(name, q, printed(folder))


def test_cpp_functions_return_eigen_maps(package: tuple[str, Path]) -> None:
    name, folder = package
    spec = importlib.util.find_spec("cmeel")
    eigen = Path(spec.origin or "").parents[1] / "cmeel.prefix/include/eigen3" if spec else Path("/none")
    if not (eigen / "Eigen").is_dir():
        pytest.skip(needs_extra("timing", "cmeel-eigen"))
    q = configuration(name)
    program(CPP, name, folder, q, "main.cpp")
    run("gcc", "-std=c99", "-O0", "-c", folder / f"{name}.c", "-o", "model.o", cwd=folder.parent)
    flags = ("-std=c++14", "-O0", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{folder}", "-isystem", eigen)
    run("g++", *flags, "main.cpp", "model.o", "-lm", "-o", "example", cwd=folder.parent)
    check(name, q, printed(folder))
