"""Which releases have a cause: what a script's end says, and what is stored of it."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from validation.engines.causes import history
from validation.engines.causes.cause import FOLDER, read, stated
from validation.engines.causes.history import Proof, named, proof_of, store
from validation.faults import environment

ROOT = Path(__file__).parents[3]
_ASSERTED = 'value, expected = {}, 2.0\nassert abs(value - expected) <= 1e-3, f"{{value = }}, {{expected = }}"'


@pytest.mark.parametrize(
    ("proof", "said"),
    [
        (Proof("1", _ASSERTED.format(1.0)), True),
        (Proof("1", _ASSERTED.format(2.0)), False),
        (Proof("1", "assert False, 'an old reader'"), "AssertionError: an old reader"),
        (Proof("1", "raise ValueError('12x1')", "ValueError", "12x1"), True),
        (Proof("1", "raise ValueError('3x1')", "ValueError", "12x1"), "another ValueError: 3x1"),
        (Proof("1", "import no_such_engine"), "ModuleNotFoundError: No module named 'no_such_engine'"),
        (Proof("1", "import os; os.abort()"), True),
    ],
)
def test_the_end_of_a_script_classifies_a_release(proof: Proof, said: bool | str) -> None:
    assert proof.shown_by(Path(sys.executable)) == said


def test_causes_are_named_by_engine_and_name_and_have_scripts_in_the_report() -> None:
    data: dict[str, Any] = json.loads((ROOT / "reports" / "engines.json").read_text(encoding="utf-8"))
    (cause,) = named(["pinocchio/axes that move with q"])
    proof = proof_of(cause, data)
    assert "pinocchio as pin" in proof.text and not proof.exception
    (cause,) = named(["frax/links without inertia"])
    assert proof_of(cause, data).exception == "AttributeError"
    (two,) = named(["adam/concatenation of two columns"])
    assert proof_of(two, data).exception == "RuntimeError"  # Its last line names a function: "Sparsity::horzcat: ".
    with pytest.raises(ValueError, match="no cause 'frax/fuss'; there are 'frax/"):
        named(["frax/fuss"])
    with pytest.raises(ValueError, match="no script"):
        proof_of(replace(cause, name="another"), data)


def test_found_releases_are_stored_and_nothing_else_changes(tmp_path: Path) -> None:
    path = tmp_path / "dart.yaml"
    shutil.copy(FOLDER / "dart.yaml", path)
    before = read(path)
    store(before[1], "1.0 or before", "", tmp_path)
    store(before[1], "1.1", "1.3", tmp_path)
    store(before[-1], "1.2 or before", "", tmp_path)
    after = read(path)
    assert after[1] == replace(before[1], first="1.1", last="1.3")
    assert after[-1] == replace(before[-1], first="1.2 or before", last="")
    assert after[2:-1] == before[2:-1] and after[0] == before[0]
    assert after[1].releases == "1.1 to 1.3" and after[-1].releases == "1.2 or before, on; none is right yet"


def test_a_release_is_asked_beside_what_was_there_on_its_day(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Of three releases the middle one has the cause; each is installed as of its own day."""
    asked: list[tuple[str, str]] = []

    def kept(folder: Path, requirements: list[str], until: str) -> Path:
        asked.append((requirements[0], until))
        return Path(requirements[0].partition("==")[2])

    monkeypatch.setattr(history, "published", lambda package: ["1.0", "1.1", "1.2"])
    monkeypatch.setattr(history, "day_of", lambda requirement: f"day of {requirement}")
    monkeypatch.setattr(history, "kept", kept)
    monkeypatch.setattr(Proof, "shown_by", lambda self, python: python == Path("1.1"))
    monkeypatch.setattr(history, "proof_of", lambda cause, data: Proof("1.1", ""))
    stored: list[tuple[str, str]] = []
    monkeypatch.setattr(history, "store", lambda cause, first, last: stored.append((first, last)))
    cause = next(one for one in stated() if one.engine == "dart")
    lines = list(history.histories([cause], {}, (), tmp_path))
    assert stored == [("1.1", "1.1")] and "first good: dartpy 1.2" in lines
    assert ("dartpy==1.0", "day of dartpy==1.0") in asked


def test_an_installation_as_of_a_day_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    commands: list[list[str]] = []

    class Done:
        returncode, stderr = 0, ""
        stdout = "wheels = [{ upload-time = 2025-12-31T10:00:00Z }, { upload-time = 2025-12-30T10:00:00Z }]"

    def run(command: list[str], **_: object) -> Done:
        commands.append(command)
        return Done()

    monkeypatch.setattr("subprocess.run", run)
    monkeypatch.setattr("venv.create", lambda *_, **__: None)
    monkeypatch.setattr("shutil.which", lambda name: name)
    assert environment.day_of("pin==3.8.0") == "2026-01-01"
    environment.make(tmp_path / "a", ["pin==3.8.0"], "2026-01-01")
    environment.make(tmp_path / "b", ["pin==3.8.0"])
    assert "--exclude-newer=2026-01-01" in commands[1] and not any("exclude" in one for one in commands[2])
