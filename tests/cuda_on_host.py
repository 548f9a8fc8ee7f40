"""Kernels compiled as C++ of the host, thread after thread, so that their numbers are tested without a GPU."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest

from symofros.runtime.cuda import cuda_model
from symofros.runtime.cuda.device_code import DeviceCode
from symofros.runtime.cuda.driver import Driver
from tests.late import needs_program, with_utilities

SHIM = Path(__file__).parent / "cuda_shim.h"
_DRIVER = Path(__file__).parent / "runtime/cuda/driver_on_host.c"
# As the C code is compiled: products and sums are not fused, so that results agree bit for bit.
WARNINGS = ("-Wall", "-Wextra", "-Werror", "-Wno-unknown-pragmas")
FLAGS = ("-x", "c++", "-std=c++17", "-O0", "-ffp-contract=off", "-fPIC", "-shared", *WARNINGS)
# Of an inline function that nothing calls nvcc warns, and g++ does not.
PLAIN = "#define inline"
_STRIDED, _SEQUENCE = "sym_strided", "sym_sequence"
_ROLLOUT = ("long long", "long long", "double", *(_STRIDED,) * 2, _SEQUENCE, _STRIDED, *(_SEQUENCE,) * 2)


class Strided(ctypes.Structure):
    _fields_ = [("at", ctypes.c_void_p), ("step", ctypes.c_ssize_t), ("stride", ctypes.c_ssize_t)]


class Sequence(ctypes.Structure):
    _fields_ = [("batch", Strided), ("next", ctypes.c_ssize_t)]


def launcher(symbol: str, types: tuple[str, ...]) -> str:
    """C++ that launches a kernel with arguments by address."""
    values = ["*(long long *)p[0]", "*(const sym_p **)p[1]"]
    values += [f"*({kind} *)p[{i}]" for i, kind in enumerate(types, 2)]
    return (
        f'extern "C" void {symbol}_on_host(unsigned grid, unsigned block, void **p) {{'
        f" SYM_THREADS({symbol}({', '.join(values)})); }}"
    )


def on_host(code: DeviceCode, folder: Path) -> Path:
    """A library of the kernels, each with a launcher."""
    launchers = [
        launcher(k.symbol, (_STRIDED,) * (len(k.signature.inputs) + len(k.signature.outputs))) for k in code.kernels
    ]
    launchers += [launcher(symbol, _ROLLOUT) for symbol in code.rollouts.values()]
    source = folder / f"{code.precision}.cu"
    source.write_text("\n".join([f'#include "{SHIM}"', PLAIN, code.text, *launchers]))
    library = source.with_suffix(".so")
    needs_program("g++")
    subprocess.run(["g++", *FLAGS, source, "-o", library], check=True, env=with_utilities())
    return library


def host_driver(folder: Path) -> Driver:
    """A driver whose processor is the host."""
    library = folder / "libcuda.so.1"
    subprocess.run(["gcc", "-shared", "-fPIC", _DRIVER, "-o", library, "-ldl"], check=True)
    return Driver(ctypes.CDLL(str(library)))


def compile_on_host(patch: pytest.MonkeyPatch, driver: Driver, folder: Path) -> None:
    """Models on a graphics processor take this driver, and their kernels are compiled as C++ of the host."""
    known: dict[str, Path] = {}
    code = cuda_model.CudaModel.code

    def seen(self: cuda_model.CudaModel, name: str, frame: str = "") -> DeviceCode:
        found = code(self, name, frame)
        if found.text not in known:
            place = folder / str(len(known))
            place.mkdir()
            known[found.text] = on_host(found, place)
        return found

    patch.setattr(cuda_model.CudaModel, "code", seen)
    patch.setattr(cuda_model, "driver", lambda: driver)
    patch.setattr(cuda_model, "compile_cuda", lambda text, *_: str(known[text]).encode() + b"\0")


def launch(library: ctypes.CDLL, symbol: str, n: int, pre: np.ndarray, *arguments: object, block: int = 32) -> None:
    given = [ctypes.c_longlong(n), ctypes.c_void_p(pre.ctypes.data), *arguments]
    addresses = (ctypes.c_void_p * len(given))(*(ctypes.addressof(x) for x in given))
    getattr(library, f"{symbol}_on_host")(-(-n // block), block, addresses)


def strided(array: np.ndarray) -> Strided:
    """An array (n, ...) whose entries of a state lie at equal distances."""
    entry = array.strides[-1] if array.ndim > 1 else array.itemsize
    return Strided(array.ctypes.data, entry // array.itemsize, array.strides[0] // array.itemsize)
