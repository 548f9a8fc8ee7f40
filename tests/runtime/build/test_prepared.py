"""What a description led to is found without reading it, as long as all that it was made of is the same."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app
from symofros.base.sources import Source
from symofros.commands import compilation
from symofros.runtime.build import build, prepared
from symofros.runtime.build.toolchain import find_toolchain
from tests.late import SHELL

PART = """symofros: 1
bodies:
  {name}: {{joint: {{name: {joint}, kind: revolute}}, inertia: {{mass: {mass}, center_of_mass: [0.1, 0, 0]}}}}
"""
URDF = """<robot name="r"><link name="base"/><link name="a"><inertial>
<mass value="{mass}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="q" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint></robot>"""
FUNCTIONS = "kinetic_energy"


class Compiling:
    """`symofros compile` with a cache of its own, and how often a description was read for it."""

    def __init__(self, cache: Path) -> None:
        self.cache = cache
        self.read = 0

    def __call__(self, *arguments: object) -> dict[str, Any]:
        """What it tells, but for the seconds."""
        given = arguments if "--functions" in arguments else (*arguments, "--functions", FUNCTIONS)
        done = CliRunner().invoke(app, ["compile", *map(str, given), "--json"])
        assert done.exit_code == 0, done.output
        reported: dict[str, Any] = json.loads(done.stdout)
        assert reported.pop("seconds") >= 0.0
        return reported


@pytest.fixture
def compiling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Compiling:
    counted = Compiling(tmp_path / "cache")
    monkeypatch.setenv("SYMOFROS_CACHE", str(counted.cache))

    def load_with_sources(*arguments: Any, **named: Any) -> tuple[sf.System, tuple[Source, ...]]:
        counted.read += 1
        return original(*arguments, **named)

    original = compilation.load_with_sources
    monkeypatch.setattr(compilation, "load_with_sources", load_with_sources)
    return counted


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """A description that includes another file, by a link."""
    folder = tmp_path / "models"
    folder.mkdir()
    (folder / "heavy.yaml").write_text(PART.format(name="b", joint="q2", mass=2))
    (folder / "light.yaml").write_text(PART.format(name="b", joint="q2", mass=1))
    (folder / "part.yaml").symlink_to("heavy.yaml")
    path = folder / "arm.yaml"
    path.write_text("include: [part.yaml]\n" + PART.format(name="a", joint="q1", mass=3))
    return path


def test_a_cached_description_is_not_read_again(compiling: Compiling, arm: Path) -> None:
    first = compiling(arm)
    libraries = {path: path.stat().st_mtime_ns for path in compiling.cache.glob("*.so")}
    assert compiling(arm) == first and compiling.read == 1
    assert {path: path.stat().st_mtime_ns for path in compiling.cache.glob("*.so")} == libraries and libraries
    whole = compiling(arm, "--functions", "mass_matrix,bias")
    assert compiling.read == 2 and whole["functions"] == ["mass_matrix", "bias"]


def edit_main(arm: Path) -> None:
    arm.write_text(arm.read_text().replace("mass: 3", "mass: 4"))


def edit_part(arm: Path) -> None:
    arm.with_name("heavy.yaml").write_text(PART.format(name="b", joint="q2", mass=9))


def lead_elsewhere(arm: Path) -> None:
    arm.with_name("part.yaml").unlink()
    arm.with_name("part.yaml").symlink_to("light.yaml")


def lose_part(arm: Path) -> None:
    """The same text, but of another file, which may be included beside the first."""
    arm.with_name("part.yaml").unlink()
    shutil.copy(arm.with_name("heavy.yaml"), arm.with_name("part.yaml"))


@pytest.mark.parametrize("change", [edit_main, edit_part, lead_elsewhere, lose_part])
def test_a_changed_file_is_read_again(compiling: Compiling, arm: Path, change: Callable[[Path], None]) -> None:
    compiling(arm)
    change(arm)
    compiling(arm)
    assert compiling.read == 2
    compiling(arm)
    assert compiling.read == 2


def test_other_requests_are_not_served_from_the_cache(compiling: Compiling, tmp_path: Path) -> None:
    robot = tmp_path / "robot.urdf"
    robot.write_text(URDF.format(mass=1))
    requests = [
        (),
        ("--floating-base",),
        ("--functions", "potential_energy"),
        ("--functions", "frame_pose", "--frames", "a"),
        ("--functions", "frame_pose"),
    ]
    for _ in range(2):
        for request in requests:
            compiling(robot, *request)
    assert compiling.read == len(requests)


