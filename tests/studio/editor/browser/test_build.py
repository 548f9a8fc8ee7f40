"""The committed page is what its source builds to, small enough, and its own tests pass."""

from __future__ import annotations

import gzip
import re
import subprocess
from pathlib import Path

import pytest

import symofros.studio.editor

GUI = Path(symofros.studio.editor.__file__).parent
# What must be loaded before anything is seen.
FIRST_LOAD_BYTES = 1_000_000


def files(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_the_first_load_is_small() -> None:
    static = GUI / "static"
    page = (static / "index.html").read_text()
    needed = [static / "index.html", *(static / name for name in re.findall(r'(?:src|href)="\./([^"]+)"', page))]
    assert len(needed) >= 3
    assert sum(len(gzip.compress(file.read_bytes())) for file in needed) < FIRST_LOAD_BYTES


@pytest.mark.browser
def test_the_committed_page_matches_its_source(node_modules: Path, tmp_path: Path) -> None:
    build = ["npx", "vite", "build", "--outDir", str(tmp_path / "static"), "--emptyOutDir", "--logLevel", "error"]
    subprocess.run(build, cwd=node_modules.parent, check=True)
    assert files(tmp_path / "static") == files(GUI / "static")


@pytest.mark.browser
@pytest.mark.parametrize("script", ["check", "test"])
def test_the_page_passes_its_own_checks(node_modules: Path, script: str) -> None:
    done = subprocess.run(["npm", "run", "-s", script], cwd=node_modules.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
