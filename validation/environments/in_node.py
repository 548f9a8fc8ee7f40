"""WebAssembly in Node: ours and MuJoCo's official module, raced by a program in JavaScript (native/race_wasm.mjs)."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf

from .race import Fail, checked, raced
from .record import NATIVE, OURS, Absent, Row
from .sides import Subject, native

NAME, TITLE = "wasm", "WebAssembly"
PEER = "@mujoco/mujoco"
LIMITS = (
    "Loops over calls are in JavaScript on both sides, under Node; MuJoCo takes one state a call, by the calls that M "
    "and the bias need, without collisions; the rows of native C were timed after the others, in a process of their "
    "own."
)
# Time for all races of a model [s].
_LIMIT = 600.0
_PROGRAM = Path(__file__).parents[1] / "native" / "race_wasm.mjs"
INSTALL_PEER = f"npm install {PEER} (in the folder where the command runs)"


def missing() -> Absent | None:
    """The missing program or package that keeps the environment from running here, if any."""
    if shutil.which("node") is None:
        return Absent(NAME, OURS, "Node is not installed", "install Node 20 or newer (Debian: apt install nodejs)")
    if find_spec("ziglang") is None:
        return Absent(NAME, OURS, "the package ziglang is not installed", "pip install 'symofros[zig]'")
    return None


def run(subject: Subject, states: Sequence[int], turns: int) -> dict[str, Any]:
    """Run the races in Node: versions, and the races with results and times.

    Raises:
        RuntimeError: It failed; with its last words.
        CompileError: ziglang refused.
    """
    with tempfile.TemporaryDirectory() as private:
        folder = Path(private)
        made = sf.export(subject.system, "wasm", folder / "wasm", frames=[])
        scene = sf.export(subject.system, "mjcf", folder / "mjcf", name="robot")
        given = {name: getattr(subject, name).ravel().tolist() for name in ("q", "v", "w")}
        (folder / "states.json").write_text(json.dumps({**given, "counts": list(states), "turns": turns}))
        module = folder / "wasm" / f"{made.name}.mjs"
        described = next(path for path in scene.files if path.suffix == ".xml")
        command = ["node", str(_PROGRAM), str(module), str(folder / "states.json"), str(described)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=_LIMIT)
    if done.returncode != 0 or not done.stdout.strip():
        raise RuntimeError(f"node: {(done.stderr.strip() or 'no word').splitlines()[-1]}")
    printed: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return printed


def rows(subject: Subject, race: dict[str, Any], turns: int, fail: Fail) -> Iterator[Row]:
    """Rows of one race that the program ran: each side against native C, which is timed here."""
    function, states = race["function"], race["states"]
    reference = native(subject, function, states)
    expected, errors = reference.results(), {NATIVE: 0.0}
    for who, results in race["results"].items():
        off = checked(np.array(results, dtype=np.float64), expected, partial(fail, who))
        if off is not None:
            errors[who] = off
    times = {NATIVE: raced([reference], states, turns)[NATIVE], **race["times"]}
    ours = times.get(OURS) if OURS in errors else None
    for who, off in errors.items():
        yield Row.of(NAME, subject.label, function, states, who, times[who], ours, off)
