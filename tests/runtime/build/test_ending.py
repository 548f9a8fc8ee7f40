"""Scripts that are over at once: what is built behind them is built, in silence, where no more threads start."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from symofros.runtime.build.toolchain import find_toolchain
from symofros.runtime.calls import extension

# From Python 3.12 on threads that are started while the interpreter waits for others are refused; done here for all.
SCRIPT = Path(__file__).with_name("ending.py.in").read_text()


def test_a_short_script_leaves_the_extension_built(tmp_path: Path) -> None:
    if extension.load() is None or find_toolchain(None) is None:
        pytest.skip("needs a compiler and the headers of Python")
    environment = os.environ | {"SYMOFROS_CACHE": str(tmp_path)}
    run = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    built = [path for path in tmp_path.rglob("*") if path.suffix in (".so", ".dylib")]
    assert built, "the library that the next script loads"
