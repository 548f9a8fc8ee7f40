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
from collections.abc import Callable
from pathlib import Path

import pytest

import symofros as sf
from tests.docs.pages import ROOT, blocks
from tests.late import require
from tests.validation.ci.test_templates import github, gitlab
from tests.validation.subjects import URDF
from validation.commands import COMMANDS

require("build", "release")
pytestmark = pytest.mark.slow(minutes=5)
# Folder of the repository -> where a wheel has it.
INSTALLED = {"symofros": "symofros"} | {name: f"symofros/{name}" for name in ("validation", "reference_models")}
# The page's sources; what is built from them is in editor/static.
NOT_INSTALLED = "symofros/studio/editor/page/"
# Pages that windows of the editor show.
DOCS = ("docs/*.md", "docs/howto/*.md", "docs/theory/*.md")
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

    @property
    def packages(self) -> Path:
        """Folder of what is installed."""
        (found,) = (self.folder / "venv/lib").glob("python*/site-packages")
        return found

    def run(self, *command: str, fails: int = 0, folder: Path | None = None) -> str:
        where = {"cwd": folder or self.folder, "env": self.variables}
        done = subprocess.run(command, **where, capture_output=True, text=True, errors="replace", timeout=900)
        assert done.returncode == fails, f"{command}\n{done.stdout}{done.stderr}"
        return done.stdout + done.stderr


@pytest.fixture(scope="module")
def base(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    environment = Environment(tmp_path_factory.mktemp("outside"))
    environment.run("pip", "install", "-q", str(wheel))
    return environment


def tracked() -> set[str]:
    listed = subprocess.run(
        ["git", "ls-files", *INSTALLED], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    return {name for name in listed.splitlines() if (ROOT / name).is_file()}


def test_the_wheel_holds_all_data_and_no_sources_of_pages_nor_tests(wheel: Path) -> None:
    names = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    sources = (name.partition("/") for name in tracked() if not name.startswith(NOT_INSTALLED))
    pages = {f"symofros/{name.relative_to(ROOT)}" for part in DOCS for name in ROOT.glob(part)}
    assert names == {f"{INSTALLED[top]}/{rest}" for top, _, rest in sources} | pages
    assert wheel.name == f"symofros-{sf.__version__}-py3-none-any.whl"


def test_a_wheel_has_one_package_and_the_sources_build_the_same(
    distributions: Path, wheel: Path, tmp_path: Path
) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.partition("/")[0] for name in names} == {"symofros", f"symofros-{sf.__version__}.dist-info"}
    (sources,) = distributions.glob("*.tar.gz")
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(tmp_path), str(sources)]
    subprocess.run(command, check=True, capture_output=True)
    assert sorted(zipfile.ZipFile(tmp_path / wheel.name).namelist()) == sorted(names)


def test_the_source_distribution_is_complete(distributions: Path) -> None:
    (path,) = distributions.glob("*.tar.gz")
    names = {name.partition("/")[2] for name in tarfile.open(path).getnames()}
    assert {"LICENSE", "README.md", "pyproject.toml", "symofros/native/model/symofros_model.h"} <= names


def test_the_base_installation_is_small(base: Environment) -> None:
    packages = base.packages
    files = [path for path in packages.rglob("*") if path.is_file() and not path.is_symlink()]
    size = sum(path.stat().st_size for path in files) / 1e6
    assert size < MEGABYTES, f"{size:.0f} MB"
    names = {path.name.partition("-")[0] for path in packages.glob("*.dist-info")}
    assert not names & {"scipy", "casadi", "pin", "mujoco", "matplotlib", "viser"}


def test_first_readme_steps_work_from_the_wheel(base: Environment) -> None:
    (base.folder / "reference_models").symlink_to(base.packages / INSTALLED["reference_models"])
    first = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)[0]
    assert "(1000, 2, 2) (6, 2)" in base.run("python", "-c", first)
    assert str(base.folder) in base.run("python", "-c", "import symofros; print(symofros.__file__)")
    starts = ["cp ", *(f"symofros {name}" for name in ("info", "compile", "cache", "simulate arm.yaml 2"))]
    lines = [line.partition("  #")[0] for block in blocks("README.md", "sh") for line in block.text.splitlines()]
    commands = [line for line in lines if line.startswith((*starts, "symofros export robot.urdf --target c"))]
    assert len(commands) >= 6
    for command in commands:
        base.run("bash", "-c", command)


