"""The simulation's C under sanitizers: no read or write beyond its memory, no undefined behaviour, the same results."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import need, sanitizers
from tests.native.sanitized_runs import ADAPTIVE, FIXED, acting, models, runs

ROOT = Path(__file__).parents[2]
# The same steps, compiled with other flags: fused products round differently. A step that is just accepted by one is
# just refused by the other: adaptive runs agree within their own bound, rtol = 1e-6.
SAME, ADAPTED = 1e-9, 1e-6


@pytest.mark.tools
def test_all_methods_run_under_sanitizers(tmp_path: Path) -> None:
    need("gcc")
    flags = sanitizers("gcc", "address,undefined")
    libraries = [
        subprocess.run(["gcc", f"-print-file-name=lib{name}.so"], capture_output=True, text=True).stdout.strip()
        for name, wanted in (("asan", "address"), ("ubsan", "undefined"))
        if wanted in flags[0]
    ]
    environment = {
        **os.environ,
        "PYTHONPATH": str(ROOT),
        "SYMOFROS_CACHE": str(tmp_path),
        "LD_PRELOAD": " ".join(libraries),
        # Python itself keeps memory to the end.
        "ASAN_OPTIONS": "detect_leaks=0",
        "UBSAN_OPTIONS": "print_stacktrace=1",
        "CC": "gcc",
    }
    command = [sys.executable, "-m", "tests.native.sanitized_runs", *flags]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-4000:]
    ends = {label: np.array(values, dtype=np.float64) for label, *values in map(str.split, done.stdout.splitlines())}
    expected = {label.replace(" ", ":"): end for label, end in (*runs(sf.Options()), *acting(sf.Options()))}
    assert ends.keys() == expected.keys()
    # Of each model most methods take part, and of each method most models: nothing was refused altogether.
    assert all(sum(label.startswith(f"{name}:") for label in ends) >= 6 for name in models())
    assert all(sum(label.endswith(f":{method}") for label in ends) >= 3 for method in (*FIXED, *ADAPTIVE))
    for label, end in ends.items():
        bound = (ADAPTED if label.endswith(ADAPTIVE) else SAME) * (1 + np.abs(end).max())
        np.testing.assert_allclose(end, expected[label], rtol=0, atol=bound, err_msg=label)
