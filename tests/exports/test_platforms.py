"""The C package on other machines: cross-built by zig, run under qemu."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import STARTS, STRICT, need, relative, run, sources, system_of, trajectory

# zig's target -> the emulator that runs it; s390x is big-endian, arm has pointers of 32 bits.
TARGETS = {
    "aarch64-linux-musl": "qemu-aarch64",
    "arm-linux-musleabihf": "qemu-arm",
    "s390x-linux-musl": "qemu-s390x",
    "x86_64-windows-gnu": None,
    "aarch64-macos": None,
}
# Another C library's sine and cosine.
LIBM = 1e-11


@pytest.mark.tools
@pytest.mark.parametrize("target", TARGETS)
def test_other_machines(tmp_path: Path, target: str) -> None:
    sf.export(system_of("four_bar"), "c", tmp_path, start=STARTS["four_bar"])
    zig = (sys.executable, "-m", "ziglang", "cc", "-target", target)
    run(*zig, *STRICT, "-O2", "-o", "example", *sources(tmp_path), "-lm", cwd=tmp_path)
    emulator = TARGETS[target]
    if emulator is None:
        built = (tmp_path / "example").read_bytes()
        assert built[:2] == b"MZ" if "windows" in target else built[:4] == b"\xcf\xfa\xed\xfe"
        return
    need(emulator)
    lines = [line.split() for line in run(emulator, "./example", "0.2", "--fast", cwd=tmp_path).splitlines()]
    found = {words[0]: np.array(list(map(float, words[1:]))) for words in lines if words[0] in ("selftest", "q")}
    assert found["selftest"][0] < 1e-9
    assert relative(found["q"], trajectory("four_bar", 0.2).q[-1]) < LIBM
