"""The first commands that a newcomer types."""

import errno
import json
import math
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML
from typer.testing import CliRunner, Result

import symofros as sf
from symofros.__main__ import _COMMANDS, _command, app
from symofros.commands.shared import refuse, shown
from symofros.simulation.progress import pace_of
from tests.diagrams.files.cases import folder_with
from tests.late import require
from validation.commands import COMMANDS

ROOT = Path(sf.__file__).parents[1]
FLEXIBLE = ROOT / "reference_models/flexible"
CART_POLE = ROOT / "reference_models/rigid/cart_pole.yaml"
FILES = {
    "CART_POLE": CART_POLE,
    "BEAM": FLEXIBLE / "spinning_beam.yaml",
    "SCENE": FLEXIBLE / "scenes/spinning_beam.yaml",
}
REFUSED = YAML(typ="safe").load(Path(__file__).with_name("refused.yaml"))


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(app, [*map(str, arguments)])


# What a command does without, each with all below it: each takes a twentieth to a fifth of a second to import.
GENERATOR = "symofros.compiler symofros.generator symofros.mechanics.dynamics symofros.mechanics.kinematics"
# Typer would load pydantic for the arguments alone.
READERS = "sympy ruamel.yaml pydantic importlib.metadata"
WITHOUT = {
    "compile": f"{GENERATOR} {READERS} numpy rich _cffi_backend symofros.description symofros.loading"
    " symofros.mechanics symofros.expr symofros.base.options symofros.base.arguments symofros.runtime.calls"
    " symofros.runtime.model",
    "info": f"{GENERATOR} {READERS} _cffi_backend symofros.runtime.build symofros.runtime.model symofros.simulation"
    " symofros.blocks symofros.diagrams.diagram symofros.studio",
}


@pytest.mark.parametrize(("command", "without"), WITHOUT.items())
def test_a_command_imports_only_what_it_needs(command: str, without: str, tmp_path: Path) -> None:
    """`compile` where the model is in the cache, as it is the second time."""
    arguments = [command, str(ROOT / "reference_models/arm.urdf")]
    arguments += ["--functions", "kinetic_energy"] if command == "compile" else []
    code = (
        "import sys\nfrom symofros.__main__ import app\ntry:\n    app(sys.argv[1:])\n"
        "finally:\n    print(*sys.modules, file=sys.stderr)"
    )
    environment = {**os.environ, "SYMOFROS_CACHE": str(tmp_path / "cache")}
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True, env=environment
        )
    loaded = done.stderr.split()
    assert "symofros.commands.shared" in loaded
    assert not [m for m in loaded if any(m == name or m.startswith(f"{name}.") for name in without.split())]


