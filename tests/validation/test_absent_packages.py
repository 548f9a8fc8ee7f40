"""What needs a package that is not installed is not represented, in words that name the extra: no failure, no pass."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

# The harness, where some packages can't be imported.
_WITHOUT = """
import runpy, sys
for name in {absent!r}:
    sys.modules[name] = None
sys.argv = ["validation", *{arguments!r}]
runpy.run_module("validation", run_name="__main__", alter_sys=True)
"""
SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("absent", "extras", "models"),
    [
        # Two at the same time, which spares a process: an engine's, and one that a model is read by.
        (("sksundae", "mujoco"), {"sundials", "mjcf"}, ["creature", "four_bar"]),
        pytest.param(("pinocchio",), {"validation"}, ["four_bar", "pendulum"], marks=SLOW),
        pytest.param(("exudyn",), {"validation"}, ["four_bar", "pendulum"], marks=SLOW),
        pytest.param(("casadi",), {"validation"}, ["flexible_pendulum"], marks=SLOW),
        pytest.param(("scipy",), {"validation"}, ["four_bar", "pendulum"], marks=SLOW),
    ],
)
def test_a_check_without_packages_names_their_extras(
    absent: tuple[str, ...], extras: set[str], models: list[str], tmp_path: Path
) -> None:
    arguments = ["check", *models, "--states", "4", "--workers", "1", "--report", str(tmp_path)]
    program = _WITHOUT.format(absent=absent, arguments=arguments)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=600)
    said = " ".join(done.stdout.split())
    assert done.returncode == 0, done.stdout + done.stderr
    assert "not asked in full" in said and all(f"pip install 'symofros[{extra}]'" in said for extra in extras)
    stored = json.loads((tmp_path / "check.json").read_text())
    assert all(any(f"symofros[{extra}]" in row["reason"] for row in stored["unsupported"]) for extra in extras)
    assert not any(row["engine"].startswith(absent) for row in stored["comparisons"])
