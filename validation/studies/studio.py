"""The studio as a user meets it: what the tests in the browser measure on their way, and sizes of what is loaded."""

from __future__ import annotations

import gzip
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import typer

import symofros as sf

from ..inputs.cases import ROBOTS, robot_file
from ..reporting.command import Run
from ..reporting.record import Data

_ROOT = Path(__file__).parents[2]
_FOLDER = "tests/studio/editor/browser"
# Files of tests that measure: sessions with their clicks and keys, times, findings of axe.
TESTS = ("test_sessions.py", "test_fluid.py", "test_accessibility.py", "test_native_code.py")
_SECONDS = 10.0  # Of the replay's motion.


def missing() -> str:
    """What this machine lacks of it; "" for nothing."""
    if not (_ROOT / _FOLDER).is_dir():
        return "a checkout: the sessions are tests of the repository"
    return "" if find_spec("playwright") else "package playwright"


def measure(run: Run) -> Data:
    """Measure the studio in a browser: times to the first picture and of edits, frames, sizes, clicks of sessions."""
    if lacking := missing():
        raise typer.BadParameter(lacking)
    run.expect(2, "sessions in the browser")
    lines, failed = sessions()
    run.advance("sizes of pages and replays")
    found = {**gathered(lines), "failed": failed, "sizes": sizes(), "load": os.getloadavg()[0]}
    run.advance()
    return found


def sessions() -> tuple[list[dict[str, Any]], list[str]]:
    """What the tests measured, and the names of those that failed."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "measures.jsonl"
        files = [f"{_FOLDER}/{name}" for name in TESTS]
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--browser", "--slow", *files]
        environment = {**os.environ, "SYMOFROS_STUDIO_MEASURES": str(file), "PYTHONPATH": str(_ROOT)}
        done = subprocess.run(command, cwd=_ROOT, env=environment, capture_output=True, text=True, check=False)
        texts = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    failed = re.findall(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
    if done.returncode and not failed:
        failed = [f"pytest ends with code {done.returncode}"]
    return [json.loads(text) for text in texts], failed


def gathered(lines: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Lines of the tests by what they are about; a session that was recorded twice counts by its dearer time."""
    by_kind: dict[str, list[dict[str, Any]]] = {kind: [] for kind in ("session", "frames", "edits", "first", "axe")}
    for line in lines:
        by_kind[line["what"]].append({key: value for key, value in line.items() if key != "what"})
    cost = {row["name"]: row for row in sorted(by_kind["session"], key=lambda row: (row["clicks"], row["keys"]))}
    looks = [row["findings"] for row in by_kind["axe"]]
    return {
        "sessions": list(cost.values()),
        "frames": by_kind["frames"],
        "edits": by_kind["edits"],
        "first": by_kind["first"],
        "axe": {"looks": len(looks), "findings": sorted({finding for found in looks for finding in found})},
    }


def sizes() -> list[dict[str, Any]]:
    """Bytes of what is loaded first, of replays, as stated and as servers send them (gzip)."""
    static = Path(str(sf.__file__)).parent / "studio" / "editor" / "static"
    page = (static / "index.html").read_text(encoding="utf-8")
    needed = [static / "index.html", *(static / name for name in re.findall(r'(?:src|href)="\./([^"]+)"', page))]
    rows = [_size("page of the editor, first load", [file.read_bytes() for file in needed], 1_000_000)]
    system = sf.load(robot_file(ROBOTS["panda"].file))
    model = sf.compile(system)
    t = np.linspace(0.0, _SECONDS, 301)
    swing = 0.5 * np.sin(t[:, None] * (1.0 + 0.1 * np.arange(model.nv)))
    q = np.array([model.integrate(model.neutral(), row) for row in swing])
    with tempfile.TemporaryDirectory() as folder:
        replay = sf.record(system, (t, q), Path(folder) / "panda.html").read_bytes()
    return [*rows, _size(f"replay of a Panda, {_SECONDS:g} s with its meshes", [replay], 1_000_000)]


def _size(what: str, contents: list[bytes], most: int) -> dict[str, Any]:
    """Sizes; `most`: of the page as it is sent, of a replay, which is a file, as it stands."""
    return {
        "what": what,
        "bytes": sum(map(len, contents)),
        "sent": sum(len(gzip.compress(content, mtime=0)) for content in contents),
        "is_file": len(contents) == 1,
        "most": most,
    }
