from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest

from symofros.errors import StoredStateWarning
from tests.validation.campaigns.scripted import with_a_damaged_page
from validation.campaigns.errors import StoreError
from validation.campaigns.store import Store, manifest_of, provenance_of
from validation.campaigns.summary import effort

MANIFEST: dict[str, Any] = {
    "hash": "abc",
    "plan": {"kind": "check", "seed": 0},
    "models": {"arm": "1"},
    "versions": {"numpy": "2"},
    "begun": "now",
}


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store.create(tmp_path / "c", MANIFEST)


def part(store: Store, number: int) -> bytes:
    return store.encode(number, pa.table({"batch": [number], "x": [0.1 * number]}), {"seconds": 0.5})


def test_a_part_that_is_damaged_counts_as_not_done(store: Store) -> None:
    store.write(0, part(store, 0))
    whole = part(store, 1)
    (store.parts / "000001.parquet").write_bytes(whole[: len(whole) // 2])
    (store.parts / "000002.parquet").write_bytes(b"")
    (store.parts / "000003.parquet").write_bytes(with_a_damaged_page(part(store, 3)))
    finished, damaged = store.finished()
    assert finished == {0} and list(damaged) == ["000001.parquet", "000002.parquet", "000003.parquet"]
    assert all(damaged.values())
    assert store.part(1) is None and store.part(3) is None


def test_parts_of_another_plan_or_place_are_ignored(store: Store) -> None:
    store.write(3, part(Store(store.folder, "other"), 3))
    store.write(4, part(store, 5))
    assert store.finished()[0] == set()


def test_a_kill_in_the_middle_of_writing_leaves_no_part(store: Store) -> None:
    code = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from validation.campaigns.store import Store\n"
        "os.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)\n"
        "Store(Path(sys.argv[1]), 'abc').write(0, b'x' * 1000)\n"
    )
    ended = subprocess.run([sys.executable, "-c", code, str(store.folder)], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert store.finished()[0] == set() and store.part(0) is None


def test_parts_become_one_file_in_their_order(store: Store) -> None:
    for number in (2, 0, 1):
        store.write(number, part(store, number))
    path = store.merge(3, {"hash": "abc", "machine": {"cores": "2"}})
    rows = parquet.read_table(path)
    assert rows["batch"].to_pylist() == [0, 1, 2] and not store.parts.exists()
    assert provenance_of(path) == {"hash": "abc", "machine": {"cores": "2"}}


def test_a_missing_part_is_not_passed_over(store: Store) -> None:
    store.write(0, part(store, 0))
    with pytest.raises(FileNotFoundError):
        store.merge(2, {})
    assert not store.results.exists() and store.finished()[0] == {0}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"plan": {"kind": "check", "seed": 1}}, "plan changed since: seed: 0 -> 1"),
        ({"models": {"arm": "2"}}, 'models changed since: arm: "1" -> "2"'),
        ({"versions": {"numpy": "3"}}, 'versions changed since: numpy: "2" -> "3"'),
    ],
)
def test_a_changed_campaign_is_refused(store: Store, change: dict[str, Any], says: str) -> None:
    with pytest.raises(StoreError, match="remedy") as caught:
        Store.create(store.folder, MANIFEST | change)
    assert says in str(caught.value)


def test_a_folder_with_other_things_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(StoreError, match="no plan.json"):
        Store.create(tmp_path, MANIFEST)


@pytest.mark.parametrize("text", ["{", "[]", json.dumps({"hash": "a"})])
def test_a_broken_plan_is_refused(store: Store, text: str) -> None:
    (store.folder / "plan.json").write_text(text)
    with pytest.raises(StoreError, match="begin anew"):
        manifest_of(store.folder)


def test_two_clients_do_not_share_a_folder(store: Store) -> None:
    with store.lock(), pytest.raises(StoreError, match="another process runs it"), store.lock():
        pass
    with store.lock():
        pass


@pytest.mark.parametrize("torn", [b'{"event": "beg', b"\xff\x00", b"7", b'{"event": "begun", "time": 1}'])
def test_a_torn_line_of_the_journal_is_left_out(store: Store, torn: bytes) -> None:
    store.note(event="session")
    store.note(event="begun", batch=0)
    with (store.folder / "journal.jsonl").open("ab") as stream:
        stream.write(torn)  # As a killed process, or a full disk, leaves it.
    store.note(event="done", batch=0)
    with pytest.warns(StoredStateWarning, match=r"journal\.jsonl: 1 of its lines \(3\)"):
        journal = store.journal()
    assert [line["event"] for line in journal] == ["session", "begun", "done"]
    assert effort(journal)["executions"] == 1
