"""The folder of compiled models stays within its limit: what was used longest ago goes, and nothing of others."""

import json
import os
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app
from symofros.runtime.build import cache_size
from symofros.runtime.build.cache_size import entries, limit, note_use, prune

DAY = 86400.0


def held(folder: Path, letter: str, days: float, size: int = 1000) -> str:
    """The files of one compiled model, last used so many days ago."""
    name = letter * 32
    for suffix in (".so", ".c", ".digest"):
        (folder / f"{name}{suffix}").write_bytes(b"x" * size)
        used = time.time() - days * DAY
        os.utime(folder / f"{name}{suffix}", (used, used))
    return name


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    monkeypatch.delenv("SYMOFROS_CACHE_LIMIT", raising=False)
    tmp_path.chmod(0o700)
    return tmp_path


def names(folder: Path) -> set[str]:
    return {path.name[0] for path in folder.iterdir()}


def test_the_least_recently_used_library_is_removed_first(folder: Path) -> None:
    for letter, days in (("a", 3), ("b", 9), ("c", 1)):
        held(folder, letter, days)
    assert [entry.files[0].name[0] for entry in entries(folder)] == ["b", "a", "c"]
    removed = prune(folder, 6500.0).removed
    assert [entry.size for entry in removed] == [3000] and names(folder) == {"a", "c"}
    assert prune(folder, 6500.0) == ([], [])


def test_foreign_files_and_links_are_never_removed(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "precious.so"
    elsewhere.write_text("x")
    (folder / "thesis.tex").write_text("x" * 9000)
    (folder / f"{'d' * 32}.so").symlink_to(elsewhere)
    held(folder, "a", 3)
    prune(folder, -1.0)
    assert names(folder) == {"t", "d"} and elsewhere.exists()


def test_a_recently_loaded_model_is_removed_last(folder: Path) -> None:
    old = held(folder, "a", 9)
    held(folder, "b", 3)
    note_use(folder / f"{old}.digest")
    assert [entry.files[0].name[0] for entry in entries(folder)] == ["b", "a"]
    note_use(folder / "missing.digest")


def test_compiling_keeps_the_folder_within_its_limit(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    held(folder, "a", 3, 800_000)
    monkeypatch.setenv("SYMOFROS_CACHE_LIMIT", "1")
    cache_size.keep_within_limit.cache_clear()
    model = sf.compile(
        sf.System("s", [sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0, moments=(1, 1, 1)))])
    )
    assert model.mass_matrix([0.0])[0, 0] == 1.0
    assert not (folder / f"{'a' * 32}.so").exists() and list(folder.glob("*.digest"))


@pytest.mark.parametrize("stated", ["many", "-1", "nan"])
def test_an_invalid_size_limit_is_refused(stated: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE_LIMIT", stated)
    with pytest.raises(sf.SymofrosError, match="is not a size"):
        limit()
    assert CliRunner().invoke(app, ["cache"]).exit_code == 2


def test_the_cache_command_lists_and_removes(folder: Path) -> None:
    held(folder, "a", 3)
    held(folder, "b", 9)
    shown = CliRunner().invoke(app, ["cache"])
    assert shown.exit_code == 0 and "2 compiled parts" in shown.output and "limit 4000 MB" in shown.output
    less = json.loads(CliRunner().invoke(app, ["cache", "--days", "5", "--json"]).stdout)
    assert less["libraries"] == 1 and names(folder) == {"a"}
    none = json.loads(CliRunner().invoke(app, ["cache", "--clear", "--json"]).stdout)
    assert (none["libraries"], none["megabytes"], names(folder)) == (0, 0.0, set())


def test_what_cannot_be_removed_is_not_called_removed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a folder that is only read: "removed 2.1 MB" was said, and all of them were there."""
    held(folder, "a", 3)
    held(folder, "b", 9)
    remove = Path.unlink

    def unlink(self: Path, missing_ok: bool = False) -> None:
        if self.name == f"{'b' * 32}.so":
            raise PermissionError(13, "Permission denied", str(self))
        remove(self, missing_ok=missing_ok)

    monkeypatch.setattr(Path, "unlink", unlink)
    ended = CliRunner().invoke(app, ["cache", "--clear"])
    assert ended.exit_code == 2 and "1 that can't be removed" in ended.output and names(folder) == {"b"}
    assert [len(entries) for entries in prune(folder, -1.0)] == [0, 1]
