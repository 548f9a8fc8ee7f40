"""States of forces in exports of code: the last speeds, the numbers of `sf.simulate` (docs/theory/states.md, (2))."""

from __future__ import annotations

import json
import shutil
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.cuda_on_host import PLAIN, SHIM, WARNINGS
from tests.exports.c.test_sfunction import HEADERS, ports
from tests.exports.cases import build, need, run

_LUGRE = sf.LuGre(2.0, 3e3, 20.0, static=3.0, stribeck_velocity=0.05, viscous=0.3)
_BODY = sf.RigidBody(
    "b", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(_LUGRE, sf.Hysteresis(80.0, 1.0), sf.Spring(200.0)),
                  actuated=True), sf.Inertia(1.5))  # fmt: skip
RUBBING = sf.System("rubbing", (_BODY,))
START = {"x": 0.1, "dx": 1.0, "x.bristle": 2e-4, "x.slip": -1e-3}
NOTE = (
    "states of forces are the last speeds, their rates the last accelerations, beside idle coordinates:"
    " x.bristle, x.slip"
)
STEP, END = 1e-4, 0.2
# By the same C under other flags, through a motion that sticks and slips.
SAME = 1e-10


@cache
def model() -> sf.Model:
    return sf.compile(RUBBING)


@cache
def end() -> np.ndarray:
    """q, v and z at the end by `sf.simulate`."""
    z0 = [START["x.bristle"], START["x.slip"]]
    run_ = sf.simulate(model(), [START["x"]], [START["dx"]], END, z0=z0, dt=STEP, u=[0.7], method="rk4")
    return np.concatenate([run_.q[-1], run_.v[-1], run_.z[-1]])


