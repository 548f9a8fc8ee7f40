"""How formulas are read, or why they are not, and what is wrong with files, as text.

Cases: formulas.txt and unclear.txt, one formula a line; faults.txt, one change a line of a sound file, "old => new".
For foreign formats (mjcf.txt, sdf.txt, urdf.txt, mimic.txt; usd.txt, in calls of usd/models.py) a line is such a
change, too, or what a file has beside a sound one, "+ ...", or in its place. What is said of it is a line of notes, or
the fault with its place. Cases of *_read.txt are whole files, or what is inside, and what is read of them.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pytest

import symofros as sf
from symofros.description.parser import ExpressionError, parse
from symofros.expr.expression import evaluate
from tests.description.mjcf import models as mjcf_models
from tests.description.sdf import models as sdf_models
from tests.description.urdf import models as urdf_models
from tests.description.usd import models as usd_models
from tests.late import require
from tests.models import interpreted
from tests.program_text import Case, assert_golden, golden_cases


def text_of(line: str) -> str:
    """A formula as it stands, or as a literal of Python where it has what no line shows."""
    return str(ast.literal_eval(line)) if line[0] == line[-1] == '"' else line


def reading(line: str) -> str:
    """The formula as it is printed with its symbols or its value, or the reason, the place and the remedy."""
    try:
        formula = parse(text_of(line))
    except ExpressionError as error:
        problem = error.problem_of("mass")
        assert problem.found and problem.remedy and "nothing in it is run" in problem.rule
        place = re.search(r" \(character \d+\)$", problem.found)
        return f"{error.reason}{place[0] if place else ''}; {problem.remedy}"
    if symbols := ", ".join(sorted(formula.symbols())):
        return f"{formula} of {symbols}"
    return f"{formula} = {evaluate(formula, {}):.12g}"


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
FORCES = (Path(__file__).parents[1] / "all_forces.yaml").read_text()


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


class Format(NamedTuple):
    """How cases of a foreign format are read.

    Attributes:
        file: Name of the file.
        inside: What a sound file has within its outermost element.
        around: A whole file of what it has inside.
        options: Further arguments of `load`.
    """

    file: str
    inside: str
    around: Callable[[str], str]
    options: dict[str, Any] = {}  # noqa: RUF012 - nobody changes it


FORMATS = {
    "mjcf": Format("model.xml", f"<worldbody>{mjcf_models.PENDULUM}</worldbody>", mjcf_models.document),
    "sdf": Format("model.sdf", sdf_models.ONE, sdf_models.document),
    "urdf": Format("arm.urdf", urdf_models.ROBOT, urdf_models.document),
    "usd": Format("robot.usda", usd_models.SOUND, usd_models.stated),
    "mimic": Format("arm.urdf", urdf_models.MIMIC, urdf_models.document, {"mimic": True}),
}


def notes(text: str, of: Format, folder: Path) -> tuple[str, ...]:
    (folder / of.file).write_text(text)
    return sf.load(folder / of.file, **of.options).notes


@cache
def notes_of_the_sound_one(name: str) -> tuple[str, ...]:
    of = FORMATS[name]
    with TemporaryDirectory() as folder:
        return notes(of.around(of.inside), of, Path(folder))


def said(line: str, name: str, folder: Path) -> str:
    """The notes that a sound file does not have, or why the file is refused."""
    of, line = FORMATS[name], line.encode().decode("unicode_escape")
    old, changed, new = line.partition(" => ")
    if changed:
        sound = of.around(of.inside)
        assert old in sound
        text = sound.replace(old, new)
    elif line.startswith("+ "):
        text = of.around(of.inside + line.removeprefix("+ "))
    else:
        text = line if line.startswith(("<!", "<sdf", "<robot")) else of.around(line)
    known = notes_of_the_sound_one(name)
    try:
        return "; ".join(note for note in notes(text, of, folder) if note not in known) or "(nothing is said)"
    except sf.DescriptionError as error:
        return str(error).replace(f"{folder}/", "")


def digits(match: re.Match[str]) -> str:
    """A number to twelve digits, without what is rounding beside one."""
    number = float(match[0])
    return f"{number if abs(number) > 1e-14 else 0.0:.12g}"


def read(stated: str, name: str, folder: Path) -> str:
    """What is read of a file, numbers to twelve digits: the description without its head, looks and notes."""
    of = FORMATS[name]
    text = stated if stated.startswith(("<sdf", "<robot")) else of.around(stated)
    (folder / of.file).write_text(text)
    system = sf.load(folder / of.file, **of.options)
    sf.save(system, folder / "read.yaml")
    lines = re.sub(r", *\n +", ", ", (folder / "read.yaml").read_text()).splitlines()[2:]
    lines += [f"look of {body}: {look}" for body, looks in system.visuals.items() for look in looks]
    return re.sub(
        r"-?\b\d+(\.\d+)?(e-?\d+)?\b", digits, "\n".join([*lines, *(f"note: {note}" for note in system.notes)])
    )


def said_of_each(lines: str, name: str, folder: Path) -> str:
    return "\n".join(said(line, name, folder) for line in lines.split("\n"))


READ = [case for name in ("mjcf", "sdf", "urdf") for case in golden_cases(__file__, f"{name}_read")]
SAID = [case for name in ("mjcf", "sdf", "urdf", "mimic") for case in golden_cases(__file__, name)]


@pytest.mark.parametrize("case", READ)
def test_foreign_files_are_read_as_stated(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert_golden(case, lambda stated: read(stated, case.path.stem.removesuffix("_read"), tmp_path), request)


@pytest.mark.parametrize("case", SAID)
def test_notes_and_errors_of_foreign_files_match_the_golden_file(
    case: Case, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    assert_golden(case, lambda lines: said_of_each(lines, case.path.stem, tmp_path), request)


# Stages are read in a process of their own, which takes a second.
@pytest.mark.parametrize("case", golden_cases(__file__, "usd_read"))
def test_stages_are_read_as_stated(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    require("pxr", "usd")
    assert_golden(case, lambda stated: read(stated, "usd", tmp_path), request)


@pytest.mark.parametrize("case", golden_cases(__file__, "usd"))
def test_notes_and_errors_of_usd_stages_match_the_golden_file(
    case: Case, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    require("pxr", "usd")
    assert_golden(case, lambda lines: said_of_each(lines, "usd", tmp_path), request)
