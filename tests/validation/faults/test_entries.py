"""Real faults: each file keeps the rules, and its script shows what it states where its release is installed."""

import sys
from importlib import metadata
from pathlib import Path

import pytest
from typer.testing import CliRunner

from validation.__main__ import app
from validation.faults.entry import FOLDER, faults, frozen, read
from validation.faults.environment import NotAskedError, printed

EXAMPLE = FOLDER / "adam_jacobian_rate.yaml"


def installed(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def test_every_file_keeps_the_rules() -> None:
    assert len(faults()) >= 40 and len({fault.engine for fault in faults().values()}) >= 8
    assert 3 * sum(fault.right is None for fault in faults().values()) <= len(faults())


def test_frozen_faults_are_still_there() -> None:
    assert frozen() <= set(faults())


@pytest.mark.parametrize(
    "old, new, rule",
    [
        ("script: |\n", "script: |\n" + "  x = 1\n" * 25, "at most 25 lines"),
        ("script: |\n", "script: |\n  import scipy\n", "not scipy"),
        ("engine: ", "engine: other-", "the engine is one of"),
        ("class: ", "class: other ", "the class is one of"),
        ("thread: ", "thread: see ", "a thread is an address"),
        ("tolerance: ", "tolerance: 1e9  # ", "differs from the right one"),
        ("subject: {functions: [jacobian_dot]", "subject: {functions: []", "a subject names"),
        ("follows: ", "because: ", "missing or unknown"),
    ],
)
def test_a_file_that_breaks_a_rule_is_refused(old: str, new: str, rule: str, tmp_path: Path) -> None:
    path = tmp_path / EXAMPLE.name
    path.write_text(EXAMPLE.read_text().replace(old, new, 1))
    with pytest.raises(ValueError, match=rule):
        read(path)


@pytest.mark.parametrize(
    "name", [pytest.param(path.stem, marks=pytest.mark.slow(5)) for path in sorted(FOLDER.glob("*.yaml"))]
)
def test_an_installed_release_shows_its_fault(name: str) -> None:
    fault, version = faults()[name], installed(faults()[name].engine)
    if version is None or version not in (fault.wrong, fault.right):
        pytest.skip(f"{fault.engine} {fault.wrong} is not installed")
    assert fault.is_right(printed(Path(sys.executable), fault.script)) == (version == fault.right)


def test_a_script_without_a_number_is_reported_in_words() -> None:
    with pytest.raises(NotAskedError, match="ModuleNotFoundError"):
        printed(Path(sys.executable), "import no_such_engine")


def test_the_list_names_every_fault() -> None:
    lines = CliRunner().invoke(app, ["faults"]).stdout.splitlines()
    assert [line.split()[0] for line in lines[:-1]] == sorted(faults())
