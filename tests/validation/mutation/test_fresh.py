"""Code is new by its tokens: what was moved, wrapped or commented anew is not."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from validation.mutation.fresh import Fresh, revision_at
from validation.mutation.sampling import drawn

OLD = """
def total(first, second, third):
    return first * second - third * second + first - second * third


def other(first, second, third):
    return max(first / second + third / second - first + second / third, first)
"""
NEW = """
def other(first, second, third):
    # Moved here, with a word on it.
    return max(first / second + third
               / second - first + second / third, first)


def total(first, second, third):
    return first * second - third * second + first - second * third + max(first, third - first) * 2 - first * first
"""


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """Two functions that were moved, and a term that was added."""

    def git(*words: str) -> None:
        author = ("-c", "user.name=a", "-c", "user.email=a@b.c")
        subprocess.run(["git", *author, *words], cwd=tmp_path, check=True, capture_output=True)

    (tmp_path / "symofros" / "expr").mkdir(parents=True)
    (tmp_path / "symofros" / "old.py").write_text(OLD)
    git("init", "-q")
    git("add", "-A")
    git("commit", "-q", "-m", "old", "--date", "2026-01-02T00:00:00")
    (tmp_path / "symofros" / "old.py").unlink()
    (tmp_path / "symofros" / "expr" / "new.py").write_text(NEW)
    git("add", "-A")
    git("commit", "-q", "-m", "new")
    return tmp_path


def test_faults_are_drawn_only_in_added_code(repository: Path) -> None:
    faults = list(drawn(repository, 0, Fresh(repository, "HEAD~1")))
    assert faults and {fault.line for fault in faults} == {9}
    added = NEW.index("+ max") - 12
    assert all(fault.start + len(fault.before) > added for fault in faults)
    assert len(faults) < len(list(drawn(repository, 0)))
    assert not list(drawn(repository, 0, Fresh(repository, "HEAD")))


def test_an_unknown_revision_is_reported(repository: Path) -> None:
    with pytest.raises(LookupError, match="no revision 'nowhere'"):
        Fresh(repository, "nowhere")
    with pytest.raises(LookupError, match="before 2001-01-01"):
        revision_at(repository, "2001-01-01")
