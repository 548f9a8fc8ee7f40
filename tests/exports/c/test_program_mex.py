"""Diagrams as functions of Matlab: their C with a stub of mex.h has the numbers of the same blocks in one diagram."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Constant
from tests.exports.c.test_mex import SHOW, numbers, octave
from tests.exports.c.test_mex_stub import Argument, answers, ask, ask_in_turn, compiled
from tests.exports.cases import need, run
from tests.exports.test_controller import CASES, RUN, STEPS, closed, driven, given, outlets_of
from tests.models import sampled


@pytest.mark.parametrize("case", sampled(tuple(CASES), ("rates", "plant")))
def test_steps_and_a_whole_motion_have_the_numbers_of_one_diagram(case: str, tmp_path: Path) -> None:
    """Called one after the other, and at once; two motions from one process are the same."""
    diagram = CASES[case]()
    values = given(diagram)
    rows = np.column_stack(list(values.values()))
    outputs = [f"part.{name}" for name in outlets_of(diagram)]
    wanted = driven(closed(diagram, values), tmp_path / "whole", {}, outputs=outputs)
    function = compiled(CASES[case](), tmp_path / "mex")
    whole = (2, ([3.0], RUN, rows))
    steps: list[tuple[int, tuple[Argument, ...]]] = [(1, ([1.0], rows[0]))]
    steps += [(2, ([2.0], [t], row)) for t, row in zip(RUN[1:].tolist(), rows[1:], strict=True)]
    found = answers(ask_in_turn(function, whole, *steps, whole))
    np.testing.assert_array_equal(found[0].ravel(), RUN)
    np.testing.assert_allclose(found[1], wanted, rtol=1e-12, atol=1e-13)
    stepped = np.array([found[2].ravel(), *(y.ravel() for y in found[3:-2:2])])
    np.testing.assert_array_equal(stepped, found[1])
    np.testing.assert_array_equal([float(t.item()) for t in found[4:-2:2]], RUN[1:])
    np.testing.assert_array_equal(found[-1], found[1])


def test_inputs_hold_and_parameters_count_for_a_motion(tmp_path: Path) -> None:
    diagram = CASES["rates"]()
    values = {name: np.tile(rows[0], (STEPS, 1)) for name, rows in given(diagram).items()}
    inputs, parameters = np.concatenate([rows[0] for rows in values.values()]), [10.0, 30.0, 5.0, 0.0]
    wanted = driven(diagram, tmp_path / "c", values, "pd.kp[0]", "10", "pd.kd[1]", "0")
    function = compiled(CASES["rates"](), tmp_path / "mex")
    _, held, begun, moved, first = answers(
        ask_in_turn(
            function,
            (2, ([3.0], RUN, inputs, parameters)),
            (1, ([1.0], inputs, parameters)),
            (1, ([2.0], [RUN[4]])),
            (1, ([1.0], inputs)),
        )
    )
    np.testing.assert_array_equal(held, wanted)
    np.testing.assert_array_equal(begun.ravel(), wanted[0])
    np.testing.assert_array_equal(moved.ravel(), wanted[4])
    assert (first.ravel()[:2] != wanted[0, :2]).all(), "the defaults again"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([2.0], [0.1], np.zeros(6)), ":order nothing has begun"),
        (([1.0], np.zeros(5)), ":size U; it is a real, full array of 6 doubles"),
        (([1.0], np.zeros((1, 6))), ":shape U"),
        (([1.0], [0, 0, 0, 0, 0, np.nan]), ":value U; its entries are finite, and number 6 is not"),
        (([1.0], np.zeros(6), np.ones(3)), ":size Parameters"),
        (([3.0], [], np.zeros(6)), ":times T"),
        (([3.0], [0.0, 0.2, 0.1], np.zeros(6)), ":times T, the times; they ascend from 0 or later"),
        (([3.0], [-0.1, 0.2], np.zeros(6)), ":times T"),
        (([3.0], [0.0, 0.1], np.zeros((3, 6))), ":size U, which has no row for each time"),
        (([3.0], [0.0, 0.1], np.full((2, 6), np.inf)), ":value U; its entries are finite"),
        (([2.0], [0.1], np.zeros(6), np.ones(4)), ":inputs too many inputs; Parameters count from flag 1 or 3 on"),
        (([4.0],), ":flag no such flag"),
    ],
)
def test_arguments_of_a_diagram_that_do_not_fit_are_refused(
    function: Path, arguments: tuple[Argument, ...], words: str
) -> None:
    done = ask(function, 1, *arguments)
    assert done.returncode == 3 and words in done.stdout


@pytest.fixture(scope="module")
def function(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(CASES["rates"](), tmp_path_factory.mktemp("mex"))


def test_time_does_not_go_back(function: Path) -> None:
    done = ask_in_turn(function, (1, ([1.0], np.zeros(6))), (1, ([2.0], [0.2])), (1, ([2.0], [0.1])))
    assert done.returncode == 3 and ":time t lies before the present time" in done.stdout


def test_functions_have_no_name_of_matlab(tmp_path: Path) -> None:
    assert sf.export(CASES["rates"](), "mex", tmp_path / "mex", name="clear").name == "clear_"


@pytest.mark.tools
def test_a_controller_and_its_plant_in_octave(tmp_path: Path) -> None:
    """Two functions, built by their scripts and called in turn, move as one diagram in Python does."""
    need("octave-cli", "mkoctfile")
    plant, controller = CASES["plant"](), CASES["rates"]()
    for diagram in (plant, controller):
        sf.export(diagram, "mex", tmp_path / diagram.name)
        run("octave-cli", "-qf", "--eval", f"build_{diagram.name}", cwd=tmp_path / diagram.name)
    code = (
        SHOW
        + """
[I, O, P, Info] = rates(0);
printf('%s ', I.names{:}, O.names{:}, I.units{:}); printf('\\n');
show('parameters', P.values); show('period', Info.period);
x = plant(1, [0; 0]); u = rates(1, [0.2; -0.1; x]);
for k = 1:40
  x = plant(2, (k - 1)/1000, u(1:2));
  x = plant(2, k/1000);
  u = rates(2, k/1000, [0.2; -0.1; x]);
end
show('x', x); show('u', u(1:2));
"""
    )
    text = octave(tmp_path, code)
    assert "goal[0] goal[1] q[0] q[1] v[0] v[1] effort[0] effort[1] slow[0] slow[1] ticks rad rad" in text
    shown = numbers(text)
    assert shown["parameters"].tolist() == [50.0, 30.0, 5.0, 3.0] and shown["period"] == [1e-3]
    joined = sf.Diagram("joined")
    joined.add(Constant(name="goal", value=[0.2, -0.1]))
    joined.include("plant", plant, effort="controller.effort")
    joined.include("controller", controller, q="plant.q", v="plant.v", goal="goal")
    moved = sf.Simulation(joined).run(0.04, dt=1e-3, record=1e-3)
    np.testing.assert_allclose(shown["x"][:2], moved["plant.q"][-1], rtol=1e-10)
    np.testing.assert_allclose(shown["u"], moved["controller.effort"][-1], rtol=1e-9)
