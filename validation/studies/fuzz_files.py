"""What the editor and the viewer open, fed with hostile files: each is shown, or refused in words.

Meshes, recorded motions, samples, documents with what the editor keeps beside them, and kept parts. The answers that
count: a SymofrosError, or of a mesh the warning that it is not drawn. Files may also be no files: folders, pipes, links
to nowhere.
"""

from __future__ import annotations

import json
import os
import socket
import tempfile
import warnings
from collections.abc import Callable
from contextlib import chdir
from functools import cache
from pathlib import Path

import numpy as np

import symofros as sf
from symofros import blocks, tools

from .fuzz_file_inputs import PARTS, PLACE

# Of what is accepted, one in so many is drawn as well.
DRAWN = 25
# A picture of few pixels has all that a large one has.
_SIZE = (64, 48)
# Of a motion, positions at so many times.
_TIMES = 50


def feed_file(kind: str, folder: Path, data: bytes, number: int) -> bool:
    """Give one input to the reader of its kind.

    Args:
        kind: A kind of FILE_KINDS.
        folder: Folder that is empty, and removed afterwards.
        data: The input: content of the file, or PLACE and what is there instead of a file.
        number: Number of the input among its kind.

    Returns:
        Whether it was also drawn.

    Raises:
        SymofrosError: It was refused.
    """
    name = kind if "." in kind else f"hostile.{kind}"
    with tempfile.TemporaryDirectory(dir=folder) as place:
        return _READERS[kind](Path(place), name, data, number)


def put(path: Path, data: bytes) -> None:
    """A file, or what is there instead."""
    what = data.removeprefix(PLACE).decode() if data.startswith(PLACE) else ""
    if not what:
        path.write_bytes(data)
    elif what == "folder":
        path.mkdir()
    elif what == "pipe":
        os.mkfifo(path)
    elif what == "socket":
        # The address of a socket has room for some hundred characters, and folders of tests may have longer names.
        with socket.socket(socket.AF_UNIX) as end, chdir(path.parent):
            end.bind(path.name)
    elif what != "nothing":
        path.symlink_to(
            {"loop": path.name, "endless": "/dev/zero", "dangling": "nowhere", "outside": "/etc/passwd"}[what]
        )


def _mesh(folder: Path, name: str, data: bytes, number: int) -> bool:
    put(folder / name, data)
    visual = tools.Visual("mesh", (1.0, 1.0, 1.0), file=str(folder / name))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = tools.visual_mesh(visual)
    said = [str(warning.message) for warning in caught]
    if mesh is None and len(said) == 1 and said[0].startswith("view: mesh '"):
        raise sf.SymofrosError(said[0])
    if said or mesh is None:
        raise RuntimeError(f"neither drawn nor refused: {said}")
    if number % DRAWN:
        return False
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0, moments=(1, 1, 1)))
    system = sf.System("shown", (body,), visuals={"b": (visual,)})
    sf.record(system, (np.zeros(1), np.zeros((1, 1))), folder / "picture.png", size=_SIZE)
    return True


@cache
def _arm() -> sf.Model:
    """A mechanism of which motions are recorded."""
    inertia = sf.Inertia(1.0, moments=(1, 1, 1))
    upper = sf.RigidBody("upper", sf.Joint("q1", "revolute", actuated=True), inertia, (sf.Frame("tip", (1, 0, 0)),))
    body = sf.RigidBody("lower", sf.Joint("q2", "ball", "upper", "tip"), inertia)
    return sf.compile(sf.System("arm", (upper, body)), sf.Options(backend="interpreter"))


def _motion(folder: Path, name: str, data: bytes, number: int) -> bool:
    put(folder / name, data)
    model = _arm()
    motion = tools.read_motion(folder / name, model)
    q = motion.at(np.linspace(motion.start, motion.end, _TIMES))[0]
    if not np.all(np.isfinite(q)):
        raise RuntimeError("positions between states are not finite")
    return False


def _samples(folder: Path, name: str, data: bytes, number: int) -> bool:
    put(folder / name, data)
    block = blocks.Sequence(name="samples", file=str(folder / name))
    for signal in block.samples().values():
        if not np.all(np.isfinite(signal.values)):
            raise RuntimeError("samples are not finite")
    return False


def _document(folder: Path, name: str, data: bytes, number: int) -> bool:
    """A document, the positions of its blocks, unsaved work on it and a part of the folder's library."""
    contents = [*data.split(PARTS), b"", b"", b""] if not data.startswith(PLACE) else [data] * 4
    (folder / "parts").mkdir()
    file = folder / "hostile.yaml"
    places = (file, folder / ".hostile.editor.json", folder / ".hostile.autosave.yaml", folder / "parts/kept.yaml")
    # Of places that are no files, each in turn.
    for i, (path, content) in enumerate(zip(places, contents, strict=False)):
        if not data.startswith(PLACE) or i == number % len(places):
            put(path, content)
    if not file.exists() and not file.is_symlink():
        file.write_text("symofros: 1\nbodies: {}\n")
    session = tools.Session(tools.Workspace(folder), file)
    json.dumps(session.as_json(), allow_nan=False)  # As the server answers.
    session.workspace.files()
    for part in session.library.listed():
        session.insert_part({"revision": session.document.revision, "name": part["name"]})
        json.dumps(session.as_json(), allow_nan=False)  # As the server answers.
    return False


_READERS: dict[str, Callable[[Path, str, bytes, int], bool]] = {
    **dict.fromkeys(("stl", "obj", "ply", "off", "dae"), _mesh),
    **dict.fromkeys(("motion.npz", "motion.csv", "motion.parquet"), _motion),
    **dict.fromkeys(("samples.npz", "samples.csv"), _samples),
    "document": _document,
}
