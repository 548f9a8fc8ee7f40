"""Plug-ins of strangers that raise, leave, answer nonsense or write no script: the run goes on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.validation.engines.fakes import PLUGINS, REFUSED, install
from validation.engines import parts, workers
from validation.engines.interface import installed
from validation.engines.matrix import cells
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN
from validation.engines.proving import scripts
from validation.engines.report import compose

ROOT = Path(__file__).parents[3]
Report = dict[str, Any]


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """The report of all fakes on one tree, by the command in a process of its own."""
    folder = tmp_path_factory.mktemp("fakes")
    install(folder)
    paths = os.pathsep.join([str(folder), str(ROOT), os.environ.get("PYTHONPATH", "")])
    items = [word for name in ("pinocchio", "dying", *PLUGINS) for word in ("--engine", name)]
    command = [sys.executable, "-m", "validation", "engines", *items, "--kinds", "revolute x", "--tries", "3"]
    done = subprocess.run(
        [*command, "--output", str(folder / "out")],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=400,
    )
    assert done.returncode in (0, 1) and "Traceback" not in done.stderr, done.stderr
    data: Report = json.loads((folder / "out/engines.json").read_text())
    data["exit"] = done.returncode
    return data


def verdicts(stored: Report, engine: str) -> dict[str, str]:
    rows = parts.unnested(stored["cells"], parts.CELLS)
    return {row["function"]: row["verdict"] for row in rows if row["engine"] == engine}


def said(stored: Report, engine: str) -> str:
    rows = parts.unnested(stored["cells"], parts.CELLS)
    return "\n".join(row["words"] for row in rows if row["engine"] == engine)


def proven(stored: Report, engine: str) -> list[bool]:
    return [proof["proven"] for proof in stored["proofs"] if proof["engine"] == engine]


@pytest.mark.parametrize(
    ("engine", "words"),
    [
        ("unbuilt", "KeyError: 'no joint 7' (fakes.py:"),
        ("uncalled", "KeyError: 'no joint 7' (fakes.py:"),
        ("unwritten", "the script of mass_matrix: KeyError: 'no joint 7' (fakes.py:"),
        ("textual", "ValueError: could not convert string to float"),
        ("misplaced", "ValueError: slots of 2 links for a tree of 3"),
        ("slotless", "ValueError: 0 slots for link 'a', which has 1 moving joints"),
        ("uncharted", "ValueError: slot of link 'a': no chart 'angel'"),
        ("beyond", "ValueError: slot of link 'a': places (3,) of 3"),
        ("leaving", "SystemExit: 3 (fakes.py:"),
    ],
)
def test_exceptions_of_plug_ins_are_shown_in_their_cells(stored: Report, engine: str, words: str) -> None:
    assert set(verdicts(stored, engine).values()) == {"plug-in"} and len(verdicts(stored, engine)) == 2
    assert words in said(stored, engine)


def test_the_other_engines_go_on(stored: Report) -> None:
    assert len(verdicts(stored, "pinocchio")) > 20 and verdicts(stored, "pinocchio")["mass_matrix"] == "right"


def test_an_engine_that_takes_its_process_with_it_crashes_in_its_cells(stored: Report) -> None:
    assert verdicts(stored, "dying") == dict.fromkeys(("mass_matrix", "gravity"), "crashes")
    assert set(said(stored, "dying").splitlines()) == {"killed by SIGABRT"} and set(proven(stored, "dying")) == {False}


def test_an_engine_that_hangs_has_no_answers_and_the_next_one_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    tree = tree_of("revolute x")
    with workers.Worker(limit=2.0) as worker:
        answers = [answer.value for answer in worker.ask(workers.Job("hanging", tree, ("mass_matrix", "gravity")))]
        assert answers == [workers.Crashed("no answer in 2 s")] * 2
    with workers.Worker() as worker:
        for engine in ("dying", "pinocchio"):
            (answer,) = worker.ask(workers.Job(engine, tree, ("mass_matrix",)))
            assert isinstance(answer.value, workers.Crashed) == (engine == "dying")


@pytest.mark.parametrize(
    ("engine", "wanted"),
    [("silent", False), ("starred", True), ("bare", True), ("unproven", False), ("torn", False), ("unnumbered", False)],
)
def test_a_red_cell_is_proven_by_a_script_that_fails_and_by_nothing_else(
    stored: Report, engine: str, wanted: bool
) -> None:
    assert set(verdicts(stored, engine).values()) == {"wrong"}
    assert set(proven(stored, engine)) == {wanted}, [p["output"] for p in stored["proofs"] if p["engine"] == engine]


def test_the_headline_counts_proven_scripts(stored: Report) -> None:
    report = compose(stored)
    good = sum(proof["proven"] for proof in stored["proofs"])
    assert 0 < good < len(stored["proofs"]) - 1
    assert f"{good} scripts prove them" in report.summary
    assert f"{len(stored['proofs']) - good} of {len(stored['proofs'])} faults not proven" in report.summary
    assert "18 cells where a plug-in raises" in report.summary
    facts = {fact.label: fact for fact in report.facts}
    assert facts[f"scripts that prove them, of {len(stored['proofs'])} faults"].value == str(good)
    assert report.ok is False and stored["exit"] == 1  # Two scripts that there are prove nothing.


def test_a_report_is_good_if_only_faults_without_script_are_unproven(stored: Report) -> None:
    few = [proof for proof in stored["proofs"] if proof["engine"] in ("pinocchio", "silent", "starred", "bare")]
    assert compose(stored | {"proofs": few}).ok is True
    assert compose(stored | {"proofs": few, "ours": ["unbuilt"]}).ok is False


def test_no_file_is_written_of_a_proof_without_a_script(stored: Report, tmp_path: Path) -> None:
    parts.write_scripts(stored["proofs"], tmp_path)
    assert not list(tmp_path.glob("silent-*")) and list(tmp_path.glob("starred-*"))


def test_invalid_plug_ins_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    registry = installed(OWN, {"mass_matrix", "gravity"})
    assert set(PLUGINS) <= set(registry.plugins) and set(OWN) <= set(registry.plugins)
    assert set(registry.failures) == {*REFUSED, "absent"}
    assert registry.failures["empty"].startswith("no name, package")
    assert registry.failures["unknown"].startswith("no functions mass_metrix")
    assert "entry point 'other'" in registry.failures["other"]
    assert "AttributeError" in registry.failures["absent"]


def test_cells_in_this_process_do_not_raise_either(monkeypatch: pytest.MonkeyPatch) -> None:
    from validation.engines.interface import Registry

    monkeypatch.setattr(workers, "registry", lambda: Registry({**OWN, **PLUGINS}))
    for engine in PLUGINS:
        found = list(cells(PLUGINS[engine], tree_of("revolute x")))
        assert {cell.verdict for cell in found} <= {"wrong", "plug-in"} and len(found) == 2


# How scripts of red cells end.
ASSERTED = 'value, expected = 1.0, 2.0\nassert abs(value - expected) <= 1e-3, f"{value = }, {expected = }"'


def test_a_script_that_does_not_end_proves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scripts, "_TIME", 0.5)
    path = tmp_path / "endless.py"
    path.write_text("while True: pass\n")
    output, failed = scripts.fails(path)
    assert not failed and "no end in 0.5 s" in output


def test_an_assertion_as_a_tree_is_built_proves_nothing(tmp_path: Path) -> None:
    path = tmp_path / "script.py"
    for text, proven in (("assert False", False), ("assert False, 'no such link'", False), (ASSERTED, True)):
        path.write_text(text)
        assert scripts.fails(path)[1] is proven


def test_a_plug_in_that_raises_fails_its_test_in_pytest(monkeypatch: pytest.MonkeyPatch) -> None:
    from validation.ci import items
    from validation.ci.items import CellFailure
    from validation.engines.verdicts import Cell

    cell = Cell("uncalled", "revolute x", "gravity", "plug-in", words="KeyError: 'no joint 7'")
    monkeypatch.setattr(items, "_cells", lambda *_: {"gravity": cell})
    item = items.EngineCheck.__new__(items.EngineCheck)
    item.engine, item.kind, item.wanted, item.together = "uncalled", "revolute x", "gravity", ("gravity",)
    with pytest.raises(CellFailure, match="in the plug-in: KeyError: 'no joint 7'"):
        item.runtest()
