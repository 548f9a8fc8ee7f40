"""The digest of what a report rests on: of the text of sources alone, wherever they lie."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from validation.dashboard.catalogue import TOPICS
from validation.reporting import evidence
from validation.reporting.command import Run, present
from validation.reporting.record import Report, Topic

TREE = {
    "symofros/__init__.py": "",
    "symofros/native/a.c": "int a;\n",
    "symofros/studio/editor/page.py": "",
    "reference_models/arm.py": "L = 1\n",
    "validation/checking.py": "from .mechanics import parts\n",
    "validation/mechanics/parts.py": "",
    "validation/reporting/html.py": "",
    "validation/timing/race.py": "from ..oracle import digits\nfrom .report import x\n",
    "validation/timing/report.py": "from ..pareto import front\n",
    "validation/timing/figures.py": "from ..stability import maps\n",
    "validation/oracle/digits.py": "",
    "validation/pareto/front.py": "",
    "validation/stability/maps.py": "",
    "validation/native/loop.c": "",
    "tests/test_a.py": "",
    "README.md": "",
}
COUNTED = """
    symofros/native/a.c reference_models/arm.py validation/checking.py validation/mechanics/parts.py
    validation/timing/race.py validation/timing/report.py validation/oracle/digits.py validation/pareto/front.py
    validation/native/loop.c
""".split()


def git(folder: Path, *words: str) -> None:
    identity = "-c", "user.name=a", "-c", "user.email=a@b"
    subprocess.run(["git", "-C", str(folder), *identity, *words], check=True, capture_output=True)


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A small repository in the place of this one."""
    root = tmp_path / "one"
    for name, text in TREE.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    git(tmp_path, "init", str(root))
    git(root, "add", "-A")
    git(root, "commit", "-m", "all")
    put(root, monkeypatch)
    yield root
    forget()


def put(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evidence, "HARNESS", root / "validation")
    monkeypatch.setattr(evidence, "sf", SimpleNamespace(__file__=str(root / "symofros/__init__.py")))
    forget()


def forget() -> None:
    evidence._reached.cache_clear()
    evidence._imported.cache_clear()


def test_only_sources_of_the_numbers_change_the_digest(tree: Path) -> None:
    before, counted = evidence.digest("timing"), []
    for name in list(TREE)[1:]:
        (tree / name).write_text(TREE[name] + "# changed\n")
        forget()
        if evidence.digest("timing") != before:
            counted.append(name)
        (tree / name).write_text(TREE[name])
    assert sorted(counted) == sorted(COUNTED)


def test_location_and_untracked_files_do_not_change_the_digest(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = evidence.digest("timing")
    (tree / "symofros/new.py").write_text("")
    (tree / "symofros/__pycache__").mkdir()
    (tree / "symofros/__pycache__/new.py").write_text("")
    (tree / "symofros/native/a.c").write_bytes(b"int a;\r\n")
    assert evidence.digest("timing") == before
    elsewhere = tree.parent / "another/place"
    git(tree.parent, "clone", str(tree), str(elsewhere))
    put(elsewhere, monkeypatch)
    assert evidence.digest("timing") == before
    shutil.rmtree(elsewhere / ".git")  # As a package of sources has it.
    assert evidence.digest("timing") == before and evidence.revision(elsewhere) == ""


def test_an_installed_harness_has_the_same_digest(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A wheel has the harness and the reference models within the package."""
    before = evidence.digest("timing")
    site = tree.parent / "site"
    shutil.copytree(tree / "symofros", site / "symofros")
    for name in ("validation", "reference_models"):
        shutil.copytree(tree / name, site / "symofros" / name)
    put(site, monkeypatch)
    monkeypatch.setattr(evidence, "HARNESS", site / "symofros/validation")
    assert evidence.digest("timing") == before


def test_a_revision_is_marked_if_sources_differ(tree: Path) -> None:
    plain = evidence.revision(tree)
    (tree / "README.md").write_text("changed")
    (tree / "symofros/new.py").write_text("not part of it")
    assert len(plain) == 40 and evidence.revision(tree) == plain
    (tree / "symofros/native/a.c").write_text("int b;")
    assert evidence.revision(tree) == f"{plain}+"


@pytest.mark.parametrize("name", TOPICS)
def test_every_report_names_the_folder_that_measures_it(name: str) -> None:
    names = {name for name, _ in evidence.sources(TOPICS[name].home, *TOPICS[name].beside)}
    assert any(one.startswith(f"validation/{TOPICS[name].home}/") for one in names), TOPICS[name].home
    assert {"symofros/compiler.py", "symofros/native/model/symofros_model.h"} <= names
    assert {"validation/adapters/closed.py", "reference_models/__init__.py"} <= names
    measuring = f"validation/{TOPICS[name].home}/report.py"
    assert measuring in names or not (evidence.HARNESS.parent / measuring).is_file()
    is_of_editor = any(one.startswith("symofros/studio/editor/") for one in names)
    assert is_of_editor == (name == "studio") and not any(one.startswith("validation/reporting/") for one in names)


def test_a_report_notes_code_changed_during_its_run(monkeypatch: pytest.MonkeyPatch) -> None:
    topic = Topic("t", "g", "q?", lambda _: Report("t", "s.", True, ()))
    run = Run(topic)
    assert run.stamped({})["digest"] == present(topic)
    monkeypatch.setattr("validation.reporting.command.present", lambda _: "another")
    assert run.stamped({})["digest"] == evidence.MIXED
