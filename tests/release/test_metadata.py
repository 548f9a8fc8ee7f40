"""What is said about the package in several files is said alike, and the base installation stays light."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import symofros as sf
from tests.late import require

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
CITATION = YAML(typ="safe").load((ROOT / "CITATION.cff").read_text())
RECIPE = YAML(typ="safe").load((ROOT / "recipe/recipe.yaml").read_text())


def test_the_version_is_stated_in_one_place() -> None:
    assert PROJECT["project"]["dynamic"] == ["version"] and "version" not in PROJECT["project"]
    assert PROJECT["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "symofros.__version__"}
    assert RECIPE["context"]["version"] == sf.__version__ and "version" not in CITATION


def test_the_changelog_starts_with_the_present_version() -> None:
    text = (ROOT / "CHANGELOG.md").read_text()
    versions = re.findall(r"^## (\S+) \((?:not released yet|\d{4}-\d{2}-\d{2})\)$", text, re.MULTILINE)
    assert versions[0] == sf.__version__ and len(versions) == text.count("\n## ")
    entries = [" ".join(entry.split()) for entry in re.split(r"\n(?=- |#)", text) if entry.startswith("- ")]
    assert len(entries) == len(set(entries)), "an entry stands there twice"


def test_news_are_fragments_of_a_known_kind() -> None:
    kinds = {kind["directory"] for kind in PROJECT["tool"]["towncrier"]["type"]}
    fragments = [path for path in (ROOT / "changelog").iterdir() if path.name != "README.md"]
    for path in fragments:
        name, kind, suffix = path.name.split(".")
        assert re.fullmatch(r"\+\w+", name) and kind in kinds and suffix == "md" and path.read_text().strip(), path.name
    listed = re.findall(r"^\| `(\w+)` \|", (ROOT / "changelog/README.md").read_text(), re.MULTILINE)
    assert set(listed) == kinds


def test_a_release_gathers_the_fragments_above_the_last_version(tmp_path: Path) -> None:
    require("towncrier", "release")
    for name in ("CHANGELOG.md", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "changelog").mkdir()
    (tmp_path / "changelog/+a_name.fixed.md").write_text("What was wrong.\n")
    command = ["-m", "towncrier", "build", "--yes", "--version", "9.9.9", "--date", "2030-01-02"]
    subprocess.run(["git", "init", "-q", tmp_path], check=True)
    subprocess.run([sys.executable, *command], cwd=tmp_path, check=True, capture_output=True)
    text = (tmp_path / "CHANGELOG.md").read_text()
    news, _, rest = text.partition("## 0.1.0 (")
    assert "## 9.9.9 (2030-01-02)\n\n### Fixed\n\n- What was wrong." in news and "### Migration" in rest
    assert not list((tmp_path / "changelog").glob("+*"))


def test_the_readme_stays_a_page() -> None:
    assert len((ROOT / "README.md").read_text().splitlines()) <= 120


def test_the_licence_is_the_same_everywhere() -> None:
    assert PROJECT["project"]["license"] == CITATION["license"] == RECIPE["about"]["license"] == "MIT"
    assert (ROOT / "LICENSE").read_text().startswith("MIT License")


def test_the_conda_recipe_lists_the_package_dependencies() -> None:
    stated = {requirement.replace(" ", "") for requirement in RECIPE["requirements"]["run"]}
    python = f"python{PROJECT['project']['requires-python']}"
    assert stated == {python, *PROJECT["project"]["dependencies"]}
    (entry,) = RECIPE["build"]["python"]["entry_points"]
    assert entry == f"symofros = {PROJECT['project']['scripts']['symofros']}"


def test_the_conda_recipe_renders() -> None:
    rattler = require("rattler_build", "release")
    recipe = rattler.Stage0Recipe.from_file(ROOT / "recipe/recipe.yaml")
    assert recipe.render(rattler.VariantConfig({}), rattler.RenderConfig())


@pytest.mark.parametrize("page", ["README.md", "docs/installation.md", "docs/tutorial/index.md"])
def test_newcomer_pages_do_not_install_an_unreleased_package(page: str) -> None:
    if "(not released yet)" not in (ROOT / "CHANGELOG.md").read_text().partition("\n### ")[0]:
        pytest.skip("it has been released")
    text = (ROOT / page).read_text()
    assert "checkout" in text
    assert not re.findall(r"^pip install symofros\b", text, re.MULTILINE)


def test_readme_and_installation_page_name_all_extras() -> None:
    readme, page = (ROOT / "README.md").read_text(), (ROOT / "docs/installation.md").read_text()
    for extra in PROJECT["project"]["optional-dependencies"]:
        if extra not in ("all", "engines") and not extra.startswith("engine-"):
            assert f"`{extra}`" in page, f"docs/installation.md does not name the extra '{extra}'"
    for extra in re.findall(r"symofros\[([\w,-]+)\]", readme + page):
        assert set(extra.split(",")) <= PROJECT["project"]["optional-dependencies"].keys()


EXTRAS = PROJECT["project"]["optional-dependencies"]


def packages(extra: str) -> set[str]:
    """Requirements of an extra, those of extras that it names among them."""
    stated = set()
    for requirement in EXTRAS[extra]:
        inner = re.fullmatch(r"symofros\[([\w,-]+)\]", requirement)
        stated |= set().union(*map(packages, inner[1].split(","))) if inner else {requirement}
    return stated


def test_a_package_has_one_range_in_all_extras() -> None:
    """Two ranges would let one extra bring what another refuses."""
    ranges: dict[str, set[str]] = {}
    for requirement in [*PROJECT["project"]["dependencies"], *(r for listed in EXTRAS.values() for r in listed)]:
        if not requirement.startswith("symofros["):
            ranges.setdefault(re.split(r"[<>=]", requirement)[0], set()).add(requirement)
    assert {name: stated for name, stated in ranges.items() if len(stated) > 1} == {}


def test_the_extra_all_includes_the_documented_extras() -> None:
    left_out = {"all", "torch", "engines", "test", "dev", "docs", "release"}
    wanted = {extra for extra in EXTRAS if extra not in left_out and not extra.startswith("engine-")}
    assert {extra for extra in wanted if not packages(extra) <= packages("all")} == set()
    assert not packages("torch") & packages("all") and "ruff>=0.5,<1" not in packages("all")
