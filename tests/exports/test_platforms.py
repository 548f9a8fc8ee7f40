"""The C package on other machines: cross-built by zig, run under qemu."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import STARTS, STRICT, need, relative, run, sources, system_of, trajectory
from tests.models import sampled

# zig's target -> the emulator that runs it; s390x is big-endian, arm has pointers of 32 bits and unsigned characters.
EMULATORS = {
    "aarch64-linux-musl": "qemu-aarch64",
    "arm-linux-musleabihf": "qemu-arm",
    "s390x-linux-musl": "qemu-s390x",
}
# zig's target -> the first bytes of its objects, and of its programs.
FORMATS = {
    "aarch64-linux-musl": (b"\x7fELF", b"\x7fELF"),
    "x86_64-windows-gnu": (b"\x64\x86", b"MZ"),
    "aarch64-macos": (b"\xcf\xfa\xed\xfe", b"\xcf\xfa\xed\xfe"),
}
# Another C library's sine and cosine.
LIBM = 1e-11


def exported(folder: Path, target: str) -> tuple[str, ...]:
    """The package of a loop in a folder; the compiler for a target, as strict as for this machine."""
    sf.export(system_of("four_bar"), "c", folder, start=STARTS["four_bar"])
    return sys.executable, "-m", "ziglang", "cc", "-target", target, *STRICT, "-O2"


@pytest.mark.tools
@pytest.mark.parametrize("target", FORMATS)
def test_the_package_compiles_for_other_machines(tmp_path: Path, target: str) -> None:
    """With their headers; zig compiles their C libraries only where a program is linked, which takes a minute."""
    command = exported(tmp_path, target)
    for source in sources(tmp_path):
        run(*command, "-c", source, "-o", "part.o", cwd=tmp_path)
        assert (tmp_path / "part.o").read_bytes().startswith(FORMATS[target][0]), source


@pytest.mark.tools
@pytest.mark.slow  # In every run with tools: objects for these machines.
@pytest.mark.parametrize("target", [target for target in FORMATS if target not in EMULATORS])
def test_programs_of_other_machines_are_linked(tmp_path: Path, target: str) -> None:
    run(*exported(tmp_path, target), "-o", "example", *sources(tmp_path), "-lm", cwd=tmp_path)
    assert (tmp_path / "example").read_bytes().startswith(FORMATS[target][1])


@pytest.mark.tools
@pytest.mark.parametrize("target", sampled(tuple(EMULATORS), ("arm-linux-musleabihf", "s390x-linux-musl")))
def test_other_machines_move_as_python_does(tmp_path: Path, target: str) -> None:
    need(EMULATORS[target])
    run(*exported(tmp_path, target), "-o", "example", *sources(tmp_path), "-lm", cwd=tmp_path)
    lines = [line.split() for line in run(EMULATORS[target], "./example", "0.2", "--fast", cwd=tmp_path).splitlines()]
    reported = {words[0]: np.array(list(map(float, words[1:]))) for words in lines if words[0] in ("selftest", "q")}
    assert reported["selftest"][0] < 1e-9
    assert relative(reported["q"], trajectory("four_bar", 0.2).q[-1]) < LIBM
