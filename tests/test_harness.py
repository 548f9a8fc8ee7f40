"""The harness has one name in a process, wherever the package is, and takes nothing for its own that is a user's."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from symofros import harness
from tests.validation.subjects import URDF
from validation.worker_process import WorkerProcess

ROOT = Path(__file__).parents[1]
ENTRY_POINTS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]

# What a process has loaded of ours, by file: two modules of one file would be two names of it.
TWICE = """
import os, sys
def twice(*packages):
    modules = {}
    for name, module in sorted(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if file and name != "__main__" and any(f"{os.sep}{package}{os.sep}" in file for package in packages):
            modules.setdefault(os.path.realpath(file), {})[id(module)] = name
    assert len(modules) > 20, modules
    return [[*names.values()] for names in modules.values() if len(names) > 1]
"""
CHECK = f"""
{TWICE}
sys.argv[1:] = ["check", "double_pendulum", "--states", "2", "--engine", "interpreted", "--report", "reports"]
try:
    runpy.run_module(HARNESS, run_name="__main__", alter_sys=True)
except SystemExit as done:
    assert not done.code, done.code
print(twice("validation", "reference_models"))
print(*sorted(name for name in sys.modules if name.endswith((".worker_pool", "reference_models.closed.spatial"))))
"""
# What setuptools writes for an editable installation, in short: names and folders, after all others.
EDITABLE = f"""
import importlib.util, os, sys
folders = {{f"symofros.{{name}}": name for name in ("validation", "reference_models")}} | {{"symofros": "symofros"}}
class Finder:
    def find_spec(name, path=None, target=None):
        if name in folders:
            folder = os.path.join({str(ROOT)!r}, folders[name])
            return importlib.util.spec_from_file_location(name, os.path.join(folder, "__init__.py"))
sys.meta_path.append(Finder)
"""


def run(code: str, folder: Path, *paths: Path) -> str:
    """What a program prints in a folder, which is searched first, then the paths."""
    variables = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, paths))}
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, env=variables, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder laid out as a wheel's files are, by links."""
    site = tmp_path_factory.mktemp("site")
    (site / "symofros").mkdir()
    for path in [*(ROOT / "symofros").iterdir(), ROOT / "validation", ROOT / "reference_models"]:
        if path.name != "__pycache__":
            (site / "symofros" / path.name).symlink_to(path)
    info = site / "symofros-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: symofros\nVersion: 0\n")
    stated = "".join(
        f"[{group}]\n{name} = {place}\n" for group, row in ENTRY_POINTS.items() for name, place in row.items()
    )
    (info / "entry_points.txt").write_text(stated)
    return site


