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
    ("absent", "extra"),
    [
        ("sksundae", "sundials"),
        pytest.param("pinocchio", "validation", marks=SLOW),
        pytest.param("exudyn", "validation", marks=SLOW),
        pytest.param("casadi", "validation", marks=SLOW),
        pytest.param("scipy", "validation", marks=SLOW),
        ("mujoco", "mjcf"),
    ],
)
def test_a_check_without_a_package_names_its_extra(absent: str, extra: str, tmp_path: Path) -> None:
    models = {"sksundae": ["four_bar"], "casadi": ["flexible_pendulum"], "mujoco": ["creature", "pendulum"]}
    chosen = models.get(absent, ["four_bar", "pendulum"])
    arguments = ["check", *chosen, "--states", "4", "--workers", "1", "--report", str(tmp_path)]
    program = _WITHOUT.format(absent=(absent,), arguments=arguments)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=600)
    said = " ".join(done.stdout.split())
    assert done.returncode == 0, done.stdout + done.stderr
    assert "not asked in full" in said and f"pip install 'symofros[{extra}]'" in said
    stored = json.loads((tmp_path / "check.json").read_text())
    assert any(f"symofros[{extra}]" in row["reason"] for row in stored["unsupported"])
    assert not any(row["engine"].startswith(absent) for row in stored["comparisons"])


def test_what_is_there_is_asked_in_full(tmp_path: Path) -> None:
    arguments = ["check", "pendulum", "--states", "4", "--workers", "1", "--report", str(tmp_path)]
    done = subprocess.run([sys.executable, "-m", "validation", *arguments], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0 and "not asked in full" not in done.stdout
