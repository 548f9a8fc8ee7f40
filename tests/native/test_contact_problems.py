"""Forces of rigid contacts by the shipped solver, judged by the law itself (docs/theory/constraints.md, (46))."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import symofros

DRIVER = Path(__file__).parent / "contact_problems.c"
NATIVE = Path(symofros.__file__).parent / "native"


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The driver, compiled."""
    gcc, program = shutil.which("gcc"), tmp_path_factory.mktemp("problems") / "run"
    if gcc is None:
        pytest.skip("needs gcc")
    folders = [f"-I{NATIVE / name}" for name in ("model", "stepping", "stepping/instances")]
    flags = ["-std=gnu99", "-O1", "-Wno-unused-function", *folders]
    subprocess.run([gcc, *flags, "-o", program, DRIVER, "-lm"], check=True)
    return program


@pytest.mark.parametrize(
    ("balls", "problems", "share"), [(1, 5000, 0.9995), (2, 1500, 0.996), (3, 300, 0.98), (6, 60, 0.95), (10, 12, 0.9)]
)
def test_answers_are_certified(driver: Path, balls: int, problems: int, share: float) -> None:
    """To 1e-12 of the loads, in time; of few no motion is found, and most have one."""
    command = [driver, *map(str, (balls, problems, 1, 5 if balls <= 8 else 0))]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout.split()
    certified, several, none, nowhere, missed = map(int, done[1:6])
    assert certified + several + none + nowhere + missed == problems
    assert missed + nowhere <= (1 - share) * problems and certified > 0.9 * problems and float(done[6]) < 1e-12
