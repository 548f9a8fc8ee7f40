"""A short run of the fuzz campaign, and that it sees what it looks for."""

from __future__ import annotations

import contextlib
import json
import time
from itertools import islice
from pathlib import Path

import pytest
from typer.testing import CliRunner

import symofros as sf
from tests.late import require
from validation.__main__ import app
from validation.studies import fuzz
from validation.studies.fuzz import KINDS, TEXT_KINDS
from validation.studies.fuzz_file_inputs import FILE_KINDS, PLACE, mutated_files, sound_files
from validation.studies.fuzz_files import feed_file
from validation.studies.fuzz_inputs import corpus, mutated


@pytest.mark.slow
def test_no_input_crashes_or_hangs_the_readers() -> None:
    result = fuzz.fuzz(100 * len(KINDS), seed=7)
    assert not result.faults, result.faults[0]
    # Both answers occur for each reader: the inputs are neither all sound nor all rubbish.
    for kind, answers in result.answers.items():
        assert answers.read > 1 and answers.read + answers.refused == 100, kind
        assert answers.refused > (2 if kind == "document" else 30), kind  # Faults of a document are part of the answer.
    assert result.answers["yaml"].compiled and result.answers["urdf"].compiled


@pytest.mark.parametrize("data", corpus("diagram"))
def test_the_diagrams_of_the_corpus_are_sound(tmp_path: Path, data: bytes) -> None:
    fuzz._diagram(tmp_path, data)
    assert sf.load_diagram(tmp_path / "again.yaml").blocks


@pytest.mark.parametrize("kind", FILE_KINDS)
def test_the_files_that_mutations_start_from_are_sound(kind: str, tmp_path: Path) -> None:
    if kind in ("stl", "obj", "ply", "off", "dae"):
        require("trimesh", "view")
    for data in sound_files(kind):
        feed_file(kind, tmp_path, data, 1)


@pytest.mark.parametrize("kind", ["stl", "motion.npz", "motion.csv", "samples.csv", "document"])
@pytest.mark.parametrize("place", ["folder", "pipe", "socket", "loop", "endless", "dangling", "nothing"])
def test_readers_survive_paths_that_are_not_plain_files(kind: str, place: str, tmp_path: Path) -> None:
    for number in range(1, 5):  # Of a document, its positions, unsaved text and part in turn.
        with contextlib.suppress(sf.SymofrosError):
            feed_file(kind, tmp_path, PLACE + place.encode(), number)


@pytest.mark.parametrize("kind", [*TEXT_KINDS, *FILE_KINDS])
def test_inputs_are_the_same_for_the_same_seed(kind: str) -> None:
    made = mutated if kind in TEXT_KINDS else mutated_files
    first = list(islice(made(kind, 3), 20))
    assert first == list(islice(made(kind, 3), 20)) != list(islice(made(kind, 4), 20))


def test_a_crash_is_reported_with_its_input(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def crash(path: object, **options: object) -> sf.System:
        raise RecursionError("deep")

    monkeypatch.setattr(sf, "load", crash)
    done = CliRunner().invoke(app, ["fuzz", "--count", str(8 * len(KINDS)), "--report", str(tmp_path), "--json"])
    assert done.exit_code == 1
    data = json.loads((tmp_path / "fuzz.json").read_text())
    assert json.loads(done.stdout) == data and not data["ok"]
    assert [data["kinds"][kind]["faults"] for kind in TEXT_KINDS] == [8, 8, 0, 0]
    fault = data["faults"][0]
    assert "RecursionError: deep" in fault["what"] and fault["input"].encode("latin-1") == next(mutated("yaml", 0))
    assert "16 crashed or hung a reader" in (tmp_path / "fuzz.md").read_text()


def test_a_hang_is_interrupted_and_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang(path: object, **options: object) -> sf.System:
        while True:
            time.sleep(0.01)

    monkeypatch.setattr(sf, "load", hang)
    monkeypatch.setattr(fuzz, "SLOWEST", 0.1)
    result = fuzz.fuzz(3, seed=0)
    assert [fault.kind for fault in result.faults] == ["yaml", "urdf"]
    assert all("longer than 0.1 s" in fault.what for fault in result.faults)
