"""The distributions as somebody else gets them: what they hold, and the first steps from a wheel.

Slow: builds, and downloads the engines. `.ci/build` runs it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

import symofros as sf
from tests.docs.pages import ROOT, blocks
from tests.late import require

require("build", "release")
pytestmark = pytest.mark.slow(minutes=5)
PACKAGES = ("symofros", "validation", "reference_models")
# The page's sources; what is built from them is in editor/static.
NOT_INSTALLED = "symofros/studio/editor/page/"
TUTORIAL = ("first_arm", "beam", "loop", "controller", "export", "your_urdf")
# What the base installation promises; more has to be an extra.
MEGABYTES = 260


@pytest.fixture(scope="module")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built in a copy of what git knows: two workers that build in one folder take each other's files away."""
    folder, sources = tmp_path_factory.mktemp("dist"), tmp_path_factory.mktemp("sources")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file():
            (sources / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, sources / name)
    command = [sys.executable, "-m", "build", "--outdir", str(folder), str(sources)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Deprecat" not in done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def wheel(distributions: Path) -> Path:
    (path,) = distributions.glob("*.whl")
    return path


class Environment:
    """A clean environment outside the repository, and commands in it, which see nothing of the checkout."""

    def __init__(self, folder: Path) -> None:
        venv.create(folder / "venv", with_pip=True)
        self.folder, self.programs = folder, folder / "venv/bin"
        kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        self.variables = kept | {
            "PATH": f"{self.programs}:{os.environ['PATH']}",
            "SYMOFROS_CACHE": str(folder / "cache"),
            "OMP_NUM_THREADS": "1",
        }

    def run(self, *command: str, fails: int = 0) -> str:
        done = subprocess.run(
            command, cwd=self.folder, env=self.variables, capture_output=True, text=True, errors="replace", timeout=900
        )
        assert done.returncode == fails, f"{command}\n{done.stdout}{done.stderr}"
        return done.stdout + done.stderr


@pytest.fixture(scope="module")
def base(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    environment = Environment(tmp_path_factory.mktemp("outside"))
    environment.run("pip", "install", "-q", str(wheel))
    return environment


def tracked() -> set[str]:
    listed = subprocess.run(["git", "ls-files", *PACKAGES], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return {name for name in listed.splitlines() if (ROOT / name).is_file()}


def test_the_wheel_holds_all_data_and_no_sources_of_pages_nor_tests(wheel: Path) -> None:
    names = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert names == {name for name in tracked() if not name.startswith(NOT_INSTALLED)}
    assert wheel.name == f"symofros-{sf.__version__}-py3-none-any.whl"


def test_the_sources_hold_what_building_and_reading_them_takes(distributions: Path) -> None:
    (path,) = distributions.glob("*.tar.gz")
    names = {name.partition("/")[2] for name in tarfile.open(path).getnames()}
    assert {
        "LICENSE",
        "README.md",
        "pyproject.toml",
        "symofros/__init__.py",
        "symofros/native/model/symofros_model.h",
    } <= names


def test_the_base_installation_is_light(base: Environment) -> None:
    (packages,) = (base.folder / "venv/lib").glob("python*/site-packages")
    files = [path for path in packages.rglob("*") if path.is_file() and not path.is_symlink()]
    size = sum(path.stat().st_size for path in files) / 1e6
    assert size < MEGABYTES, f"{size:.0f} MB"
    names = {path.name.partition("-")[0] for path in packages.glob("*.dist-info")}
    assert not names & {"scipy", "casadi", "pin", "mujoco", "matplotlib", "viser"}


def test_first_steps_of_the_readme_from_the_wheel(base: Environment) -> None:
    (packages,) = (base.folder / "venv/lib").glob("python*/site-packages")
    for name in ("validation", "reference_models"):
        (base.folder / name).symlink_to(packages / name)
    first = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)[0]
    assert "(1000, 2, 2) (6, 2)" in base.run("python", "-c", first)
    assert str(base.folder) in base.run("python", "-c", "import symofros; print(symofros.__file__)")
    starts = (
        "cp ",
        "symofros info",
        "symofros compile",
        "symofros simulate arm.yaml 2",
        "symofros export robot.urdf --target c",
    )
    lines = [line.partition("  #")[0] for block in blocks("README.md", "sh") for line in block.text.splitlines()]
    commands = [line for line in lines if line.startswith((*starts, "symofros cache"))]
    assert len(commands) >= 6
    for command in commands:
        base.run("bash", "-c", command)


@pytest.mark.parametrize(
    ("command", "extra", "code"),
    [
        # It compares the ways of the package itself, which nobody confirms.
        ("symofros check robot.urdf", "validation", 1),
        ("symofros validation --help", "validation", 2),
        ("python -m validation", "validation", 2),
        ("symofros view robot.urdf", "view", 2),
        ("symofros edit arm.yaml", "gui", 2),
        ("symofros export robot.urdf --target fmu3 -o out/fmu", "fmi", 2),
        ("symofros simulate arm.yaml 0.1 --picture run.png", "plots", 2),
    ],
)
def test_the_base_installation_says_which_extra_is_missing(
    base: Environment, command: str, extra: str, code: int
) -> None:
    corpus = ROOT / "reference_models/arm.urdf", ROOT / "reference_models/rigid/cart_pole.yaml"
    for source, name in zip(corpus, ("robot.urdf", "arm.yaml"), strict=True):
        (base.folder / name).write_text(source.read_text())
    told = "".join(base.run("bash", "-c", command, fails=code).split())  # Frames of messages break lines.
    assert f"symofros[{extra}]" in told.replace("│", "") and "Traceback" not in told


def test_the_list_of_an_installation_has_all_dependencies_with_licences(base: Environment, tmp_path: Path) -> None:
    program = Path(sys.executable).with_name("cyclonedx-py")
    listed = tmp_path / "dependencies.cdx.json"
    arguments = ["--pyproject", str(ROOT / "pyproject.toml"), "--output-file", str(listed)]
    subprocess.run([program, "environment", str(base.folder / "venv"), *arguments], check=True, capture_output=True)
    content = json.loads(listed.read_text())
    licences = {item["name"].lower(): item.get("licenses") for item in content["components"]}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert content["bomFormat"] == "CycloneDX" and content["metadata"]["component"]["name"] == project["name"]
    for requirement in project["dependencies"]:
        assert licences[re.split("[<>=]", requirement)[0]], requirement


def tutorial_extras() -> list[str]:
    """The extras that the tutorial's first page asks for: for all steps but one, then for that one."""
    page = (ROOT / "docs/tutorial/index.md").read_text(encoding="utf-8")
    return re.findall(r"symofros(\[[\w,]+\])'", page)


@pytest.mark.parametrize(("extras", "steps"), [*zip(tutorial_extras(), (TUTORIAL[:-1], TUTORIAL[-1:]), strict=True)])
def test_the_tutorial_from_the_wheel(extras: str, steps: tuple[str, ...], wheel: Path, tmp_path: Path) -> None:
    outside = Environment(tmp_path)
    outside.run("pip", "install", "-q", f"{wheel}{extras}")
    for step in steps:
        page = (ROOT / f"docs/tutorial/{step}.md").read_text(encoding="utf-8")
        cells = re.findall(r"^```{code-cell} python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
        assert len(cells) >= 3
        outside.run("python", "-c", "\n".join(cells))
