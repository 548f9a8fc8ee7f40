"""How formulas are read, or why they are not, and what is wrong with files, as text.

Cases: formulas.txt and unclear.txt, one formula a line; faults.txt, one change a line of a sound file, "old => new".
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import symofros as sf
from symofros.description.parser import ExpressionError, parse
from tests.models import interpreted
from tests.program_text import Case, assert_golden, golden_cases


def text_of(line: str) -> str:
    """A formula as it stands, or as a literal of Python where it has what no line shows."""
    return str(ast.literal_eval(line)) if line[0] == line[-1] == '"' else line


def reading(line: str) -> str:
    """The formula as it is printed and its symbols, or the reason, the place and the remedy."""
    try:
        formula = parse(text_of(line))
    except ExpressionError as error:
        problem = error.problem_of("mass")
        assert problem.found and problem.remedy and "nothing in it is run" in problem.rule
        place = re.search(r" \(character \d+\)$", problem.found)
        return f"{error.reason}{place[0] if place else ''}; {problem.remedy}"
    return f"{formula} of {', '.join(sorted(formula.symbols())) or 'nothing'}"


@cache
def hips() -> sf.Model:
    """Joints and inputs whose names read as something else, too."""
    joints = ("left-hip", "a", "b", "a-b", "oor", "door", "t")
    solid = sf.Inertia(1, (0.1, 0, 0), (1, 1, 1))
    bodies = [sf.RigidBody(f"l{k}", sf.Joint(name, "revolute"), solid) for k, name in enumerate(joints)]
    return interpreted(sf.System("hips", bodies, inputs=[sf.Input("sin"), sf.Input("u/1")]))


def clearness(line: str) -> str:
    try:
        hips().formulas([line])
    except sf.SymofrosError as error:
        return str(error)
    return "clear"


ARM = """symofros: 1
system: {name: arm}
bodies:
  link: {joint: {name: q1, kind: revolute}, inertia: {mass: 1, moments: [1, 1, 1]}}
"""
FORCES = Path(__file__).with_name("all_forces.yaml").read_text()


def fault(change: str, folder: Path) -> str:
    """What loading says of the file with a change; "$" is its end."""
    old, new = change.encode().decode("unicode_escape").split(" => ")
    text = next(text for text in (ARM, FORCES) if old == "$" or old in text)
    path = folder / "arm.yaml"
    path.write_text(text + new if old == "$" else text.replace(old, new))
    with pytest.raises(sf.DescriptionError) as caught:
        sf.load(path)
    return str(caught.value).replace(f"{folder}/", "")


@pytest.mark.parametrize("case", golden_cases(__file__, "formulas"))
def test_formulas_are_read_or_refused_as_stated(case: Case, request: pytest.FixtureRequest) -> None:
    assert_golden(case, lambda lines: "\n".join(map(reading, lines.split("\n"))), request)


@pytest.mark.parametrize("case", golden_cases(__file__, "unclear"))
def test_formulas_that_could_mean_something_else_are_refused_as_stated(
    case: Case, request: pytest.FixtureRequest
) -> None:
    assert_golden(case, lambda lines: "\n".join(map(clearness, lines.split("\n"))), request)


@pytest.mark.parametrize("case", golden_cases(__file__, "faults"))
def test_faults_of_files_are_named_with_their_lines(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert_golden(case, lambda lines: "\n".join(fault(line, tmp_path) for line in lines.split("\n")), request)
