"""What workers say becomes a record; what is not there is said; parts of a run; the report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.validation.timing.records import entry, made
from validation.__main__ import app
from validation.timing import report, worker
from validation.timing.contestants import engines
from validation.timing.record import Record
from validation.timing.run import take
from validation.timing.worker import Job, Message

JOB = Job("panda", ("pinocchio", "sympy"), ("dynamics",), 3, 100)


MESSAGES: list[Message] = [
    ("doing", "dynamics"),
    ("part", ("dynamics", "building sympy")),
    ("entry", entry(peer_time=5.0)),
    ("cost", made()),
    ("skipped", ("panda", "dynamics", "sympy", "too large")),
]


def test_messages_of_a_worker_become_a_record() -> None:
    record, reported = Record([entry(peer_time=1.0)]), []
    for message in MESSAGES:
        take(message, JOB, record, lambda *what: reported.append(what))
    assert reported == [("panda", "dynamics", ""), ("panda", "dynamics", "building sympy")]
    assert [x.peer_time[1] for x in record.entries] == [5.0], "the old figure is replaced"
    assert record.costs == [made()] and record.skipped == [("panda", "dynamics", "sympy", "too large")]


@pytest.mark.slow
def test_a_model_is_timed_beside_engines_and_symbolic_peers() -> None:
    """Whole, in this process; Pinocchio's minutes of compilation are left to the run."""
    functions = ("dynamics", "frame_jacobian", "step")
    said = list(worker.work(Job("planar2R", ("mujoco", "casadi", "sympy"), functions, 3, 64)))
    entries = [value for kind, value in said if kind == "entry"]
    pairs = {(x.function, x.peer) for x in entries}
    assert {(name, peer) for name in functions[:1] for peer in ("mujoco", "casadi", "sympy")} <= pairs
    assert ("step", "mujoco") in pairs and ("frame_jacobian", "casadi") in pairs
    assert all(x.error < 1e-9 and 0.0 < x.generated_time[0] <= x.generated_time[1] for x in entries)
    costs = [value for kind, value in said if kind == "cost"]
    assert {x.by for x in costs} == {"symofros", "casadi", "sympy"}
    assert all(x.generation > 0 and x.text > 0 and x.code > 0 and x.memory > 0 for x in costs)


def test_a_peer_that_disagrees_is_skipped_loudly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "STEP", 2 * engines.STEP)
    said = list(worker.work(Job("planar2R", ("mujoco",), ("step",), 3, 64)))
    (words,) = [value for kind, value in said if kind == "failed"]
    assert "differs from ours by" in words[3] and not [value for kind, value in said if kind == "entry"]


def test_an_interrupt_keeps_earlier_measurements(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def half(job: Job, record: Record, done: object) -> None:
        record.entries.append(entry())
        raise KeyboardInterrupt

    monkeypatch.setattr(report, "run_job", half)
    monkeypatch.setattr(report, "prepare", lambda todo, say: [])
    arguments = ["timing", "--model", "panda", "--report", str(tmp_path)]
    assert CliRunner().invoke(app, arguments).exit_code == 130
    assert len(json.loads((tmp_path / "timing.json").read_text())["entries"]) == 1
