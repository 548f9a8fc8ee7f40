"""CUDA kernels: as C++ of the host they give the numbers of the C code, and roll out as `simulate` does."""

from __future__ import annotations

import ctypes
from functools import cache
from math import prod

import numpy as np
import pytest

import symofros as sf
from symofros.base.options import Options
from symofros.compiler import GENERATOR, Compilation
from symofros.expr.numerics.trigonometry import FAR
from symofros.generator.codegen.cuda import device_code
from symofros.mechanics.topology.tree import build_tree
from symofros.runtime.calls.kernel import Precision
from symofros.runtime.cuda.device_code import DeviceCode
from tests.cuda_on_host import Sequence, launch, on_host, strided
from tests.models import model, system

FUNCTIONS = ("dynamics", "inverse_dynamics", "forward_dynamics", "frame_pose", "frame_jacobian")
DERIVATIVES = ("forward_dynamics_derivatives", "inverse_dynamics_derivatives")
# Two angles and run-time parameters; a free base with branches; a ball joint.
MODELS = ("double_pendulum", "space_arm", "heavy_top")
N = 37
TYPES: dict[Precision, type] = {"double": np.float64, "single": np.float32}
# Of the largest entry: floats carry seven digits, and solving for accelerations takes some of them.
CLOSE: dict[Precision, float] = {"double": 1e-12, "single": 2e-4}


@cache
def compilation(name: str) -> Compilation:
    functions = FUNCTIONS + DERIVATIVES * (name == "double_pendulum")  # The same text, long for others.
    return Compilation(system(name), Options(functions, (build_tree(system(name)).frames[-1].name,)))


@pytest.fixture(scope="module", params=[(name, "double") for name in MODELS] + [("space_arm", "single")])
def compiled(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[str, DeviceCode, ctypes.CDLL]:
    name, precision = request.param
    made = compilation(name)
    code = device_code(made.program, made.record, GENERATOR, precision)
    return name, code, ctypes.CDLL(str(on_host(code, tmp_path_factory.mktemp("kernels"))))


def states(name: str) -> dict[str, np.ndarray]:
    rng, of = np.random.default_rng(5), model(name)
    q, v = map(np.array, zip(*(of.random_state(rng) for _ in range(N)), strict=True))
    a, u = rng.standard_normal((N, of.nv)), rng.standard_normal((N, of.nu))
    return {"q": q, "v": v, "a": a, "u": u, "t": np.full((N, 1), 0.25)}


def columns(array: np.ndarray, dtype: type) -> np.ndarray:
    return np.asfortranarray(array, dtype=dtype)


def prepared(name: str, dtype: type) -> np.ndarray:
    kernel = compilation(name).interpreted_model().kernel("dynamics")
    pre = kernel.prepare(np.array([compilation(name).record.par_default]))
    return np.ascontiguousarray(pre[0] if pre.size else np.zeros(1), dtype=dtype)


def test_kernels_give_the_numbers_of_the_c_code(compiled: tuple[str, DeviceCode, ctypes.CDLL]) -> None:
    """Every operation is one of IEEE in the same order: bit for bit in double precision."""
    name, code, library = compiled
    given, dtype = states(name), TYPES[code.precision]
    reference = compilation(name).interpreted_model()
    assert {*FUNCTIONS} <= {kernel.signature.name for kernel in code.kernels}
    for kernel in code.kernels:
        signature = kernel.signature
        inputs = [columns(given[group], dtype) for group, _ in signature.inputs]
        outputs = [columns(np.full((N, prod(shape)), np.nan), dtype) for _, shape in signature.outputs]
        launch(library, kernel.symbol, N, prepared(name, dtype), *map(strided, [*inputs, *outputs]))
        named = {group: given[group] for group, _ in signature.inputs}
        if "t" in named:
            named["t"] = given["t"][:, 0]
        wanted = reference.evaluate(signature.name, signature.frame, **named)
        for output, expected in zip(outputs, wanted, strict=True):
            expected = np.asarray(expected).reshape(N, -1)
            if code.precision == "double":
                assert np.array_equal(output, expected), signature.name
            scale = max(np.abs(expected).max(initial=0.0), 1e-300)
            assert np.abs(output - expected).max(initial=0.0) <= CLOSE[code.precision] * scale, signature.name


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler"])
def test_rollouts_step_as_simulate_does(compiled: tuple[str, DeviceCode, ctypes.CDLL], method: str) -> None:
    name, code, library = compiled
    of, given, dtype = model(name, "c"), states(name), TYPES[code.precision]
    steps, every, dt, records = 12, 4, 2e-3, 3
    q = np.full((records, of.nq, N), np.nan, dtype)
    v = np.full((records, of.nv, N), np.nan, dtype)
    inputs = np.zeros((steps, max(1, of.nu), N), dtype)
    inputs[:, : of.nu] = given["u"].T

    def sequence(array: np.ndarray) -> Sequence:
        return Sequence(strided(array[0].T), array[0].size)

    kept = [columns(given[group], dtype) for group in "qv"]
    start = [strided(array) for array in kept]
    time = np.zeros((1, 1), dtype)
    arguments = [ctypes.c_longlong(steps), ctypes.c_longlong(every), ctypes.c_double(dt), *start, sequence(inputs)]
    shared_time = strided(time)
    shared_time.stride = 0
    launch(library, code.rollouts[method], N, prepared(name, dtype), *arguments, shared_time, sequence(q), sequence(v))
    for state in (0, N - 1):
        run = sf.simulate(
            of,
            given["q"][state],
            given["v"][state],
            steps * dt,
            u=given["u"][state],
            method=method,
            dt=dt,
            every=every,
        )
        for ours, theirs in ((q[:, :, state], run.q[1:]), (v[:, :, state], run.v[1:])):
            assert np.abs(ours - theirs).max() <= CLOSE[code.precision] * max(1.0, np.abs(theirs).max())


def test_large_angles_use_the_device_library(tmp_path_factory: pytest.TempPathFactory) -> None:
    """The polynomials hold to FAR; the library of the device takes over beyond."""
    made = compilation("double_pendulum")
    code = device_code(made.program, made.record, GENERATOR, "double")
    library = ctypes.CDLL(str(on_host(code, tmp_path_factory.mktemp("far"))))
    kernel = next(k for k in code.kernels if k.signature.name == "frame_jacobian")
    q = columns(np.array([[0.0, 0.0], [3 * FAR, -7 * FAR], [np.inf, 0.0]]), np.float64)
    J = columns(np.zeros((3, 12)), np.float64)
    launch(library, kernel.symbol, 3, prepared("double_pendulum", np.float64), strided(q), strided(J))
    wanted = np.asarray(model("double_pendulum").frame_jacobian(kernel.signature.frame, q[:2])).reshape(2, -1)
    assert np.abs(J[:2] - wanted).max() < 1e-12
    assert np.isnan(J[2]).any()