@pytest.fixture(params=["a module", "packages"])
def repository(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Somebody's: with a module, or a package, of the harness's name, and tests that use it."""
    used = "import sys\nfrom pathlib import Path\nimport validation\n\n\ndef test_own():\n    assert validation.MINE\n"
    used += "    here = Path(__file__).parents[DEPTH]\n    for name in ('tests', 'validation', 'reference_models'):\n"
    used += "        assert name not in sys.modules or here in Path(sys.modules[name].__file__).parents\n"
    if request.param == "a module":
        (tmp_path / "validation.py").write_text("MINE = True\n")
        (tmp_path / "test_own.py").write_text(used.replace("DEPTH", "0"))
    else:
        for name in ("validation", "tests", "reference_models"):
            (tmp_path / name).mkdir()
            (tmp_path / name / "__init__.py").write_text("MINE = True\n")
        (tmp_path / "tests/test_own.py").write_text(used.replace("DEPTH", "1") + "    import reference_models\n")
    (tmp_path / "robot.urdf").write_text(URDF)
    return tmp_path


def pytest_in(repository: Path, site: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments]
    variables = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    variables["PYTHONPATH"] = str(site)
    return subprocess.run(command, cwd=repository, env=variables, capture_output=True, text=True, timeout=300)


def test_the_tests_of_a_repository_with_a_validation_of_its_own_run(repository: Path, installed: Path) -> None:
    done = pytest_in(repository, installed)
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr


def test_a_robot_is_checked_beside_a_validation_of_the_users(repository: Path, installed: Path) -> None:
    (repository / "conftest.py").write_text(f"{TWICE}\ndef pytest_unconfigure():\n    print(twice('symofros'))\n")
    asked = ("--symofros-model", "robot.urdf", "--symofros-engine", "mujoco", "--symofros-tier", "smoke")
    done = pytest_in(repository, installed, *asked, "-k", "own or mujoco")
    assert done.returncode == 0 and "2 passed" in done.stdout and done.stdout.rstrip().endswith("[]"), done.stdout


@pytest.mark.parametrize(
    ("start", "name", "layout"),
    [
        ("", "validation", "checkout"),
        (EDITABLE, "symofros.validation", "elsewhere"),
        (EDITABLE, "validation", "checkout"),
        ("", "symofros.validation", "installed"),
    ],
)
def test_a_check_loads_the_harness_under_one_name(
    start: str, name: str, layout: str, installed: Path, tmp_path: Path
) -> None:
    """The models, too: their names begin as the harness's does."""
    paths = {"checkout": [ROOT], "installed": [installed], "elsewhere": []}[layout]
    said = run(f"{start}\nimport runpy\nHARNESS = {name!r}\n{CHECK}", tmp_path, *paths).splitlines()
    models = name.replace("validation", "reference_models")
    assert said[-2:] == ["[]", " ".join(sorted((f"{models}.closed.spatial", f"{name}.worker_pool")))]


def test_this_run_has_one_name_for_each_module() -> None:
    """Modules of other packages, an environment within the checkout among them, are named as they like."""
    names: dict[str, object] = {}
    exec(TWICE, names)
    own = (f"{ROOT.name}{os.sep}{package}" for package in ("symofros", "validation", "reference_models", "tests"))
    assert names["twice"](*own) == []  # type: ignore[operator]


OTHER = """
import {first}.contract.quantities as one, {second}.contract.quantities as other
assert one is other and one.__name__ == one.__spec__.name == "{first}.contract.quantities"
import {second}.engines.interface, {first}.engines.interface as own
assert sys.modules["{second}.engines.interface"] is own
"""


@pytest.mark.parametrize(("start", "first", "second"), [
    ("", "validation", "symofros.validation"),
    (EDITABLE, "symofros.validation", "validation"),
])  # fmt: skip
def test_a_plug_in_gets_the_same_modules_under_the_other_name(
    start: str, first: str, second: str, tmp_path: Path
) -> None:
    run(f"import sys\n{start}\n{OTHER.format(first=first, second=second)}", tmp_path, ROOT)


def test_a_users_validation_is_not_taken_for_the_harness(tmp_path: Path) -> None:
    """Neither before nor after the harness is loaded, in an editable installation, which has no other of this name."""
    (tmp_path / "validation.py").write_text("MINE = True\n")
    code = "from symofros.harness import harness_module\n{}\nassert harness_module('adapters').__name__ == {!r}\n{}"
    used = "import validation; assert validation.MINE"
    for before, after in ((used, ""), ("", used)):
        run(EDITABLE + code.format(before, "symofros.validation.adapters", after), tmp_path)


def test_a_checkout_hidden_by_a_users_validation_is_refused(tmp_path: Path) -> None:
    (tmp_path / "validation.py").write_text("MINE = True\n")
    code = "import symofros as sf\nfrom symofros.harness import package_name\ntry:\n    package_name()\n"
    # Nothing is installed: the finders of this environment are left out.
    alone = "import sys\nsys.meta_path[:] = [one for one in sys.meta_path if 'editable' not in repr(one)]\n"
    said = run(f"{alone}{code}except sf.SymofrosError as error:\n    print(error)", tmp_path, ROOT)
    assert "comes before it" in said and f"remedy: pip install -e {ROOT}" in said


def test_two_installations_are_not_mixed(tmp_path: Path) -> None:
    (tmp_path / "validation").mkdir()
    (tmp_path / "validation/__init__.py").write_text((ROOT / "validation/__init__.py").read_text())
    code = "try:\n    import validation\nexcept ImportError as error:\n    print(error)"
    assert "two installations are mixed" in run(code, tmp_path, ROOT)


def test_processes_of_the_harness_find_it_whatever_is_in_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("validation", "reference_models", "symofros", "json"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('taken from the folder')")
    monkeypatch.chdir(tmp_path)
    done = subprocess.run(harness.command_line(["--help"]), capture_output=True, text=True)
    assert done.returncode == 0 and "Cross-check the generated code" in done.stdout, done.stderr
    with WorkerProcess() as worker:
        assert list(worker.call(("validation.worker_process", "Path"))) == [Path()]


def test_a_missing_harness_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(harness, "_PACKAGE", tmp_path / "symofros")
    with pytest.raises(harness.SymofrosError, match="no package 'validation'"):
        harness.package_name()
