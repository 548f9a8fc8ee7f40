"""A campaign's folder: its plan, a part for each finished batch, at last one Parquet file.

Nothing in it is ever half there: files are written aside and renamed, so a process may be killed at any point.

    plan.json         what is asked for, of which models, with which versions
    journal.jsonl     a line when a batch is begun and when it is done
    parts/N.parquet   the rows of batch N; they go when the whole is written
    results.parquet   all rows in the order of batches, provenance in the metadata
"""

from __future__ import annotations

import fcntl
import io
import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as parquet

from symofros.tools import append_line, stored_lines, write_atomically

from .errors import StoreError

RESULTS = "results.parquet"
KEY = b"symofros.campaign"
_UNREADABLE = (pa.ArrowException, OSError)


class Store:
    """The folder of one campaign.

    Args:
        folder: Folder of the campaign.
        hash: Hash of the plan; parts that do not bear it belong to another.
    """

    def __init__(self, folder: Path, hash: str) -> None:
        self.folder, self.hash = folder, hash
        self.parts = folder / "parts"

    @classmethod
    def create(cls, folder: Path, manifest: dict[str, Any]) -> Store:
        """A new campaign's, or that of the same campaign begun before.

        Args:
            folder: Made where it is missing.
            manifest: Manifest with the plan's `hash` and `versions`.

        Raises:
            StoreError: The folder is another campaign's.
        """
        if (folder / "plan.json").is_file():
            return cls.agreeing(folder, manifest)
        if folder.exists() and any(folder.iterdir()):
            raise StoreError(
                folder, "files, but no plan.json", "a campaign has a folder of its own", "choose a new folder"
            )
        (folder / "parts").mkdir(parents=True, exist_ok=True)
        write_atomically(folder / "plan.json", json.dumps(manifest, indent=1) + "\n")
        return cls(folder, manifest["hash"])

    @classmethod
    def agreeing(cls, folder: Path, manifest: dict[str, Any]) -> Store:
        """The store of a folder whose plan, models and versions are those of a manifest.

        Raises:
            StoreError: Plan, models or versions have changed since, so that old and new rows would not belong together.
        """
        before = manifest_of(folder)
        for what in ("plan", "models", "versions"):
            if before[what] != manifest[what]:
                change = f"{what} changed since: {_difference(before[what], manifest[what])}"
                rule = "all rows of a campaign come from one plan, the same models and the same versions"
                raise StoreError(folder, change, rule, "give the changed campaign a new folder, or undo the change")
        (folder / "parts").mkdir(exist_ok=True)
        return cls(folder, before["hash"])

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Keep other clients out; the system takes the lock from one that dies.

        Raises:
            StoreError: Another has it.
        """
        with (self.folder / "lock").open("w") as stream:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                remedy = "let it finish, or end it and resume"
                raise StoreError(self.folder, "another process runs it", "one at a time", remedy) from None
            yield

    @property
    def results(self) -> Path:
        """The file of all rows."""
        return self.folder / RESULTS

    def finished(self) -> tuple[set[int], dict[str, str]]:
        """Numbers of the batches whose parts are whole; and why other files are none, by their names.

        A batch whose part is damaged counts as not done; the new part replaces it.
        """
        parts, damaged = set(), {}
        for path in sorted(self.parts.glob("*.parquet")):
            fault = self._fault(path)
            if fault:
                damaged[path.name] = fault
            else:
                parts.add(int(path.stem))
        return parts, damaged

    def part(self, number: int) -> bytes | None:
        """The part of a batch, if it is there and whole."""
        path = self._path(number)
        return path.read_bytes() if path.is_file() and not self._fault(path) else None

    def rows(self) -> pa.Table:
        """All rows of a campaign that is done.

        Raises:
            StoreError: Their file is damaged.
        """
        try:
            return _read(self.results)
        except _UNREADABLE as error:
            rule = "results are as the campaign wrote them, checksums included"
            remedy = f"restore {RESULTS} from a copy, or begin anew in a new folder"
            raise StoreError(self.folder, f"{RESULTS} is damaged: {_single_line(error)}", rule, remedy) from None

    def write(self, number: int, part: bytes) -> None:
        """Keep a part."""
        write_atomically(self._path(number), part)

    def encode(self, number: int, rows: pa.Table, facts: dict[str, Any]) -> bytes:
        """Rows -> a part, which says whose it is."""
        return _encoded(rows, {"hash": self.hash, "batch": number, **facts})

    def note(self, **line: Any) -> None:
        """Add to the journal; a short line at the end of a file is written whole or not at all."""
        append_line(self.folder / "journal.jsonl", line | {"time": round(time.time(), 3)})

    def journal(self) -> list[dict[str, Any]]:
        """Every sound line so far; it counts efforts and decides nothing."""
        return stored_lines(self.folder / "journal.jsonl", _noted)

    def merge(self, count: int, provenance: dict[str, Any]) -> Path:
        """Write the one file of all rows; the parts go afterwards.

        Raises:
            FileNotFoundError: A part is missing.
        """
        tables = [_read(self._path(number)) for number in range(count)]
        rows = pa.concat_tables([table.replace_schema_metadata(None) for table in tables])
        write_atomically(self.results, _encoded(rows, provenance))
        self.tidy()
        return self.results

    def tidy(self) -> None:
        """Remove parts whose rows are in the results."""
        for path in self.parts.glob("*.parquet"):
            path.unlink()
        self.parts.rmdir()

    def _path(self, number: int) -> Path:
        return self.parts / f"{number:06d}.parquet"

    def _fault(self, path: Path) -> str:
        """Why a file is no part of this campaign; "" if it is. Its rows are read, since merging will need them."""
        try:
            facts = provenance_of(path)
            if facts["hash"] != self.hash or f"{facts['batch']:06d}" != path.stem:
                return f"it is batch {facts['batch']} of plan {facts['hash']}"
            _read(path)
            return ""
        except (*_UNREADABLE, KeyError, ValueError, TypeError) as error:
            return _single_line(error)


def _noted(line: Any) -> dict[str, Any]:
    """A line of the journal, each value of its type."""
    begun = {"batch": int(line["batch"])} if line["event"] == "begun" else {}
    return {**line, **begun, "event": str(line["event"]), "time": float(line["time"])}


def manifest_of(folder: Path) -> dict[str, Any]:
    """The manifest with which the campaign in a folder was begun, from its plan.json.

    Raises:
        StoreError: The folder holds no campaign.
    """
    try:
        manifest = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
        return {name: manifest[name] for name in ("hash", "plan", "models", "versions", "begun")}
    except FileNotFoundError:
        raise StoreError(folder, "no plan.json", "`campaign run -o` makes the folder", "name that folder") from None
    except (ValueError, KeyError, TypeError, UnicodeDecodeError) as error:
        fault = f"plan.json: {type(error).__name__}: {error}"
        raise StoreError(
            folder, fault, "plan.json is as `campaign run` wrote it", "begin anew in a new folder"
        ) from None


def provenance_of(path: Path) -> dict[str, Any]:
    """Provenance in the metadata of a Parquet file: a part or the results.

    Raises:
        KeyError: It is no file of a campaign.
        OSError: It can't be read.
    """
    provenance: dict[str, Any] = json.loads(parquet.read_metadata(path).metadata[KEY])
    return provenance


def _read(path: Path) -> pa.Table:
    return parquet.read_table(path, page_checksum_verification=True)


def _single_line(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__


def _encoded(rows: pa.Table, facts: dict[str, Any]) -> bytes:
    sink = io.BytesIO()
    stamped = rows.replace_schema_metadata({KEY: json.dumps(facts)})
    parquet.write_table(stamped, sink, compression="zstd", write_page_checksum=True)
    return sink.getvalue()


def _difference(before: Any, now: Any) -> str:
    """The first few entries that differ."""
    if not isinstance(before, dict) or not isinstance(now, dict):
        return f"{before} -> {now}"
    names = [name for name in {**before, **now} if before.get(name) != now.get(name)]
    shown = [f"{name}: {_brief(before.get(name))} -> {_brief(now.get(name))}" for name in names[:3]]
    return "; ".join(shown) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def _brief(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}…"
