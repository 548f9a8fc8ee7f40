"""Importers that err: calls in a wrong order, times that are none, NULL; and what FMPy makes of a message."""

from __future__ import annotations

import gc
from pathlib import Path

import fmpy
import pytest
from fmpy.simulation import FMICallException

import symofros as sf
from symofros.exports.fmi.fmu import fmi_headers
from tests.exports.cases import STRICT, run, sanitizers
from tests.exports.fmi.logs import lasting_log
from tests.exports.fmi.units import Unit, exported, simulated

HERE = Path(__file__).parent
HINGE = sf.System(
    "hinge",
    (sf.RigidBody("b", sf.Joint("j", "revolute"), sf.Inertia(1.0, (1, 0, 0), (1, 1, 1))),),
    gravity=(0, -9.81, 0),
)


@pytest.mark.parametrize("version", [2, 3])
def test_wrong_calls_are_refused_in_words(tmp_path: Path, version: int) -> None:
    """No fault of memory, one message each; instances side by side move as one alone."""
    fmpy.extract(str(exported(HINGE, version, tmp_path / "out", outputs=[])), tmp_path)
    run(
        "gcc",
        *STRICT,
        "-O0",
        "-g",
        *sanitizers("gcc", "address,undefined"),
        "-DFMI3_OVERRIDE_FUNCTION_PREFIX",
        f"-DVERSION={version}",
        f'-DUNIT="hinge_fmi{version}.c"',
        "-isystem",
        fmi_headers(),
        "-Isources",
        HERE / "misuse.c",
        "-o",
        "misuse",
        "-lm",
        cwd=tmp_path,
    )
    said = run("./misuse", cwd=tmp_path)
    assert "step of 0.02 s from t = 0.01 s refused: it leads beyond the stop time, t = 0.025 s" in said
    assert "step of inf s from t = 0.01 s refused: it has to be finite" in said


def test_a_message_after_a_logger_of_fmpy_is_gone(tmp_path: Path) -> None:
    """Goes to the lasting logger; where none takes the place of the one that is gone, FMPy calls freed memory."""
    path = exported(HINGE, 2, tmp_path / "out", outputs=[])
    assert simulated(str(path), stop_time=0.01, output_interval=0.01)[0] is not None
    gc.collect()
    it = Unit(path, 2, True, tmp_path / "unit")
    it.start()
    with pytest.raises(FMICallException):
        it.fmu.doStep(0.0, -0.01)
    it.fmu.freeInstance()
    assert "finite and longer than 0 s" in lasting_log[-1]