@pytest.mark.parametrize(
    ("of", "name", "value"),
    [
        (prepared, "CODE_IDENTITY", "edited"),
        (prepared, "_installation", lambda package: f"another {package}"),
        (build, "cpu_identity", lambda: "another processor"),
        (build, "SHARED_FLAGS", (*build.SHARED_FLAGS, "-g")),
    ],
)
def test_changed_code_packages_processor_or_flags_invalidate_the_cached_model(
    compiling: Compiling, arm: Path, monkeypatch: pytest.MonkeyPatch, of: object, name: str, value: object
) -> None:
    compiling(arm)
    monkeypatch.setattr(of, name, value)
    compiling(arm)
    assert compiling.read == 2


def test_a_changed_compiler_or_flags_invalidate_the_cached_model(
    compiling: Compiling, arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SYMOFROS_CFLAGS", "-O0")
    compiling(arm)
    monkeypatch.setenv("SYMOFROS_CFLAGS", "-O1")
    compiling(arm)
    assert compiling.read == 2
    toolchain = find_toolchain()
    assert toolchain is not None
    newer = tmp_path / "newer"
    newer.write_text(
        SHELL + f'[ "$1" = --version ] && echo newer 99 && exit\nexec {" ".join(toolchain.command)} "$@"\n'
    )
    newer.chmod(0o755)
    monkeypatch.setenv("CC", str(newer))
    find_toolchain.cache_clear()
    try:
        compiling(arm)
    finally:
        find_toolchain.cache_clear()
    assert compiling.read == 3


@pytest.mark.parametrize(
    "content",
    [
        "",
        "{",
        "[]",
        '{"name": "arm"}',
        '{"name": "arm", "sources": [], "libraries": ["x.so"]}',
        '{"name": "arm", "sources": [["a"]], "libraries": []}',
        '{"name": "arm", "sources": [[1, 2, 3, 4]], "libraries": [5]}',
        '{"name": "arm", "sources": null, "libraries": null}',
        "\0\xff",
    ],
)
@pytest.mark.filterwarnings("ignore::symofros.errors.StoredStateWarning")
def test_a_damaged_record_is_ignored(compiling: Compiling, arm: Path, content: str) -> None:
    first = compiling(arm)
    (note,) = (path for path in compiling.cache.glob("*.known") if "sources" in path.read_text())
    whole = note.read_bytes()
    note.write_bytes(content.encode("latin-1"))
    assert compiling(arm) == first and compiling.read == 2
    assert note.read_bytes() == whole


@pytest.mark.filterwarnings("ignore::symofros.errors.StoredStateWarning")
def test_libraries_outside_the_cache_are_ignored(compiling: Compiling, arm: Path, tmp_path: Path) -> None:
    compiling(arm)
    (note,) = (path for path in compiling.cache.glob("*.known") if "sources" in path.read_text())
    stated = json.loads(note.read_text())
    (name,) = stated["libraries"]
    for file in (name, Path(name).with_suffix(".digest")):
        (compiling.cache / file).rename(tmp_path / file)
    note.write_text(json.dumps({**stated, "libraries": [f"../{name}"]}))
    compiling(arm)
    assert compiling.read == 2


def test_a_description_that_went_wrong_or_away_is_refused(compiling: Compiling, arm: Path) -> None:
    compiling(arm)
    arm.write_text("symofros: 1\nbodies: {a: {joint: {kind: revolut}}}\n")
    refused = CliRunner().invoke(app, ["compile", str(arm), "--functions", FUNCTIONS])
    assert refused.exit_code == 2 and "revolut" in refused.output
    arm.unlink()
    refused = CliRunner().invoke(app, ["compile", str(arm), "--functions", FUNCTIONS])
    assert refused.exit_code == 2 and "does not exist" in refused.output


def test_warnings_are_repeated_for_cached_models(compiling: Compiling, tmp_path: Path) -> None:
    beam = sf.Beam("boom", sf.Joint("slew", "revolute"), 1.0, 1.0, EI_z=1.0, bend_y=1, foreshortening=False)
    sf.save(sf.System("crane", (beam,)), tmp_path / "crane.yaml")
    for _ in range(2):
        with pytest.warns(sf.InconsistentModelWarning):
            compiling(tmp_path / "crane.yaml")


@pytest.mark.parametrize("become", [Path.mkdir, lambda path: None])
def test_an_edited_or_replaced_source_counts_as_changed(tmp_path: Path, become: Callable[[Path], None]) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"text")
    source = Source.of(path, b"text")
    assert source.is_unchanged()
    path.write_bytes(b"taxt")
    assert not source.is_unchanged()
    path.unlink()
    become(path)
    assert not source.is_unchanged()


def test_the_content_that_was_read_counts(tmp_path: Path) -> None:
    """A file that is edited while it is read has changed since."""
    path = tmp_path / "file"
    path.write_bytes(b"new")
    assert not Source.of(path, b"old").is_unchanged()