def of_carried(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """q, v and z of a state as exports have it; what else there is are integrals."""
    assert len(q) == len(v) == 3
    return np.concatenate([q[:1], v])


@cache
def state() -> tuple[np.ndarray, np.ndarray]:
    """q (3) and v (3) of a state with bristles bent."""
    return np.array([0.03, 0.4, -0.7]), np.array([0.02, 3e-4, 2e-3])


def wanted_rates() -> np.ndarray:
    """v', then z', at that state under 0.7 N."""
    q, v = state()
    given = (q[:1], v[:1], [0.7])
    return np.concatenate([model().forward_dynamics(*given, z=v[1:]), model().state_rates(*given, z=v[1:])])


def test_the_block_of_simulink_moves_as_simulate(tmp_path: Path) -> None:
    done = sf.export(RUBBING, "sfunction", tmp_path / "rubbing", start=START)
    assert NOTE in done.notes
    build(tmp_path / "rubbing", "../block", "symoSFunction.c", "rubbing.c", "rubbing_plant.c", "symofros_stepper.c",
          include=HEADERS)  # fmt: skip
    q, v = state()
    words = [repr(float(x)) for x in (*q, *v, 0.7)]
    M, gnl = ports(run("./block", "rubbing", "dynamics", "0", "1", *words, cwd=tmp_path))
    np.testing.assert_allclose(M.reshape(3, 3), np.diag([1.5, 1.0, 1.0]))
    np.testing.assert_allclose(gnl / [1.5, 1.0, 1.0], wanted_rates(), rtol=1e-12)
    found = ports(run("./block", "rubbing", "direct_dynamics", str(END), str(STEP), cwd=tmp_path))
    z0 = [START["x.bristle"], START["x.slip"]]
    wanted = sf.simulate(model(), [START["x"]], [START["dx"]], END, z0=z0, dt=STEP, method="rk4")
    moved = np.concatenate([wanted.q[-1], wanted.v[-1], wanted.z[-1]])
    np.testing.assert_allclose(of_carried(found[0], found[1]), moved, rtol=0, atol=SAME)


def test_the_function_of_matlab_answers_as_python(tmp_path: Path) -> None:
    """By a stub of mex.h: accelerations with the rates behind them, energies, and a simulation."""
    done = sf.export(RUBBING, "mex", tmp_path, name="arm", start=START)  # What the stub asks is so named.
    assert NOTE in done.notes and NOTE in (tmp_path / "arm.m").read_text()
    here = Path(__file__).parent / "c"
    shutil.copy(here / "mex_stub.h", tmp_path / "mex.h")
    shutil.copy(here / "mex_ask.c", tmp_path / "main.c")
    flags = ("-std=c99", "-O0", "-Wall", "-Wno-unused-function")
    run("gcc", *flags, "-I.", "main.c", "-lm", "-o", "ask", cwd=tmp_path)
    q, v = state()
    x = np.concatenate([q, v])

    def ask(outputs: int, *arguments: list[float] | np.ndarray) -> list[np.ndarray]:
        words = [f"{len(a)} 1 " + " ".join(repr(float(e)) for e in a) for a in arguments]
        command = ["sh", "-c", f"echo '{len(words)} {outputs} {' '.join(words)}' | ./ask"]
        return [np.array(line.split()[2:], dtype=np.float64) for line in run(*command, cwd=tmp_path).splitlines()]

    (rates,) = ask(1, [2.0], x, [0.7])
    np.testing.assert_allclose(rates, wanted_rates(), rtol=1e-12)
    T, V = ask(2, [7.0], x, [0.7])
    np.testing.assert_allclose(T, model().kinetic_energy(q[:1], v[:1]))
    np.testing.assert_allclose(V, model().potential_energy(q[:1], z=v[1:]), rtol=1e-12)


@pytest.mark.tools
def test_octave_simulates_them(tmp_path: Path) -> None:
    need("octave-cli", "mkoctfile")
    sf.export(RUBBING, "mex", tmp_path, start=START, dt=STEP)
    code = (
        f"build_rubbing; [d, s] = rubbing(0); [T, X] = rubbing(9, s.X0, 0.7, [], [0 {END} {STEP}]);"
        " printf(' %.17g', d.nz, X(end, :)); printf(' %s', s.v_names{:});"
    )
    words = run("octave-cli", "-qf", "--eval", code, cwd=tmp_path).split()
    x = np.array(words[1:7], dtype=np.float64)
    assert words[0] == "2" and words[7:] == ["x", "x.bristle", "x.slip"]
    np.testing.assert_allclose(of_carried(x[:3], x[3:]), end(), rtol=0, atol=SAME)


@pytest.mark.tools
def test_a_module_of_webassembly_has_them(tmp_path: Path) -> None:
    """Names, rates and a motion under Node."""
    need("node")
    done = sf.export(RUBBING, "wasm", tmp_path, start=START, dt=STEP)
    assert NOTE in done.notes
    q, v = (x.tolist() for x in state())
    (tmp_path / "ask.mjs").write_text(f"""
import {{ load }} from "./rubbing.mjs";
const model = await load(), moving = model.instance();
const {{ a }} = model.evaluate("forward_dynamics", {{ q: {q}, v: {v}, u: [0.7] }});
moving.u[0] = 0.7;
for (let k = 1; k <= {round(END / STEP)}; ++k) moving.advance(k * {STEP}, {STEP});
console.log(JSON.stringify({{ z: model.names.z, nz: model.sizes.nz, a: [...a], q: [...moving.q], v: [...moving.v] }}));
""")
    found = json.loads(run("node", "ask.mjs", cwd=tmp_path))
    assert found["z"] == ["x.bristle", "x.slip"] and found["nz"] == 2
    np.testing.assert_allclose(found["a"], wanted_rates(), rtol=1e-12)
    np.testing.assert_allclose(of_carried(np.array(found["q"]), np.array(found["v"])), end(), rtol=0, atol=SAME)
    run("node", "selftest.mjs", cwd=tmp_path)


_KERNELS = """
#include <cstdio>
int main() {
    double pre[8] = {0}, q[3] = {Q}, v[3] = {V}, u[1] = {0.7}, t[1] = {0.0}, a[3], lam[1], q1[3], v1[3];
    const auto whole = [](double *at) { return sym_strided{at, 1, 1}; };
    const unsigned block = SYM_BLOCK, grid = 1;
    SYM_THREADS(rubbing_forward_dynamics(1, pre, CALL));
    for (double x : a) std::printf("%.17g ", x);
}
"""


def test_kernels_have_rates_among_the_accelerations(tmp_path: Path) -> None:
    """Kernels as loops over threads, compiled for the host."""
    done = sf.export(RUBBING, "cuda", tmp_path / "gpu")
    assert NOTE in done.notes
    q, v = state()
    text = (tmp_path / "gpu" / "rubbing_double.cu").read_text()
    header = (tmp_path / "gpu" / "rubbing_cuda.h").read_text()
    declared = next(line for line in header.splitlines() if "int rubbing_forward_dynamics_launch" in line)
    named = [word.split()[-1].rstrip(");") for word in declared.split("pre, ")[1].split(",")]
    call = ", ".join(f"whole({name})" for name in named)
    main = _KERNELS.replace("Q", ", ".join(map(repr, q.tolist()))).replace("V", ", ".join(map(repr, v.tolist())))
    kernels = tmp_path / "kernels.cpp"
    kernels.write_text(f'#include "{SHIM}"\n{PLAIN}\n{text}\n{main.replace("CALL", call)}')
    run("g++", "-std=c++17", "-O0", "-ffp-contract=off", *WARNINGS, "-Wno-unused-variable", f"-I{tmp_path / 'gpu'}",
        kernels, "-lm", "-o", tmp_path / "example", cwd=tmp_path)  # fmt: skip
    np.testing.assert_allclose(
        [float(x) for x in run(tmp_path / "example", cwd=tmp_path).split()], wanted_rates(), rtol=1e-12
    )
