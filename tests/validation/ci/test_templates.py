"""The templates of docs/ci run as they stand: their steps, by a shell, in a project of somebody else's."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from tests.late import with_utilities
from tests.validation.ci.test_plugin import ROOT, cases
from tests.validation.subjects import URDF
from validation.__main__ import command


def template(name: str) -> dict:
    return YAML(typ="safe").load((ROOT / "docs/ci" / name).read_text())


def github() -> tuple[dict[str, str], list[str]]:
    """Environment and commands of the steps, whatever their conditions."""
    stated = template("github.yml")
    (job,) = stated["jobs"].values()
    return stated["env"], [step["run"] for step in job["steps"] if "run" in step]


def gitlab() -> tuple[dict[str, str], list[str]]:
    (job,) = template("gitlab-ci.yml").values()
    return job["variables"], [*job["before_script"], *job["script"]]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A robot, its stored run, and a `python` that need not install what is here."""
    (tmp_path / "robot.urdf").write_text(URDF)
    (tmp_path / "bin").mkdir()
    python = tmp_path / "bin/python"
    plugin = "-p symofros.pytest_plugin" if not _installed() else ""
    python.write_text(
        f"""#!/bin/sh
case "$2" in
    pip) echo "$@" >> installed ;;
    pytest) shift 2; exec {sys.executable} -m pytest {plugin} -p no:cacheprovider "$@" ;;
    *) exec {sys.executable} "$@" ;;
esac
"""
    )
    python.chmod(0o755)
    return tmp_path


def _installed() -> bool:
    from importlib.metadata import entry_points

    return any(point.name == "symofros" for point in entry_points(group="pytest11"))


def run(project: Path, command: str, stated: dict[str, str]) -> subprocess.CompletedProcess[str]:
    given = {name: value for name, value in stated.items() if "$" not in value}
    paths = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
    path = f"{project / 'bin'}:{with_utilities()['PATH']}"
    environment = os.environ | given | {"PATH": path, "PYTHONPATH": paths}
    return subprocess.run(
        ["bash", "-e", "-c", command], cwd=project, env=environment, capture_output=True, text=True, timeout=300
    )


@pytest.mark.parametrize("server", [github, gitlab])
def test_the_steps_of_a_template_ask_for_what_there_is(server) -> None:
    """Options of the plug-in, then options of `check`."""
    _, (install, check, compare) = server()
    assert "symofros[validation]" in install
    asked = re.findall(r"--symofros-[a-z-]+", check)
    plugin = (ROOT / "symofros/pytest_plugin.py").read_text()
    assert "--symofros-model" in asked and all(f'"{option}"' in plugin for option in asked)
    asked = re.findall(r"--[a-z-]+", compare)
    known = {name for option in command("check").params for name in option.opts}
    assert "--baseline" in asked and set(asked) <= known


# In every run: the same of the plug-in, in test_plugin.py, which also has a regression.
@pytest.mark.slow
@pytest.mark.parametrize("server", [github, gitlab])
def test_the_steps_of_a_template_pass(project: Path, server) -> None:
    environment, commands = server()
    install, check, compare = commands
    assert run(project, install, environment).returncode == 0
    assert "symofros[validation]" in (project / "installed").read_text()
    done = run(project, check, environment)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "robot[confirmed]" in cases(project / "results/junit.xml")
    made = run(project, 'python -m validation check "$MODEL" --states 200 --report stored', environment)
    assert made.returncode == 0, made.stdout + made.stderr
    data = json.loads((project / "stored/check.json").read_text())
    (project / "symofros-baseline.json").write_text(json.dumps(data))
    assert run(project, compare, environment).returncode == 0
