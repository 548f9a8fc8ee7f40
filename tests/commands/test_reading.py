"""Options of reading: the same in every command that loads a model; remedies name what the user can type."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from dataclasses import Field
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app
from symofros.commands.reading import OPTIONS, ReadingOptions, pairs, reading_of
from symofros.errors import Argument, Problem, SymofrosError
from symofros.pytest_plugin import pytest_addoption

KINEMATIC = (
    '<robot name="k"><link name="base"/>{}</robot>',
    '<link name="l{0}"/><joint name="j{0}" type="continuous"><parent link="{1}"/><child link="l{0}"/></joint>',
)
LOADERS = ("info", "compile", "simulate", "export", "view", "edit", "equilibrium", "equations", "kernels", "advise")


def kinematic(folder: Path, count: int) -> Path:
    outer, link = KINEMATIC
    links = (link.format(i, f"l{i - 1}" if i else "base") for i in range(count))
    (folder / "k.urdf").write_text(outer.format("\n".join(links)))
    return folder / "k.urdf"


def invoke(*arguments: object) -> Any:
    return CliRunner().invoke(app, [*map(str, arguments)])


@pytest.mark.parametrize("command", LOADERS)
def test_every_command_that_loads_a_model_has_the_reading_options(command: str) -> None:
    result = invoke(command, "--help").output
    for option in ("--floating-base", "--mimic", "--waive", "--package", "--argument"):
        assert option in result


def test_the_waiver_named_in_the_remedy_is_accepted(tmp_path: Path) -> None:
    path = kinematic(tmp_path, 2)
    result = invoke("info", path)
    assert result.exit_code == 2 and "or --waive massless_tip" in result.output and "load(" not in result.output
    assert json.loads(invoke("info", path, "--waive", "massless_tip", "--json").output)["nv"] == 2
    picture = tmp_path / "k.png"
    assert invoke("view", path, "--waive", "massless_tip", "--record", picture).exit_code == 0 and picture.is_file()
    wrong = invoke("info", path, "--waive", "massless_tips")
    assert wrong.exit_code == 2 and "did you mean 'massless_tip'" in wrong.output


def test_compile_caches_models_by_their_reading_options(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    path = kinematic(tmp_path, 1)
    asked = "compile", path, "--functions", "frame_pose"
    assert invoke(*asked, "--waive", "massless_tip").exit_code == 0
    assert invoke(*asked).exit_code == 2
    said = invoke("compile", path, "--waive", "massless_tip").output
    assert "ask for other functions, such as frame_pose" in said


def test_an_export_with_stepping_suggests_no_other_functions(tmp_path: Path) -> None:
    path = kinematic(tmp_path, 1)
    asked = "--target", "c", "--functions", "frame_pose", "--waive", "massless_tip"
    result = invoke("export", path, "--output", tmp_path / "out", *asked)
    said = " ".join(result.output.split())
    assert result.exit_code == 2 and "give it an inertia, or bind it by a constraint" in said
    assert "other functions" not in said


def test_diagrams_and_native_files_accept_no_reading_options(tmp_path: Path) -> None:
    diagram = tmp_path / "d.yaml"
    diagram.write_text("symofros_diagram: 1\nblocks: {}\n")
    for command in ("info", "simulate"):
        result = invoke(command, diagram, "--waive", "massless_tip")
        assert result.exit_code == 2 and "the file is a diagram" in result.output
    result = invoke("edit", tmp_path / "new.yaml", "--waive", "massless_tip", "--no-browser")
    assert result.exit_code == 2 and "opened as it stands" in result.output


def test_reading_options_parse_pairs_and_backquoted_names() -> None:
    """But in formulas, where they are; an empty text is one for arguments of xacro alone."""
    assert reading_of(packages=["a=b", "c = d "]).keywords == {"packages": {"a": "b", "c": "d"}}
    assert ReadingOptions().keywords == {}
    stated = reading_of(packages=["`a=b`=c"], arguments=["`x=y`=z", "prefix=", "d`q`=1"])
    assert stated.keywords == {"packages": {"a=b": "c"}, "arguments": {"x=y": "z", "prefix": "", "dq": "1"}}
    assert pairs(["d`a=b`=1"], "--set", "q1=1") == {"d`a=b`": "1"}
    for option in ({"packages": ["a"]}, {"packages": ["a="]}, {"arguments": ["=a"]}):
        with pytest.raises(SymofrosError, match="no name and value"):
            reading_of(**option)  # type: ignore[arg-type]


def test_a_name_with_an_equals_sign_is_shown_with_its_backquotes(tmp_path: Path) -> None:
    body = sf.RigidBody("b", sf.Joint("a=b", "revolute", "world"), sf.Inertia(1.0, (1, 0, 0)))
    sf.save(sf.System("s", (body,)), tmp_path / "s.yaml")
    result = invoke("equilibrium", tmp_path / "s.yaml", "--set", "a=b=0.2")
    assert result.exit_code == 2 and "write '`a=b`=0.2'" in result.output


def test_equal_problems_are_one_line_with_their_number(tmp_path: Path) -> None:
    with pytest.raises(sf.DescriptionError) as caught:
        sf.load(kinematic(tmp_path, 24))
    text = str(caught.value)
    assert len(caught.value.problems) == 24 and text.count("moves no mass") == 1
    assert "k.urdf:1: body 'l0': joint 'j0' moves no mass; and 23 more: 'l1' (line 2), 'l2' (line 3)" in text
    assert len(text.splitlines()) == 4
    assert invoke("info", tmp_path / "k.urdf").output.rstrip().endswith("k.urdf: 24 problems")


def test_problems_that_differ_are_listed_separately() -> None:
    """In what was found, in the rule, in the remedy; and a pair is named with both lines."""
    stated = [Problem(f"body '{name}' is odd", found, "r", "m", f"a:{i}") for i, (name, found) in enumerate(PAIRS)]
    assert len(str(SymofrosError(stated)).splitlines()) == 4 * 4
    pair = [Problem(f"body '{name}' is odd", "f", "r", "m") for name in "ab"]
    assert str(SymofrosError(pair)) == "\n".join(map(str, pair))


PAIRS = (("a", "1"), ("b", "2"), ("c", "3"), ("d", "3"))


@pytest.mark.parametrize(
    ("argument", "call", "option"),
    [
        (Argument("waive", "massless_tip"), "load(…, waive=['massless_tip'])", "--waive massless_tip"),
        (Argument("packages", "/a", "b"), "load(…, packages={'b': '/a'})", "--package b=/a"),
        (Argument("packages", "/a", "b=c"), "load(…, packages={'b=c': '/a'})", "--package '`b=c`=/a'"),
        (Argument("floating_base"), "load(…, floating_base=True)", "--floating-base"),
    ],
)
def test_remedies_name_shell_options_for_arguments(argument: Argument, call: str, option: str) -> None:
    problem = Problem("x", "y", "z", f"or {argument.call}", argument=argument)
    assert problem.remedy == f"or {call}" and problem.in_shell().remedy == f"or {option}"
    assert problem.in_shell("--symofros-").remedy == f"or --symofros-{option.removeprefix('--')}"
    for key in ("a=b", "my dir", "a`b", "`a`", "it's"):  # Options of remedies are read back.
        option, pair = shlex.split(Argument("packages", "/x y", key).option("--"))
        assert option == "--package" and reading_of(packages=[pair]).keywords == {"packages": {key: "/x y"}}


def test_tables_in_a_pipe_are_not_wrapped(tmp_path: Path) -> None:
    name = "a_body_of_a_name_that_is_as_long_as_names_of_robots_are"
    inertia = sf.Inertia(1.23456789, (0.123456, 0.234567, 0.345678), (1, 1, 1))
    loaded = [
        sf.RigidBody(f"{name}_{i}", sf.Joint(f"q{i}", "revolute", f"{name}_0" if i else "world"), inertia)
        for i in range(2)
    ]
    sf.save(sf.System("s", loaded), tmp_path / "s.yaml")
    code = "import sys; sys.argv = ['symofros', 'info', sys.argv[1]]; from symofros.__main__ import app; app()"
    free = {name: text for name, text in os.environ.items() if name != "COLUMNS"}
    asked = [sys.executable, "-c", code, tmp_path / "s.yaml"]
    result = subprocess.run(asked, capture_output=True, text=True, env=free).stdout
    (row,) = [line for line in result.splitlines() if f"{name}_1 " in line and "0.123456" in line]
    assert "0.123456, 0.234567, 0.345678" in row
    assert "mass [kg]" in result  # Brackets are no styles.


def test_pictures_name_omitted_items(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    chain = [
        sf.RigidBody(f"b{i}", sf.Joint(f"q{i}", "revolute", f"b{i - 1}" if i else "world"), sf.Inertia(1.0, (1, 0, 0)))
        for i in range(14)
    ]
    sf.save(sf.System("chain", chain), tmp_path / "chain.yaml")
    asked = "simulate", tmp_path / "chain.yaml", "0.001", "--plot", tmp_path / "a.png"
    assert "shows the first 12 of 14 coordinates: --signals NAME,..." in invoke(*asked).output
    assert "shows the first" not in invoke(*asked, "--signals", "q12,q13").output
    wrong = invoke(*asked, "--signals", "q99")
    assert wrong.exit_code == 2 and "no coordinate, speed or input 'q99'" in wrong.output
    run = sf.simulate(sf.compile(sf.System("chain", chain)), t_end=1e-3)
    titles = [axis.get_title(loc="left") for axis in run.plot().axes]
    assert "the first 12 of 14; others by their names" in titles
    assert [axis.get_title(loc="left") for axis in run.plot("q13").axes][0] == ""


_STATED: dict[type, Any] = {bool: True, str: "all", tuple: (("a", "b"),)}


@pytest.mark.parametrize(
    "item", [item for item in OPTIONS if item.name not in ("waive", "limits")], ids=lambda i: i.name
)
def test_options_that_load_refuses_are_not_passed(item: Field[Any], tmp_path: Path) -> None:
    stated = ReadingOptions(**{item.name: _STATED[type(item.default)]})
    for suffix in (".yaml", ".urdf", ".xacro", ".sdf", ".world", ".xml", ".usda"):
        path = tmp_path / f"a{suffix}"
        path.write_text("")
        kept = bool(stated.fit_for(path).keywords)
        if not (kept and suffix == ".usda"):  # Which a process of its own would read.
            with pytest.raises(SymofrosError) as refused:
                sf.load(path, **stated.keywords)
            assert (f"{item.name} applies to" in str(refused.value)) is not kept


def test_the_plug_in_has_every_option() -> None:
    parser = pytest.Parser(_ispytest=True)
    pytest_addoption(parser)
    parsed = vars(parser.parse(["--symofros-mimic", "--symofros-argument", "a=b", "--symofros-limits", "stops"]))
    stated = {item.name: parsed[f"symofros_{item.metadata['flag'].replace('-', '_')}"] for item in OPTIONS}
    assert reading_of(**stated) == ReadingOptions(mimic=True, arguments=(("a", "b"),), limits="stops")
