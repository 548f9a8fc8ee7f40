"""The table of engines: what each row says holds, and a check loads the engines that it asks and no others."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from validation.adapters import ROUTES, differences

PACKAGES = {route.package for route in ROUTES.values()} - {""}
ROOT = Path(__file__).parents[3]


@pytest.mark.slow
def test_the_command_line_imports_no_engine() -> None:
    """Nor SciPy, whose integrators and transforms take as long to load as all else that a check of a file needs."""
    code = """
import sys
import validation.__main__
print(*sys.modules)
from validation.adapters import differences
differences()
print(*sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    started, asked = (set(line.split()) for line in run.stdout.splitlines())
    assert not PACKAGES & asked and "scipy" not in started


@pytest.mark.parametrize("name", ROUTES)
def test_every_row_names_an_adapter_that_exists(name: str) -> None:
    assert find_spec(ROUTES[name].module) is not None


def test_differences_are_stated_by_the_engines_of_the_table() -> None:
    assert {row.engine for row in differences()} <= set(ROUTES)
    assert all(row.symofros_convention != row.engine_convention for row in differences())


def test_the_command_check_imports_no_engine_that_it_does_not_ask(tmp_path: Path) -> None:
    """Studies import engines of their own; their commands are loaded when one of them is asked for."""
    code = f"""
import sys
from typer.testing import CliRunner
from validation.__main__ import app
options = ["--engine", "pinocchio", "--states", "5", "--workers", "1", "--output", {str(tmp_path)!r}]
result = CliRunner().invoke(app, ["check", "double_pendulum", *options])
assert result.exit_code == 0, result.output
print(*sorted({{module.partition(".")[0] for module in sys.modules}}))
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert PACKAGES & set(run.stdout.split()) == {"pinocchio"}, run.stderr