def test_commands_are_listed_and_completed(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = invoke("--help").output
    listing = "info compile simulate equations equilibrium advise export kernels diff edit view check validation cache"
    rows = listed.partition("Commands:")[2].splitlines()
    assert [line.split()[0] for line in rows if line[2:].strip() and line[2] != " "] == listing.split()  # Others go on.
    for name, value in {"_SYMOFROS_COMPLETE": "complete_bash", "COMP_WORDS": "symofros si", "COMP_CWORD": "1"}.items():
        monkeypatch.setenv(name, value)
    assert CliRunner().invoke(app, [], prog_name="symofros").output.split() == ["simulate"]


def test_the_help_imports_no_command() -> None:
    code = (
        "import sys, symofros.__main__ as m; from typer.testing import CliRunner; "
        "print(CliRunner().invoke(m.app, ['--help']).output); print(*sys.modules)"
    )
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    *listed, modules = printed.strip().splitlines()
    rows: dict[str, str] = {}
    name = ""
    for words in (line[2:] for line in listed if line.startswith("  ")):
        name = words.split(maxsplit=1)[0] if words[0] != " " else name  # What is further in goes on with the last.
        rows[name] = f"{rows.get(name, '')} {words.removeprefix(name).strip()}".strip()
    assert len(_COMMANDS) > 10
    for name in _COMMANDS:
        summary = (_command(name).help or "").split("\n")[0]
        assert rows[name] == summary and len(rows[name]) > 20
    assert {m for m in modules.split() if m.startswith("symofros.commands.")} == {"symofros.commands.grammar"}
    others = {"symofros.compiler", "symofros.diagrams", "symofros.studio"}
    assert not (others | {"pydantic", "cffi", "sympy", "ruamel.yaml"}) & set(modules.split())
    assert invoke("--version").output == f"symofros {sf.__version__}\n"


def test_info_lists_masses_limits_parameters_and_frames(tmp_path: Path) -> None:
    data = json.loads(invoke("info", CART_POLE, "--json").output)
    assert {item["name"]: item["value"] for item in data["parameters"]}["m_cart"] > 0.0
    assert data["bodies"][0]["mass"] > 0.0 and "tip" in data["frames"]
    shown = invoke("info", CART_POLE).output
    assert "Parameters" in shown and "m_cart" in shown and "frames: " in shown
    arm = ROOT / "validation/corpus/arm.urdf"
    limits = {item["name"]: item for item in json.loads(invoke("info", arm, "--json").output)["coordinates"]}
    assert any(item["lower"] is not None for item in limits.values())


def test_info_lists_limits_of_speed_and_effort(tmp_path: Path) -> None:
    """Of a joint without limits of travel, too; zero is none, and a column that would be empty is not there."""
    joint = sf.Joint("q", "continuous", limits=sf.Limits(velocity=3.2, effort=0.0))
    sf.save(
        sf.System("wheel", (sf.RigidBody("wheel", joint, sf.Inertia(1.0, moments=(1, 1, 1))),)), tmp_path / "a.yaml"
    )
    (found,) = json.loads(invoke("info", tmp_path / "a.yaml", "--json").output)["coordinates"]
    assert found == {"name": "q", "lower": None, "upper": None, "velocity": 3.2, "effort": None}
    shown = invoke("info", tmp_path / "a.yaml").output
    assert "velocity" in shown and "3.2" in shown and "effort" not in shown and "lower" not in shown


def test_info_lists_the_mass_of_a_tapered_beam(tmp_path: Path) -> None:
    beam = sf.Beam("boom", sf.Joint("slew", "revolute"), "L", "3 - x", EI_z=1.0, bend_y=1)
    sf.save(sf.System("crane", (beam,), (sf.Parameter("L", 2.0),)), tmp_path / "crane.yaml")
    (body,) = json.loads(invoke("info", tmp_path / "crane.yaml", "--json").output)["bodies"]
    assert body["mass"] == pytest.approx(4.0)


def test_info_lists_the_chosen_methods(monkeypatch: pytest.MonkeyPatch) -> None:
    """All in JSON, what was chosen among several in a table of 80 columns."""
    printed = json.loads(invoke("info", CART_POLE, "--routes", "--json").output)["routes"]
    (acceleration, *_) = printed["forward_dynamics"]
    assert acceleration["quantity"] == "acceleration of trees" and acceleration["figures"]["factors_effort"] > 0
    assert not {"project", "constraint", "forward_dynamics_vjp"} & printed.keys() and printed["kinetic_energy"]
    monkeypatch.setenv("COLUMNS", "80")
    shown = invoke("info", CART_POLE, "--routes").output
    assert f"acceleration of trees: {acceleration['method']}" in shown and "…" not in shown
    table = shown[shown.index("Methods where") :]
    assert "│ inertia forces:" not in table and max(map(len, table.splitlines())) == 80 and table.rstrip().endswith("┘")


def test_info_derives_only_requested_functions(monkeypatch: pytest.MonkeyPatch) -> None:
    def derived(*_: Any) -> None:
        raise AssertionError("info derived a function")

    monkeypatch.setattr("symofros.compiler.ProgramBuilder", derived)
    assert "operations" not in json.loads(invoke("info", CART_POLE, "--json").output)


def test_run_time_parameters_are_set_from_the_shell() -> None:
    common = "simulate", CART_POLE, "0.05", "--json", "--set", "q=0.5"
    light, heavy = (json.loads(invoke(*common, "--set", f"m_cart={m}").output)["last"] for m in (1, 100))
    assert abs(heavy["x"]) < 0.1 * abs(light["x"])


def test_equilibrium_reports_the_inputs_that_hold_it() -> None:
    common = "equilibrium", CART_POLE, "--set", "m_cart=3", "--set", "q=3.0"
    data = json.loads(invoke(*common, "--hold", "x", "--json").output)
    assert data["ok"] and data["coordinates"]["q"] == pytest.approx(math.pi) and data["inputs"] == {"F": 0.0}
    assert list(data["efforts"]) == ["x"]
    shown = invoke(*common, "--hold", "x", "--hold", "q").output
    assert "effort held by" in shown and "no inputs hold this state" in shown
    none = invoke(*common, "--input", "F=1", "--json")
    assert none.exit_code == 1 and "no equilibrium" in json.loads(none.output)["error"]
    assert invoke("equilibrium", CART_POLE, "--hold", "xx").exit_code == 2


_PARTS = ("  found:  ", "  rule:   ", "  remedy: ")


@pytest.mark.parametrize("line", REFUSED)
def test_commands_refuse_wrong_input_in_four_parts(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    for name in ("README.md", "robot.yam", "robot.mjb", "file"):
        (tmp_path / name).touch()
    (tmp_path / "folder.yaml").mkdir()
    folder_with(tmp_path)
    result = invoke(*(FILES.get(word, word) for word in shlex.split(line)))
    assert result.exit_code == 2, result.exception
    assert REFUSED[line] in result.output and all(part in result.output for part in _PARTS), result.output


def test_without_its_packages_the_editor_names_the_extra_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    monkeypatch.delitem(sys.modules, "symofros.studio.editor.command", raising=False)
    result = invoke("edit", CART_POLE)
    assert result.exit_code == 2 and "pip install 'symofros[gui]'" in result.output
    assert all(part in result.output for part in _PARTS)


def test_tables_show_no_negative_zero() -> None:
    assert [shown(value) for value in (-0.0, 0.0, -1.5)] == ["0", "0", "-1.5"]
    assert [pace_of(*span) for span in ((1.0, 7e-4), (1.0, 0.5))] == ["1429 times real time", "2 times real time"]


@pytest.mark.slow
def test_the_harness_starts_from_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """A file of the user's with the name of its package does not take its place."""
    (tmp_path / "validation.py").write_text("raise SystemExit('not the harness')\n")
    monkeypatch.chdir(tmp_path)
    for arguments, code, expected in (
        (("check", "--help"), 0, "Compare our C"),
        (("check", "nobody"), 2, "'nobody' is neither a file nor a model of the standard set; "),
        (("check", "--engin", "mujoco"), 2, "  remedy: did you mean --engine?"),
        (("check", "pendulum", "--engine", "vectors", "--report", "validation.py"), 2, "can't be used"),
        (("validation", "render", "nobody"), 2, "no report 'nobody'; there are check, "),
        (("check", "nosuch.urdf"), 2, "'nosuch.urdf' does not exist\n  found:  "),
    ):
        status = invoke(*arguments).exit_code
        said = "".join(capfd.readouterr())  # Of the process that runs the harness.
        assert status == code and expected in said and "DISAGREES" not in said, said
    assert not (tmp_path / "reports").exists()


def test_without_its_packages_the_harness_names_the_extra_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """As after `pip install symofros` alone: a package that can't be imported stands for one that is not there."""
    (tmp_path / "sitecustomize.py").write_text("import sys\nsys.modules['scipy'] = sys.modules['matplotlib'] = None\n")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{ROOT}")  # Of the process that runs the harness.
    status, said = invoke("validation", "accuracy", "--help").exit_code, capfd.readouterr().err
    assert status == 2 and "Traceback" not in said and "pip install 'symofros[validation]'" in said


def test_the_list_of_harness_commands_needs_no_optional_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Neither engines, nor what is computed and drawn with; one line, or two, for each command."""
    gone = repr("numpy scipy matplotlib pinocchio mujoco casadi exudyn hypothesis".split())
    (tmp_path / "sitecustomize.py").write_text(f"import sys\nsys.modules.update(dict.fromkeys({gone}))\n")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{ROOT}")  # Of the process that runs the harness.
    status, (said, complaints) = invoke("validation", "--help").exit_code, capfd.readouterr()
    assert status == 0 and not complaints, complaints
    assert re.findall(r"^  (\w+) {2,}\S", said.partition("Commands:")[2], re.MULTILINE) == [*COMMANDS]


@pytest.mark.slow
def test_the_first_readme_command_installs_all_that_the_harness_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """As after `pip install -e '.[validation]'`: what other extras bring can't be imported."""
    others = "pytest dask distributed pyarrow fmpy viser starlette uvicorn websockets zenoh sksundae jsonschema ziglang"
    names = repr(others.split())
    (tmp_path / "sitecustomize.py").write_text(f"import sys\nsys.modules.update(dict.fromkeys({names}))\n")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{ROOT}")  # Of the process that runs the harness.
    status, said = invoke("validation", "pareto", "--help").exit_code, "".join(capfd.readouterr())
    assert status == 0 and "--problem" in said, said


def test_kernels_lists_registers_and_the_memory_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a graphics processor, and so without times."""
    require("nvidia.cuda_nvrtc", "cuda")
    monkeypatch.setattr("symofros.commands.kernels.present", lambda: None)
    printed = invoke("kernels", CART_POLE, "--architecture", "sm_80", "--bandwidth", 2000, "--json")
    assert printed.exit_code == 0, printed.output
    double, single = json.loads(printed.output)["kernels"]
    # q, v, u, t, and M, h, Q: 2 + 2 + 1 + 1 + 4 + 2 + 2 numbers.
    assert double["bytes_of_state"] == 14 * 8 and single["bytes_of_state"] == 14 * 4
    assert double["bound"] == 2e12 / (14 * 8)
    assert 0 < single["usage"]["registers"] <= double["usage"]["registers"] <= 64
    refused = invoke("kernels", CART_POLE, "--architecture", "90")
    assert refused.exit_code == 2 and "no architecture" in refused.output


def test_an_interrupt_leaves_the_harness_time_to_report(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C reaches both processes; the harness reports what was finished, which takes longer than a moment."""
    said = iter([KeyboardInterrupt, KeyboardInterrupt, 130])

    class Harness:
        def __init__(self, command: list[str]) -> None:
            assert command[-2:] == ["check", "pendulum"]

        def wait(self) -> object:
            answer = next(said)
            if answer is KeyboardInterrupt:
                raise KeyboardInterrupt
            return answer

    monkeypatch.setattr(subprocess, "Popen", Harness)
    assert invoke("check", "pendulum").exit_code == 130 and not list(said)


def test_a_closed_pipe_ends_the_command_silently() -> None:
    """`symofros info arm.yaml | head -1`."""
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "symofros", "info", str(CART_POLE)]
    done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True)
    os.close(writing)
    assert done.returncode == 1 and not done.stderr


