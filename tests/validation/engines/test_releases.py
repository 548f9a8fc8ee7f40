"""Releases of an engine in environments of their own: a package that the test makes, installed without a network."""

from __future__ import annotations

import importlib
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from validation.engines import changes, releases
from validation.engines.asking import about
from validation.engines.bisection import Search, has_fault, same_fault
from validation.engines.interface import EnginePlugin
from validation.engines.models.kinds import tree_of
from validation.engines.parts import CELLS, nested
from validation.engines.releases import CRASHES, Opened, Release, _Process, opened
from validation.engines.verdicts import Cell, Verdict
from validation.engines.workers import Answer, Crashed, Job, Worker
from validation.faults.environment import kept

TREES = {name: tree_of(name) for name in ("revolute x", "revolute y", "revolute z", "revolute oblique")}
PLUGIN = """
from symofros.validation.engines.interface import Slot
from symofros.validation.engines.plugins.writing.source import Source, SourcePlugin, Way


def write(tree):
    slots = tuple((Slot("angle", (k,), (k,)),) for k in range(len(tree.links)))
    return Source(("import numpy as np, toy_engine",), slots, len(slots), len(slots))


ways = {"sizes": Way("sizes", "value = toy_engine.sizes(len(q))")}
PLUGIN = SourcePlugin("toy", "toy-engine", "toy-engine", (), {"revolute": "hinge"}, ways, write)
"""
# Release -> what its engine is.
ENGINES = {
    "1.0": "def sizes(n): return [n, n + 1]",
    "2.0": "def sizes(n): return [n, n]",
    "3.0": "import os\ndef sizes(n): os.abort()",
    "4.0": "def size(n): return [n, n]",
}


def wheel(folder: Path, name: str, version: str, files: dict[str, str]) -> None:
    stem = f"{name.replace('-', '_')}-{version}"
    info = {
        "METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        "WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        "entry_points.txt": "[symofros.engines]\ntoy = toy_plugin:PLUGIN\n" if files else "",
    }
    files = files | {f"{stem}.dist-info/{file}": text for file, text in info.items()}
    with zipfile.ZipFile(folder / f"{stem}-py3-none-any.whl", "w") as archive:
        for file, text in files.items():
            archive.writestr(file, text)
        archive.writestr(f"{stem}.dist-info/RECORD", "".join(f"{file},,\n" for file in files))


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    """The releases, opened; the real NumPy is lent, as no network is there to install it from."""
    folder, patch = tmp_path_factory.mktemp("wheels"), pytest.MonkeyPatch()
    for version, engine in ENGINES.items():
        wheel(folder, "toy-engine", version, {"toy_engine.py": engine, "toy_plugin.py": PLUGIN})
    wheel(folder, "numpy", np.__version__, {})
    (folder / "plugin").mkdir()
    (folder / "plugin" / "toy_plugin.py").write_text(PLUGIN)
    with patch.context() as context:
        context.setenv("PIP_NO_INDEX", "1")
        context.setenv("PIP_FIND_LINKS", str(folder))
        context.setenv("UV_NO_INDEX", "1")
        context.setenv("UV_FIND_LINKS", str(folder))
        context.syspath_prepend(str(folder / "plugin"))
        plugin: EnginePlugin = importlib.import_module("toy_plugin").PLUGIN
        own = Path(np.__file__).parent
        pairs = [(plugin, Release("toy-engine", version)) for version in (*ENGINES, "9.0")]
        with opened(pairs, folder / "kept", beside=(own, own.with_name("numpy.libs"))) as reach:
            yield reach
        sys.modules.pop("toy_plugin")


def test_releases_are_engines_of_the_matrix(asked: Opened) -> None:
    assert {name: plugin.version() for name, plugin in asked.plugins.items()} == {f"toy {one}": one for one in ENGINES}
    cells, _ = about(asked.plugins, TREES, asked.worker, str)
    verdicts = {name: [one.cell.verdict for one in cells if one.cell.engine == name] for name in asked.plugins}
    assert verdicts["toy 1.0"] == ["wrong"] * 4 and verdicts["toy 2.0"] == ["right"] * 4
    assert verdicts["toy 3.0"] == ["crashes"] * CRASHES and asked.stated("toy 3.0")["gave_up"]
    assert verdicts["toy 4.0"] == ["plug-in"] * 4
    assert set(asked.alone()) == set(asked.plugins) and min(asked.alone().values()) > 0.0
    assert not asked.stated("toy 4.0")["gave_up"] and asked.processes["toy 2.0"][1].memory() >= 0.0


def test_crashes_at_one_question_are_counted_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(self: Worker, job: Job) -> Iterator[Answer]:
        yield from (Answer(name, Crashed("said")) for name in job.functions)

    monkeypatch.setattr(Worker, "ask", crash)
    monkeypatch.setattr(_Process, "_count", lambda self: None)
    process, tree = _Process.__new__(_Process), next(iter(TREES.values()))
    job = Job("toy", tree, tuple("abcdef"), 1)
    assert [len(list(process.ask(job))) for _ in range(CRASHES + 1)] == [CRASHES] * (CRASHES - 1) + [1, 0]
    assert process.crashes == CRASHES


