"""A copy of the tree that faults are planted in, and the process beside it that judges them."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..reporting.evidence import digest, revision
from ..worker_process import WorkerError, WorkerProcess
from .fault import SourceFault

# What tests read, beside the packages.
COPIED = ("symofros", "validation", "reference_models", "tests", "docs", "reports", "README.md", "pyproject.toml")
_COPIED_IF_PRESENT = ("CHANGELOG.md", "CONTRIBUTING.md", "LICENSE")
# What judges need and what takes long to import; none of ours, which each judge imports anew, with the fault that is
# planted at the time.
PRELOADED = (
    "numpy numpy.testing numpy.random mpmath scipy.optimize scipy.linalg scipy.sparse scipy.integrate scipy.spatial"
    " pinocchio mujoco casadi exudyn yaml sksundae pytest hypothesis _pytest.assertion.rewrite typer rich.console"
).split()
_MEMORY = 12 << 30  # Bytes of address space: a fault may ask for all there is.
_WAIT = 8  # Seconds that a judge is waited for, over those of processor time: other work delays it.
# Models whose text a fault changes are compiled once and judged once: no optimisation pays.
_COMPILER = '#!/bin/sh\nexec cc "$@" -O0\n'


class Overlay:
    """A folder with a copy of the tree, a compiler, a cache, and a worker process that judges in it.

    Compiled models are found by their C text, so that those of the sound package serve every fault that leaves the text
    as it is, and none that changes it.

    Args:
        root: Folder of the repository.
        folder: Folder that gets the copy.
        cache: Folder of models that are compiled already; None: none are.

    Attributes:
        revision: Revision of the repository that was copied; "" if it is not known.
        digest: Digest of the sources that were copied; "" if it is not known.
    """

    def __init__(self, root: Path, folder: Path, cache: Path | None = None) -> None:
        self._stamp = 2_000_000_000  # Seconds: a time of its own for each planted file, which no bytecode is of.
        self.tree, self.cache, self.log = folder / "tree", folder / "cache", folder / "log"
        self._compiler = folder / "cc"
        folder.mkdir(parents=True, exist_ok=True)
        origins = {"revision": folder / "revision", "digest": folder / "digest"}
        if not self.tree.exists():
            _copy_tree(root, self.tree)
            _fix_identity(self.tree)
            origins["revision"].write_text(revision(root), encoding="utf-8")
            origins["digest"].write_text(digest("mutation", "tests"), encoding="utf-8")
        self.revision, self.digest = (
            origin.read_text(encoding="utf-8").strip() if origin.exists() else "" for origin in origins.values()
        )
        self._backup = folder / "planted.json"  # Of the file that holds a fault, if the process is killed meanwhile.
        self._restore()
        self.cache.mkdir(mode=0o700, exist_ok=True)
        if cache is not None and not any(self.cache.iterdir()):
            _link_cache(cache, self.cache)
        self._compiler.write_text(_COMPILER)
        self._compiler.chmod(0o755)
        self._worker = self._new_worker()

    def _new_worker(self) -> WorkerProcess:
        environment = {
            "PYTHONPATH": str(self.tree),
            "SYMOFROS_CACHE": str(self.cache),
            "CC": str(self._compiler),
            "OMP_NUM_THREADS": "1",
            "PYTHONHASHSEED": "0",
        }
        return WorkerProcess(
            environment=environment, path=(), folder=self.tree, preload=PRELOADED, fresh=True, log=self.log
        )

    def ask(self, module: str, function: str, limit: float, /, **arguments: Any) -> dict[str, Any]:
        """Call a function in a process of its own, with whatever fault is planted.

        Args:
            module: Module of the function.
            function: Name of the function; it returns what JSON holds.
            limit: Processor time after which the process is ended [s].
            arguments: Arguments of the function.

        Returns:
            "fate": "answered", "crashed" or "timed out"; "answer", "code", "seconds".
        """
        began = time.perf_counter()
        answer, code, fate = None, 0, "answered"
        bounds: Any = {"limit": _WAIT * limit, "seconds": limit, "memory": _MEMORY}
        try:
            (answer,) = self._worker.call((module, function), named=arguments, **bounds)
        except WorkerError as error:
            if error.fate == "raised":
                answer = {"status": "raised", "reason": str(error)[:300]}
            else:
                code = -signal.SIGKILL if error.code is None else error.code
                fate = "timed out" if code == -signal.SIGXCPU else error.fate
        return {"fate": fate, "code": code, "answer": answer, "seconds": round(time.perf_counter() - began, 2)}

    @contextmanager
    def planted(self, fault: SourceFault) -> Iterator[None]:
        """The fault is in the copy, and afterwards gone."""
        path = self.tree / fault.module
        sound, modified = path.read_text(encoding="utf-8"), path.stat().st_mtime_ns
        self._backup.write_text(json.dumps({"module": fault.module, "text": sound, "modified": modified}))
        try:
            self._write(path, fault.planted(sound))
            yield
        finally:
            self._restore()

    def _restore(self) -> None:
        """Take out the fault, if there is one."""
        if self._backup.exists():
            backup = json.loads(self._backup.read_text(encoding="utf-8"))
            path = self.tree / backup["module"]
            self._write(path, backup["text"])
            os.utime(path, ns=(backup["modified"], backup["modified"]))
            self._backup.unlink()

    def _write(self, path: Path, text: str) -> None:
        path.write_text(text, encoding="utf-8")
        self._stamp += 1
        os.utime(path, (self._stamp, self._stamp))
        for bytecode in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
            bytecode.unlink()

    def close(self) -> None:
        """End the worker process."""
        self._worker.close()


def _copy_tree(root: Path, tree: Path) -> None:
    """Copies, not links: a fault must never reach the files of the repository."""
    tree.mkdir(parents=True)
    for name in (*COPIED, *(name for name in _COPIED_IF_PRESENT if (root / name).exists())):
        source = root / name
        if source.is_dir():
            shutil.copytree(source, tree / name, symlinks=True)
        else:
            shutil.copy2(source, tree / name)


def _fix_identity(tree: Path) -> None:
    """Generated text is remembered by the digest of the package; what can't change it is left out of the digest here.

    The generator may not import these folders (tests/test_layers.py), so that their faults never reach its text.
    """
    path = tree / "symofros" / "runtime" / "build" / "identity.py"
    text = path.read_text(encoding="utf-8")
    last = '"node_modules")'
    folders = ("simulation", "stepping", "diagrams", "exports", "studio", "blocks", "commands")
    assert text.count(last) == 1
    path.write_text(text.replace(last, f"{last[:-1]}, *{folders!r})"), encoding="utf-8")


def _link_cache(cache: Path, folder: Path) -> None:
    """Compiled models are only ever replaced, not written to, so that links are safe."""
    for path in cache.iterdir():
        if path.is_file() and not path.name.startswith("."):
            try:
                os.link(path, folder / path.name)
            except OSError:
                shutil.copy2(path, folder / path.name)
