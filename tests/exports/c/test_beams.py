"""Packages judge beams as Python does: at the present parameters, under axial loads, for allowed parameters only."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import packaged
from tests.simulation.beam_models import NAMES, at_rest, cantilever_system, column_diagram

SHARES = [-5.0, -2.0, -0.5, 0.0, 0.5, 0.8, 0.9, 0.95]
# Lines of parameters, coordinates and a time to lines of status, error and the words of a refusal.
DRIVER = Path(__file__).with_name("beams.c").read_text()


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program of a package of the column."""
    return packaged(cantilever_system(), tmp_path_factory.mktemp("column") / "c", DRIVER)


def judged(program: Path, rows: list[tuple[int, np.ndarray, np.ndarray, float]]) -> list[list[str]]:
    """What the program says of each row."""
    lines = [" ".join(map(repr, [checks, *par.tolist(), *q.tolist(), t])) for checks, par, q, t in rows]
    done = subprocess.run([program], input="\n".join(lines), capture_output=True, text=True, check=True)
    return [line.split(" ", 2) for line in done.stdout.splitlines()]


@pytest.mark.slow
def test_packages_report_the_error_of_beams_at_rest_for_their_parameters(package: Path) -> None:
    rests = [at_rest(share, L) for share in SHARES for L in (1e-3, 1.0, 30.0)]
    rows = [(1, model.parameter_values, rest.q, 0.2 * model.parameters["L"] ** 2) for model, rest in rests]
    said = judged(package, rows)
    assert [int(line[0]) for line in said] == [1] * len(rows)
    assert [float(line[1]) for line in said] == pytest.approx([rest.bendings[0].error for _, rest in rests], rel=1e-6)


@pytest.mark.parametrize("name", ["L", "EI", "rho"])
@pytest.mark.parametrize("value", [0.0, -1.0])
def test_packages_refuse_the_same_parameters_as_descriptions(package: Path, name: str, value: float) -> None:
    par = np.array([value if key == name else default for key, default in NAMES.items()])
    checked, taken = judged(package, [(checks, par, np.zeros(3), 0.1) for checks in (1, 0)])
    assert int(checked[0]) == -9 and "beam 'blade'" in checked[2]
    assert int(taken[0]) != -9
    with pytest.raises(sf.ParameterError, match="beam 'blade'"):
        at_rest(0.0, 1.0)[0].with_parameters(**{name: value})


@pytest.mark.slow
def test_exported_diagrams_report_the_error_of_beams_at_rest(tmp_path: Path) -> None:
    model, rest = at_rest(0.9, 2.0)
    main = Path(__file__).with_name("beams_of_diagrams.c").read_text()
    given = {"method": "rk4", "dt": 1e-3, "outputs": ["first.q"]}
    program = packaged(column_diagram(model, rest.q), tmp_path / "c", main, **given)
    *errors, refusal = subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()
    assert [float(error) for error in errors] == pytest.approx([rest.bendings[0].error] * 2, rel=1e-6)
    assert refusal == "-9 -9"