def test_a_missing_release_is_reported_in_words(asked: Opened) -> None:
    ((release, words),) = asked.failures.items()
    assert release.version == "9.0" and "install toy-engine==9.0" in words


def test_an_environment_is_kept_and_one_that_was_cut_off_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wheel(tmp_path, "toy-engine", "2.0", {"toy_engine.py": ENGINES["2.0"]})
    for installer in ("PIP", "UV"):
        monkeypatch.setenv(f"{installer}_NO_INDEX", "1")
        monkeypatch.setenv(f"{installer}_FIND_LINKS", str(tmp_path))
    python = kept(tmp_path / "kept", ["toy-engine==2.0"])
    (python.parents[1] / "mark").touch()
    assert kept(tmp_path / "kept", ["toy-engine==2.0"]) == python and (python.parents[1] / "mark").exists()
    assert (tmp_path / "kept").stat().st_mode & 0o077 == 0
    (python.parents[1] / "installed.txt").unlink()
    assert kept(tmp_path / "kept", ["toy-engine==2.0"]) == python and not (python.parents[1] / "mark").exists()


def test_a_release_is_stated_by_the_name_of_a_plug_in_or_of_its_package() -> None:
    for name in ("pinocchio", "pin"):
        assert [(one.name, str(release)) for one, release in releases.stated(f"{name}==2.7.0")] == [
            ("pinocchio", "pin 2.7.0")
        ]
    assert [one.name for one, _ in releases.stated("exudyn")][:1] == ["exudyn"]
    assert releases.stated("dart==6.0", ["numpy<2"])[0][1].requirements == ["dartpy==6.0", "numpy<2", "numpy"]
    with pytest.raises(ValueError, match="no engine 'fuss'"):
        releases.stated("fuss==1")
    assert {"mujoco", "pin", "drake"} <= set(releases.newest()) and "symofros" not in releases.newest()


def test_the_worker_in_a_release_imports_numpy_alone() -> None:
    """An engine's environment has nothing else of ours."""
    programs = ("numpy.random", "validation.engines.workers")
    listed = "print(*{name.partition('.')[0] for name in sys.modules})"
    bare, ours = (
        set(subprocess.check_output([sys.executable, "-c", f"import sys, {name}; {listed}"], text=True).split())
        for name in programs
    )
    assert ours - bare - set(sys.stdlib_module_names) == {"validation", "symofros"}


@given(st.lists(st.sampled_from("bad good silent".split()), min_size=3, max_size=12), st.data())
def test_strides_find_a_change_among_releases_of_which_some_are_silent(silent: list[str], data: st.DataObject) -> None:
    """One change on either side; at most two neighbours say nothing, so that none of them hides an answer."""
    count = len(silent)
    first = data.draw(st.integers(0, count - 1))
    last = data.draw(st.integers(first, count - 1))
    quiet = {k for k in range(count) if silent[k] == "silent" and k % 3 == 0}
    said = [("quiet" if k in quiet and k != first else first <= k <= last) for k in range(count)]
    search = Search([str(k) for k in range(count)], lambda version: said[int(version)])
    answering = [k for k in range(count) if not isinstance(said[k], str)]
    for step in (1, -1):
        found, beyond = search.change(first, step)
        after = [k for k in answering if (k - first) * step > 0]
        good = [k for k in after if not said[k]]
        wanted = (min if step > 0 else max)(good, default=None)
        assert beyond == wanted
        assert found == (max if step > 0 else min)([k for k in answering if said[k]])


@pytest.mark.parametrize(
    ("named", "verdict", "says"),
    [
        ("wrong", "imprecise", True),
        ("imprecise", "wrong", True),
        ("wrong", "right", False),
        ("wrong", "raises", "raises: said"),
        ("wrong", "crashes", "crashes: said"),
        ("wrong", "plug-in", "plug-in: said"),
        ("raises", "raises", True),
        ("raises", "wrong", False),
        ("raises", "crashes", "crashes: said"),
        ("crashes", "right", False),
        ("right", "right", False),
    ],
)
def test_a_release_has_the_fault_that_was_named_and_no_other(
    named: Verdict, verdict: Verdict, says: bool | str
) -> None:
    assert has_fault(Cell("mine", "ball", "bias", verdict, words="said"), same_fault(named)) == says
    assert has_fault("not to be installed", same_fault(named)) == "not to be installed"


def test_changed_cells_are_those_that_both_runs_asked() -> None:
    def run(version: str, **verdicts: str) -> dict[str, object]:
        rows = [
            {"engine": "mine", "function": "bias", "model": model, "verdict": verdict, "words": ""}
            | {"error": 0.0, "tolerance": 0.0}
            for model, verdict in verdicts.items()
        ]
        engines = [{"name": "mine", "version": version}]
        return {"engines": engines, "models": [*verdicts, "c"], "functions": {"bias": ""}, "cells": nested(rows, CELLS)}

    found = changes.between(run("1", a="right", b="wrong", d="right"), run("2", a="right", b="right", e="wrong"))
    assert [(one["model"], one["before"], one["after"], one["to"]) for one in found] == [("b", "wrong", "right", "2")]
