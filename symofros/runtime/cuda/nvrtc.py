"""CUDA text -> machine code of one architecture, by NVRTC, the compiler in packages of NVIDIA and in CUDA's toolkit.

No driver and no graphics processor take part, so that what a kernel takes is known where there is none.
"""

from __future__ import annotations

import ctypes
import re
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from symofros.errors import CompileError

_ARCHITECTURE = re.compile(r"sm_\d{2,3}a?")
# What `ptxas -v` says of each entry: its own frame, then that of the functions that it calls.
_ENTRY = re.compile(r"Compiling entry function '(?P<name>\w+)'(?P<rest>(?:(?!Compiling entry function).)*)", re.DOTALL)
_REGISTERS = re.compile(r"Used (\d+) registers")
_STACK = re.compile(r"(\d+) bytes cumulative stack size")
_STORES, _LOADS = re.compile(r"(\d+) bytes spill stores"), re.compile(r"(\d+) bytes spill loads")
# Versions of CUDA whose NVRTC is looked for.
_VERSIONS = (12, 13)
_FIRST_WITH_CACHE = (12, 9)
# Lines of the compiler's message that an error shows.
_SHOWN = 6


@dataclass(frozen=True)
class KernelUsage:
    """Resources that a kernel takes per thread, as the assembler (`ptxas -v`) reports them.

    Attributes:
        registers: Registers of 32 bits; 255 are all that there are.
        stack: Local memory of the deepest call [bytes].
        spill_stores: Bytes stored to local memory because registers ran out, in the kernel and the functions it calls.
        spill_loads: Bytes loaded again.
    """

    registers: int
    stack: int
    spill_stores: int
    spill_loads: int


def compile_cuda(text: str, architecture: str, contract: bool = False) -> bytes:
    """Compile CUDA C++ to the contents of a cubin.

    Args:
        text: Source that includes nothing.
        architecture: Such as "sm_90".
        contract: Whether products and sums are fused, which rounds otherwise than the C code does.

    Raises:
        CompileError: NVRTC is not installed, knows no such architecture, or refuses the text.
    """
    return _compiled(text, architecture, contract, [])[0]


def usage_of(text: str, architecture: str, contract: bool = False) -> dict[str, KernelUsage]:
    """Resources of each kernel of a CUDA C++ text, by name; arguments and errors as of `compile_cuda`."""
    # NVRTC from 12.9 on returns what its cache holds without the assembler's words.
    options = ["--no-cache"] if _version(_library()) >= _FIRST_WITH_CACHE else []
    log = _compiled(text, architecture, contract, ["--ptxas-options=-v", *options])[1]
    return {match["name"]: _usage(match["rest"]) for match in _ENTRY.finditer(log)}


def _compiled(text: str, architecture: str, contract: bool, more: list[str]) -> tuple[bytes, str]:
    """A cubin, and the compiler's words."""
    if not _ARCHITECTURE.fullmatch(architecture):
        raise CompileError(
            f"CUDA: no architecture '{architecture:.40}'",
            repr(architecture)[:60],
            "an architecture is 'sm_' and a compute capability, such as 'sm_90'",
            "leave it out where a graphics processor is at hand",
        )
    nvrtc, program = _library(), ctypes.c_void_p()
    options = [f"-arch={architecture}", f"-fmad={str(contract).lower()}", "-std=c++17", *more]
    given = (ctypes.c_char_p * len(options))(*(option.encode() for option in options))
    if nvrtc.nvrtcCreateProgram(ctypes.byref(program), text.encode(), b"kernels.cu", 0, None, None):
        raise _failed(architecture, "NVRTC takes no program")
    try:
        failed = nvrtc.nvrtcCompileProgram(program, len(options), given)
        log = _text(nvrtc, "ProgramLog", program).rstrip(b"\0").decode(errors="replace")
        if failed:
            raise _failed(architecture, "; ".join(log.strip().splitlines()[:_SHOWN]) or f"NVRTC error {failed}")
        return _text(nvrtc, "CUBIN", program), log
    finally:
        nvrtc.nvrtcDestroyProgram(ctypes.byref(program))


def _usage(text: str) -> KernelUsage:
    """Resources of a kernel, from the part of the assembler's log after its name."""
    registers, stack = _REGISTERS.search(text), _STACK.search(text)
    return KernelUsage(
        int(registers[1]) if registers else 0,
        int(stack[1]) if stack else 0,
        sum(map(int, _STORES.findall(text))),
        sum(map(int, _LOADS.findall(text))),
    )


def _text(nvrtc: ctypes.CDLL, what: str, program: ctypes.c_void_p) -> bytes:
    """One result of a program, by its size and then its content."""
    size = ctypes.c_size_t()
    getattr(nvrtc, f"nvrtcGet{what}Size")(program, ctypes.byref(size))
    content = ctypes.create_string_buffer(size.value)
    getattr(nvrtc, f"nvrtcGet{what}")(program, content)
    return content.raw


def _version(nvrtc: ctypes.CDLL) -> tuple[int, int]:
    major, minor = ctypes.c_int(), ctypes.c_int()
    nvrtc.nvrtcVersion(ctypes.byref(major), ctypes.byref(minor))
    return major.value, minor.value


@cache
def _library() -> ctypes.CDLL:
    """NVRTC of a package (nvidia-cuda-nvrtc-cu12, or nvidia-cuda-nvrtc of CUDA 13), or of the system."""
    spec = find_spec("nvidia")
    places = map(Path, (spec.submodule_search_locations or ()) if spec else ())
    packaged = [str(path) for place in places for path in sorted(place.glob("*/lib/libnvrtc.so.*"))]
    for name in (*packaged, *(f"libnvrtc.so.{version}" for version in _VERSIONS)):
        try:
            _load_builtins(Path(name).parent)
            return ctypes.CDLL(name)
        except OSError:
            continue
    raise CompileError.of_extra(
        "CUDA: no compiler",
        f"no package of NVIDIA that has NVRTC, nor libnvrtc.so of CUDA {' or '.join(map(str, _VERSIONS))}",
        "kernels are compiled by NVRTC, which needs no graphics processor",
        "cuda",
    )


def _load_builtins(folder: Path) -> None:
    """Load the library that NVRTC of CUDA 13.0 looks for in the system's places alone, from where NVRTC lies."""
    for path in folder.glob("libnvrtc-builtins.so.*"):
        ctypes.CDLL(str(path), ctypes.RTLD_GLOBAL)


def _failed(architecture: str, found: str) -> CompileError:
    return CompileError(
        f"CUDA: the kernels do not compile for {architecture}",
        found,
        "NVRTC compiles generated kernels for each architecture that it knows",
        "choose another architecture, or install a newer NVRTC",
    )
