"""The templates of docs/ci run as they stand: their steps, by a shell, in a project of somebody else's."""

import re

import pytest
from ruamel.yaml import YAML

from tests.validation.ci.test_plugin import ROOT
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


@pytest.mark.parametrize("server", [github, gitlab])
def test_templates_use_existing_options(server) -> None:
    """Options of the plug-in, then options of `check`."""
    _, (install, check, compare) = server()
    assert "symofros[validation]" in install
    asked = re.findall(r"--symofros-[a-z-]+", check)
    plugin = (ROOT / "symofros/pytest_plugin.py").read_text()
    assert "--symofros-model" in asked and all(f'"{option}"' in plugin for option in asked)
    asked = re.findall(r"--[a-z-]+", compare)
    known = {name for option in command("check").params for name in option.opts}
    assert "--baseline" in asked and set(asked) <= known
