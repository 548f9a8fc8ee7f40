"""The folder of compiled models: nobody else's libraries are loaded from it, nor damaged ones."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

import symofros as sf
from symofros.runtime.build.build import build_library
from symofros.runtime.build.cache import cache_folder, unusable
from symofros.runtime.build.toolchain import find_toolchain

SOURCE = "int answer(void) { return 42; }\n"


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "above" / "cache"))
    return tmp_path / "above" / "cache"


def build(source: str = SOURCE) -> Path:
    toolchain = find_toolchain()
    assert toolchain is not None
    return build_library(source, "", toolchain)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def give_away(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a file be another user's: by its owner, or where only the administrator may do so, by this process's user."""
    if os.geteuid() == 0:
        os.chown(path, 12345, -1, follow_symlinks=False)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: 12345)


def test_the_cache_is_private_whatever_the_umask(cache: Path) -> None:
    umask = os.umask(0)
    try:
        library = build()
    finally:
        os.umask(umask)
    assert mode(cache) == mode(cache.parent) == 0o700
    assert not mode(library) & 0o022


def test_a_cache_writable_by_others_is_closed(cache: Path) -> None:
    library = build()
    cache.chmod(0o777)
    assert build() == library and mode(cache) == 0o755


@pytest.mark.parametrize("through_a_link", [False, True])
def test_another_user_s_folder_is_refused(cache: Path, monkeypatch: pytest.MonkeyPatch, through_a_link: bool) -> None:
    build()
    place = cache
    if through_a_link:
        place = cache.with_name("link")
        place.symlink_to(cache)
        monkeypatch.setenv("SYMOFROS_CACHE", str(place))
    give_away(place, monkeypatch)
    with pytest.raises(sf.CompileError, match="can't be trusted") as caught:
        build()
    assert "owns it" in caught.value.problem.found and "SYMOFROS_CACHE" in caught.value.problem.remedy


def test_a_library_owned_by_another_user_is_recompiled(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    library = build()
    if os.geteuid() != 0:
        pytest.skip("only the administrator can give a file away")
    give_away(library, monkeypatch)
    before = library.stat()
    after = build().stat()
    assert after.st_ino != before.st_ino and after.st_uid == 0


def test_a_link_in_place_of_a_library_is_replaced(cache: Path, tmp_path: Path) -> None:
    library = build()
    library.rename(tmp_path / "elsewhere.so")
    library.symlink_to(tmp_path / "elsewhere.so")
    assert build() == library and not library.is_symlink()


def truncated(content: bytes) -> bytes:
    return content[: len(content) // 2]


def with_a_flipped_bit(content: bytes) -> bytes:
    at = len(content) // 2
    return content[:at] + bytes([content[at] ^ 0x10]) + content[at + 1 :]


@pytest.mark.parametrize("damage", [truncated, with_a_flipped_bit, lambda content: b"", lambda content: b"no library"])
def test_a_damaged_library_is_recompiled(cache: Path, damage: Callable[[bytes], bytes]) -> None:
    """Mapping it would end the process by SIGBUS or SIGSEGV."""
    library = build()
    intact = library.read_bytes()
    library.write_bytes(damage(intact))
    assert build() == library and library.read_bytes() == intact


def test_a_library_without_its_digest_is_recompiled(cache: Path) -> None:
    library = build()
    before = library.stat().st_ino
    (statement,) = cache.glob("*.digest")
    statement.unlink()
    assert build().stat().st_ino != before and statement.exists()
    intact = library.stat().st_ino
    assert build().stat().st_ino == intact


def test_leftovers_of_killed_compilations_are_removed_a_day_later(cache: Path, tmp_path: Path) -> None:
    cache.mkdir(parents=True)
    old = [".0123abcd-x_y8z1aa", f".{'0' * 32}.known-abcd1234", f".{'0' * 32}.digest-abcd1234"]
    kept = [".89abcdef-fresh_12", ".ssh", ".bashrc-abcd1234", "0" * 32]
    target = tmp_path / "target"
    target.mkdir()
    (target / "file").touch()
    for name in [*old, *kept]:
        path = cache / name
        if "." in name[1:] or "bashrc" in name:
            path.touch()
        else:
            path.mkdir()
            (path / "model.c").touch()
        if name != kept[0]:
            os.utime(path, (0, 0))
    (cache / ".0123abcd-linklink").symlink_to(target)
    build()
    assert not any((cache / name).exists() for name in old)
    assert all((cache / name).exists() for name in kept)
    assert (target / "file").exists()


def test_the_cache_folder_follows_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("SYMOFROS_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "symofros"


@pytest.mark.parametrize(("number", "remedy"), [(errno.ENOSPC, "make room"), (errno.EACCES, "set SYMOFROS_CACHE")])
def test_a_folder_that_cannot_be_written_says_what_to_do(number: int, remedy: str, tmp_path: Path) -> None:
    error = unusable(tmp_path, OSError(number, os.strerror(number)))
    assert error.problem.remedy.startswith(remedy) and "SYMOFROS_CACHE" in error.problem.remedy