@pytest.mark.parametrize(
    ("command", "extra", "code"),
    [
        # It compares the ways of the package itself, which nobody confirms.
        ("symofros check robot.urdf", "validation", 1),
        ("symofros validation accuracy", "validation", 2),
        ("python -m symofros.validation", "validation", 2),
        ("symofros view robot.urdf", "view", 2),
        ("symofros edit arm.yaml", "gui", 2),
        ("symofros export robot.urdf --target fmu3 -o out/fmu", "fmi", 2),
        ("symofros simulate arm.yaml 0.1 --picture run.png", "plots", 2),
    ],
)
def test_the_base_installation_names_the_missing_extra(base: Environment, command: str, extra: str, code: int) -> None:
    corpus = ROOT / "reference_models/arm.urdf", ROOT / "reference_models/rigid/cart_pole.yaml"
    for source, name in zip(corpus, ("robot.urdf", "arm.yaml"), strict=True):
        (base.folder / name).write_text(source.read_text())
    reported = "".join(base.run("bash", "-c", command, fails=code).split())  # Frames of messages break lines.
    assert f"symofros[{extra}]" in reported.replace("│", "") and "Traceback" not in reported


@pytest.mark.parametrize("command", ["symofros validation --help", "python -m symofros.validation --help"])
def test_the_base_installation_lists_the_commands_of_the_harness(base: Environment, command: str) -> None:
    said = base.run("bash", "-c", command)
    assert "scipy" not in said and all(f"\n  {name} " in said for name in COMMANDS)


# Repositories of other people: files -> texts. Each has a module or packages of names that ours have in a checkout.
OWN = "import validation\n\n\ndef test_own():\n    assert validation.MINE\n"
REPOSITORIES = {
    "a module": {"validation.py": "MINE = True\n", "test_own.py": OWN},
    "packages": {
        "validation/__init__.py": "MINE = True\n",
        "reference_models/__init__.py": "MINE = True\n",
        "tests/__init__.py": "MINE = True\n",
        "tests/test_own.py": f"{OWN}    import reference_models\n\n    assert reference_models.MINE\n",
    },
    "nothing of ours": {"test_own.py": "def test_own():\n    pass\n"},
}


@pytest.fixture(params=REPOSITORIES)
def repository(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Somebody's, with a robot, a baseline to come, and tests."""
    for name, text in (REPOSITORIES[request.param] | {"robot.urdf": URDF}).items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def test_foreign_tests_run_beside_the_wheel(base: Environment, repository: Path) -> None:
    """Their modules are the ones that are imported; without an option, nothing of ours is."""
    base.run("pip", "install", "-q", "pytest")
    assert "1 passed" in base.run("python", "-m", "pytest", folder=repository)
    assert "1 passed" in base.run("pytest", folder=repository)


@pytest.fixture(scope="module")
def with_engines(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    environment = Environment(tmp_path_factory.mktemp("engines"))
    environment.run("pip", "install", "-q", f"{wheel}[validation]", "pytest")
    return environment


@pytest.mark.parametrize("server", [github, gitlab])
def test_the_steps_of_a_template_run_as_they_stand_beside_other_peoples_modules(
    with_engines: Environment, repository: Path, server: Callable[[], tuple[dict[str, str], list[str]]]
) -> None:
    """But for the first, which installs: that is done."""
    _, (_, check, compare) = server()
    with_engines.variables["MODEL"] = "robot.urdf"
    said = with_engines.run("bash", "-e", "-c", check, folder=repository)
    assert "failed" not in said and " passed" in said
    store = "symofros check robot.urdf --states 200 --report stored && cp stored/check.json symofros-baseline.json"
    with_engines.run("bash", "-e", "-c", store, folder=repository)
    assert "nothing is worse" in with_engines.run("bash", "-e", "-c", compare, folder=repository)
    code = "from symofros.validation import check; assert check('robot.urdf', states=2), 'not all agree'"
    with_engines.run("python", "-c", code, folder=repository)


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
def test_the_tutorial_runs_from_the_wheel(extras: str, steps: tuple[str, ...], wheel: Path, tmp_path: Path) -> None:
    outside = Environment(tmp_path)
    outside.run("pip", "install", "-q", f"{wheel}{extras}")
    for step in steps:
        page = (ROOT / f"docs/tutorial/{step}.md").read_text(encoding="utf-8")
        cells = re.findall(r"^```{code-cell} python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
        assert len(cells) >= 3
        outside.run("python", "-c", "\n".join(cells))
