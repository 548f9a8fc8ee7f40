from __future__ import annotations

import io
import json
import os
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from typer.testing import CliRunner

from tests.late import late
from tests.validation.campaigns.scripted import Scripted, with_a_damaged_page
from validation.__main__ import app
from validation.campaigns.errors import Unfinished
from validation.campaigns.plan import CheckPlan
from validation.campaigns.report import compose
from validation.campaigns.store import Store
from validation.campaigns.summary import checked, swept
from validation.campaigns.sweep import DONE
from validation.campaigns.tasks import CHECKED

runner = late("validation.campaigns.runner")
session = late("validation.campaigns.session")
MANIFEST: dict[str, Any] = {"hash": "abc", "plan": {}, "models": {}, "versions": {}, "begun": ""}


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store.create(tmp_path / "c", MANIFEST)


def test_workers_skip_finished_tasks(store: Store) -> None:
    first = runner.execute(Scripted(4), store.folder, "abc", runner.sources())
    assert runner.execute(Scripted(4, "raise"), store.folder, "abc", runner.sources()) == first == store.part(4)
    assert [line["event"] for line in store.journal()] == ["begun", "done"]


def test_a_worker_that_does_not_see_the_folder_hands_its_part_over(store: Store, tmp_path: Path) -> None:
    handed = runner.execute(Scripted(2), tmp_path / "elsewhere", "abc", runner.sources())
    store.write(2, handed)
    assert store.finished()[0] == {2} and not (tmp_path / "elsewhere").exists()


def test_a_worker_of_other_code_does_nothing(store: Store) -> None:
    with pytest.raises(RuntimeError, match="other code than the client"):
        runner.execute(Scripted(4), store.folder, "abc", runner.sources() | {"source of symofros": "0"})
    assert not store.journal()


@pytest.mark.slow
def test_batches_that_cannot_be_done_leave_the_others_alone(store: Store) -> None:
    done: list[int] = []
    tasks = [Scripted(0), Scripted(1, "raise"), Scripted(2, "die"), *(Scripted(k) for k in range(3, 12))]
    failures = runner.run(store, tasks, runner.Pool(workers=1), lambda task: done.append(task.number))
    assert sorted(done) == [0, *range(3, 12)] and store.finished()[0] == set(done)
    assert failures[1] == "scripted: ZeroDivisionError: a fault"
    assert failures[2] == "scripted: the process that did it died, each time it was tried"


def test_servers_listen_only_on_the_loopback() -> None:
    """Neither scheduler nor workers nor pages of dask."""
    with runner.Pool(workers=1).client() as client:
        addresses = [client.scheduler.address, *client.scheduler_info()["workers"]]
        assert all(address.startswith("tcp://127.0.0.1:") for address in addresses)
        hosts = {address for address, _ in listening(os.getpid())}
        assert hosts == {"0100007F"}, hosts


def listening(process: int) -> set[tuple[str, int]]:
    """Address (hexadecimal, as Linux prints it) and port of each socket that the process listens at."""
    inodes = set()
    for descriptor in Path(f"/proc/{process}/fd").iterdir():
        try:
            target = os.readlink(descriptor)
        except OSError:
            continue
        if target.startswith("socket:["):
            inodes.add(target[8:-1])
    found = set()
    for table in ("tcp", "tcp6"):
        path = Path(f"/proc/net/{table}")
        for line in path.read_text().splitlines()[1:] if path.is_file() else ():
            words = line.split()
            if words[3] == "0A" and words[9] in inodes:
                address, _, port = words[1].partition(":")
                found.add((address, int(port, 16)))
    return found


# A comparison of one batch.
ROW = dict(batch=0, model="arm", engine="pinocchio", quantity="bias", status="agree", agree=True, states=10, note="")
ROW |= dict(states_asked=10, error=1e-15, worst_state=3, scale=2.0, tolerance=1e-12)


def summary(*changes: dict[str, Any]) -> dict[str, Any]:
    return checked(pa.Table.from_pylist([ROW | change for change in changes], CHECKED))


def test_a_summary_keeps_the_worst_state_of_all_batches() -> None:
    data = summary({}, {"batch": 1, "error": 4e-14, "worst_state": 7, "scale": 5.0}, {"batch": 2, "error": 1e-14})
    (group,) = data["groups"]
    assert data["ok"] and data["states"] == 30 and group["states"] == 30
    assert (group["error"], group["batch"], group["worst_state"], group["scale"]) == (4e-14, 1, 7, 5.0)