def test_names_with_any_characters_can_be_given_in_the_shell(tmp_path: Path) -> None:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    joint = (
        '<joint name="{0}" type="revolute"><parent link="b"/><child link="l{0}"/><limit lower="-9" upper="9"/></joint>'
    )
    links = "".join(f'<link name="l{name}">{inertial}</link>{joint.format(name)}' for name in ("left-hip", "a=b"))
    (tmp_path / "hip.urdf").write_text(f'<robot name="r"><link name="b"/>{links}</robot>')
    command = "simulate", tmp_path / "hip.urdf", "0.01", "--json", "--set", "left-hip=0.5", "--set", "d`a=b`=0.25"
    last = json.loads(invoke(*command, "--input", "`a=b`=-20*`left-hip` - 2*d`left-hip`").output)["last"]
    assert last["left-hip"] == 0.5 and last["da=b"] == pytest.approx(0.25 - 10 * 0.01, rel=1e-12)
    refused = invoke(*command, "--input", "left-hip=-20*left-hip")
    assert refused.exit_code == 2 and "between backquotes: -20*`left-hip`" in refused.output


@pytest.mark.parametrize("filename", ["y.csv", None])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EFBIG])
def test_a_full_disk_is_not_called_a_matter_of_rights(
    number: int, filename: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of a picture there was the number of the error alone."""
    assert refuse(OSError(number, os.strerror(number), filename)).exit_code == 2
    said = capsys.readouterr().err
    assert (filename or "a file") in said and "make room" in said and "rights" not in said


def test_without_a_compiler_nothing_is_called_compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    command = "compile", CART_POLE, "--functions", "kinetic_energy"
    assert "compiled, or found" in invoke(*command).output and json.loads(invoke(*command, "--json").output)["compiled"]
    for module in ("compiler", "commands.compile", "commands.compilation"):
        monkeypatch.setattr(f"symofros.{module}.find_toolchain", lambda *_: None)
    with pytest.warns(sf.CompilerMissingWarning):
        said = invoke(*command, "-o", tmp_path / "c").output
    assert "1 function generated and not compiled, as no compiler was found" in said and "cart_pole.c" in said
