"""What is known of each fault: lines of JSON, so that a study that was ended at any point goes on."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from symofros.tools import append_line, stored_lines


class Store:
    """Answers of judges by fault and stage.

    Args:
        path: File of JSON lines; made when the first answer comes.
        root: Folder of the sources: answers about a file that has changed since are left out.
    """

    def __init__(self, path: Path, root: Path) -> None:
        self.path, self.root = path, root
        self._digests: dict[str, str] = {}
        self._answers: dict[tuple[str, str], dict[str, Any]] = {}
        for row in stored_lines(path, _row):
            if not row["module"] or row["digest"] == self.digest(row["module"]):
                self._answers[row["id"], row["stage"]] = row["answer"]

    def digest(self, module: str) -> str:
        """Digest of a module's text; "" for one that is gone."""
        if module not in self._digests:
            file = self.root / module
            text = file.read_bytes() if file.is_file() else b""
            self._digests[module] = hashlib.sha256(text).hexdigest()[:16] if text else ""
        return self._digests[module]

    def get(self, id: str, stage: str) -> dict[str, Any] | None:
        """The answer of a stage; None if it is not known."""
        return self._answers.get((id, stage))

    def put(self, id: str, stage: str, answer: dict[str, Any], module: str = "") -> None:
        """Keep an answer."""
        self._answers[id, stage] = answer
        digest = self.digest(module) if module else ""
        row = {"id": id, "stage": stage, "module": module, "digest": digest, "answer": answer}
        append_line(self.path, row)


def _row(line: Any) -> dict[str, Any]:
    """A line of the store, each value of its type."""
    texts = {name: str(line[name]) for name in ("id", "stage", "module", "digest")}
    return {**texts, "answer": dict(line["answer"])}