def test_nan_errors_rank_as_worst() -> None:
    data = summary({}, {"batch": 1, "error": None, "agree": False, "status": "disagree", "worst_state": 5})
    (group,) = data["groups"]
    assert not data["ok"] and group["error"] is None and group["worst_state"] == 5
    spent = {"sessions": 1, "seconds": 1.0, "executions": 2, "repeated": []}
    assert "1 comparison: 1 do not agree" in compose(data | {"kind": "check", "effort": spent}).summary


def test_a_campaign_without_engines_does_not_agree() -> None:
    nobody = {"agree": None, "error": None}
    assert not summary(nobody | {"status": "unsupported"})["ok"]
    assert not summary({}, nobody | {"batch": 1, "status": "failed", "engine": "any", "quantity": "all"})["ok"]


def test_a_sweep_counts_its_failures() -> None:
    points = {"batch": [0, 0], "point": [0, 1], "over:L": [1.0, 2.0]}
    rows = pa.table(points | {"f": [3.0, None], "outcome": [DONE, "lost"], "notes": ["coarse\nsteps", ""]})
    data = swept(rows)
    assert not data["ok"] and data["done"] == 1 and data["failed"] == {"lost": 1}
    assert data["noted"] == 1 and data["first_note"] == "coarse"
    assert data["ranges"] == {"f": {"min": 3.0, "max": 3.0}}


def called(*words: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["campaign", *words])
    return result.exit_code, result.output


@pytest.mark.slow
def test_a_campaign_runs_from_the_command_line_and_resumes(tmp_path: Path) -> None:
    """Done, shown, resumed (nothing is left to do), and not mistaken for another."""
    folder, report = str(tmp_path / "c"), tmp_path / "reports"
    asked = ("--models", "pendulum", "--states", "20", "--batch", "10", "--engines", "pinocchio", "-o", folder)
    code, said = called("run", *asked, "--workers", "1", "--report", str(report), "--json")
    data = json.loads(said.splitlines()[-1])
    assert code == 0 and data["ok"] and data["states"] == 20 and data["effort"]["executions"] == 2
    assert all(data[name] for name in ("machine", "versions", "flags", "date"))
    assert json.loads((report / "campaign.json").read_text()) == data
    code, said = called("show", folder)
    assert code == 0 and compose(data).summary in said
    code, said = called("resume", folder, "--json")
    assert code == 0 and json.loads(said) == data
    code, said = called("run", *asked, "--seed", "1")
    assert code == 2 and "plan changed since: seed: 0 -> 1" in said
    results = tmp_path / "c" / "results.parquet"
    results.write_bytes(with_a_damaged_page(results.read_bytes()))
    code, said = called("show", folder)
    assert code == 2 and "results.parquet is damaged" in said and "remedy" in said


def test_a_damaged_part_is_named_on_resume_and_done_again(store: Store) -> None:
    def complete() -> str:
        with redirect_stderr(io.StringIO()) as said, pytest.MonkeyPatch.context() as patch:
            patch.setattr("validation.campaigns.session.tasks", lambda plan: [Scripted(number) for number in range(3)])
            patch.setattr(
                "validation.campaigns.session.run", lambda store, left, *_: {task.number: "not done" for task in left}
            )
            with pytest.raises(Unfinished) as caught:
                session._complete(store, CheckPlan(models=("pendulum",), states=3, batch=1), runner.Pool(workers=1))
        return f"{said.getvalue()}{caught.value}"

    for number in (0, 1):
        store.write(number, store.encode(number, pa.table({"batch": [number] * 100}), {}))
    part = store.parts / "000001.parquet"
    part.write_bytes(with_a_damaged_page(part.read_bytes()))
    said = complete()
    assert "000001.parquet is damaged, its batch is done again: " in said and "2 batches could not be done" in said
    assert runner.execute(Scripted(1), store.folder, "abc", runner.sources()) == store.part(1)
    assert "is damaged" not in complete()


def test_rows_of_two_generators_do_not_stand_in_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = CheckPlan(models=("pendulum",), states=10)
    Store.create(tmp_path / "c", session._manifest(plan))
    monkeypatch.setattr(
        "validation.campaigns.session.sources", lambda: runner.sources() | {"source of symofros": "of another state"}
    )
    code, said = called("resume", str(tmp_path / "c"))
    assert code == 2 and "versions changed since: source of symofros: " in said
