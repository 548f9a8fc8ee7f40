"""What workers print becomes a record; what is not there is said; parts of a run; the report."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.validation.timing.records import entry, made
from validation.__main__ import app
from validation.timing import measure, worker
from validation.timing.contestants import engines
from validation.timing.record import Record
from validation.timing.run import take
from validation.timing.worker import Job

JOB = Job("panda", ("pinocchio", "sympy"), ("dynamics",), 3, 100)


LINES = [
    json.dumps({"doing": "dynamics"}),
    json.dumps({"part": ["dynamics", "building sympy"]}),
    "a warning of an engine",
    "3",
    json.dumps({"entry": asdict(entry(peer_time=5.0))}),
    json.dumps({"cost": asdict(made())}),
    json.dumps({"skipped": ["panda", "dynamics", "sympy", "too large"]}),
]


def test_output_lines_of_a_worker_become_a_record() -> None:
    record, told = Record([entry(peer_time=1.0)]), []
    for line in LINES:
        take(line, JOB, record, lambda *what: told.append(what))
    assert told == [("panda", "dynamics", ""), ("panda", "dynamics", "building sympy")]
    assert [x.peer_time[1] for x in record.entries] == [5.0], "the old figure is replaced"
    assert record.costs == [made()] and record.skipped == [("panda", "dynamics", "sympy", "too large")]


def test_a_worker_ends_with_its_parent_process() -> None:
    """Were it to go on, it would take a core from whatever is measured next."""
    job = {"model": "chain52", "peers": [], "functions": ["forward_dynamics"], "repeats": 10**6, "states": 64}
    command, pipe = [sys.executable, "-m", "validation.timing.worker", json.dumps(job)], subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as process:
        assert process.stdin is not None and process.stdout is not None
        assert "forward_dynamics" in process.stdout.readline()
        process.stdin.close()
        assert process.wait(30) == 1


@pytest.mark.slow
def test_a_model_is_timed_beside_engines_and_symbolic_peers() -> None:
    """Whole, in this process; Pinocchio's minutes of compilation are left to the run."""
    said: list[tuple[str, object]] = []
    functions = ("dynamics", "frame_jacobian", "step")
    worker.work(Job("planar2R", ("mujoco", "casadi", "sympy"), functions, 3, 64), lambda *what: said.append(what))
    entries = [value for kind, value in said if kind == "entry" and isinstance(value, dict)]
    pairs = {(x["function"], x["peer"]) for x in entries}
    assert {(name, peer) for name in functions[:1] for peer in ("mujoco", "casadi", "sympy")} <= pairs
    assert ("step", "mujoco") in pairs and ("frame_jacobian", "casadi") in pairs
    assert all(x["error"] < 1e-9 and 0.0 < x["generated_time"][0] <= x["generated_time"][1] for x in entries)
    costs = [value for kind, value in said if kind == "cost" and isinstance(value, dict)]
    assert {x["by"] for x in costs} == {"symofros", "casadi", "sympy"}
    assert all(x["generation"] > 0 and x["text"] > 0 and x["code"] > 0 and x["memory"] > 0 for x in costs)


def test_a_peer_that_disagrees_is_skipped_loudly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "STEP", 2 * engines.STEP)
    said: list[tuple[str, object]] = []
    worker.work(Job("planar2R", ("mujoco",), ("step",), 3, 64), lambda *what: said.append(what))
    (words,) = [value for kind, value in said if kind == "failed" and isinstance(value, list)]
    assert "differs from ours by" in words[3] and not [value for kind, value in said if kind == "entry"]


def test_an_interrupt_keeps_earlier_measurements(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def half(job: Job, record: Record, done: object) -> None:
        record.entries.append(entry())
        raise KeyboardInterrupt

    monkeypatch.setattr(measure, "run_job", half)
    monkeypatch.setattr(measure, "prepare", lambda todo, say: [])
    arguments = ["timing", "--model", "panda", "--report", str(tmp_path)]
    assert CliRunner().invoke(app, arguments).exit_code == 130
    assert len(json.loads((tmp_path / "timing.json").read_text())["entries"]) == 1
