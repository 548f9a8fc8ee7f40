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


def test_an_export_says_what_programs_do_not_judge(tmp_path: Path) -> None:
    """Orders that leave stiffness out, and rods; beams whose order leaves out nothing need no word."""
    clamp = sf.Joint("clamp", "revolute")
    beams = [
        sf.Beam("low", clamp, 1.0, 1.0, EI_z=1.0, bend_y=1, retain="zeroth_order"),
        sf.Beam("first", sf.Joint("f"), 1.0, 1.0, EI_z=1.0, GJ=1.0, rhoJ=1.0, bend_y=1, twist=1),
        sf.Beam("rod", sf.Joint("r"), 1.0, 1.0, EI_z=1.0, bend_y=1, theory="strain"),
        sf.Beam("all", sf.Joint("a"), 1.0, 1.0, EI_z=1.0, bend_y=1),
    ]
    notes = sf.export(sf.System("s", beams), "c", tmp_path / "c").notes
    assert [note for note in notes if "beams leave out" in note] == [
        "orders of beams leave out stiffness under loads: 'low' (what axial forces and rotation do (retain:"
        " zeroth_order)), 'first' (how loads couple bending and twist (bend_z: 0)); programs do not judge how much that"
        " is in a motion: `simulate` of the same one says it"
    ]
    (rods,) = (note for note in notes if "how far rods bend" in note)
    assert rods.startswith("programs do not judge how far rods bend between their sections: 'rod'; `simulate` of the")
    readme = (tmp_path / "c" / "README.md").read_text()
    assert "## Notes" in readme and all(f"- {note}\n" in readme for note in notes)
    diagram = sf.Diagram("d")
    diagram.add_model("plant", sf.System("p", beams[:1]))
    diagram.add(sf.blocks.ForwardDynamics(name="arm", model="plant"))
    said = sf.export(diagram, "c", tmp_path / "d").notes
    assert any(
        note.startswith("model 'plant': orders of beams leave out stiffness under loads: 'low'") for note in said
    )
    quiet = sf.export(sf.System("s", beams[3:]), "c", tmp_path / "quiet")
    assert not quiet.notes and "## Notes" not in (tmp_path / "quiet" / "README.md").read_text()
