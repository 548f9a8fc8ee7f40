"""All reports of one state of the code: made one by one, gone on with after an end of any kind, named where not."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from tests.validation.dashboard.test_gather import FUZZ
from validation.__main__ import app
from validation.dashboard import everything
from validation.dashboard.catalogue import TOPICS
from validation.dashboard.everything import Job
from validation.reporting.command import present

ROOT = Path(__file__).parents[3]
# In place of a report's command: writes what that would write, as its name asks for.
CHILD = """
import json, pathlib, sys, time
name, folder, data, way = sys.argv[1:5]
print("doing", name, flush=True)
if way == "endless":
    time.sleep(1000)
if way == "broken":
    raise ValueError("no such thing")
path = pathlib.Path(folder) / f"{name}.json"
path.write_text(data)
with (pathlib.Path(folder) / "runs").open("a") as runs:
    runs.write(name + chr(10))
sys.exit(1 if way == "missed" else 0)
"""
NAMES = ("fuzz", "mutation", "oracle")


def faked(ways: dict[str, str]) -> Any:
    """`Job.command` with processes that take no time."""

    def command(job: Job, topic: Any) -> list[str]:
        data = json.dumps(FUZZ | {"digest": everything.present(topic)})
        return [sys.executable, "-c", CHILD, topic.name, str(job.output), data, ways.get(topic.name, "")]

    return command


@pytest.fixture
def ways(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """How each report ends, by name: all are fuzz's, so that they can be read."""
    ends: dict[str, str] = {}
    monkeypatch.setattr(Job, "command", faked(ends))
    topics = {name: TOPICS["fuzz"] for name in NAMES}
    monkeypatch.setattr(everything, "TOPICS", {name: replace(one, name=name) for name, one in topics.items()})
    monkeypatch.setattr(everything, "NEEDS", {})
    known = present(TOPICS["fuzz"])  # Which reads every source: no code changes meanwhile.
    monkeypatch.setattr(everything, "present", lambda topic: known)
    monkeypatch.setattr(
        everything, "_POLL_SECONDS", 0.01
    )  # Children end at once: nobody waits for another look at them.
    return ends


def run(folder: Path, *words: str) -> Any:
    return CliRunner().invoke(app, ["all", "--output", str(folder), "--work", str(folder / "work"), *words])


def made(folder: Path) -> list[str]:
    runs = folder / "runs"
    return runs.read_text().split() if runs.exists() else []


def test_missing_reports_are_made_and_current_ones_kept(tmp_path: Path, ways: dict[str, str]) -> None:
    first = run(tmp_path)
    assert first.exit_code == 0 and made(tmp_path) == [*NAMES], first.output
    assert "[1/3] fuzz: written" in first.output
    again = run(tmp_path, "--resume")
    assert again.exit_code == 0 and made(tmp_path) == [*NAMES]
    assert again.output.count("made already of this code") == 3
    # What is of other code, made otherwise or damaged is made anew.
    state = json.loads((tmp_path / "work/state.json").read_text())
    assert set(state) == set(NAMES) and state["fuzz"]["digest"] == present(TOPICS["fuzz"])
    state["fuzz"]["digest"] = "other code"
    state["oracle"]["quick"] = True
    (tmp_path / "work/state.json").write_text(json.dumps(state))
    (tmp_path / "mutation.json").write_text("{}")
    for words in (("--resume",), ("--resume", "--quick")):
        before = len(made(tmp_path))
        assert run(tmp_path, *words).exit_code == 0 and made(tmp_path)[before:] == [*NAMES]


def test_a_report_that_fails_keeps_no_other_from_being_made(tmp_path: Path, ways: dict[str, str]) -> None:
    ways |= {"fuzz": "missed", "mutation": "broken"}
    done = run(tmp_path)
    assert done.exit_code == 1 and made(tmp_path) == ["fuzz", "oracle"]
    assert "fuzz: written; something in it is missed" in done.output
    assert "mutation: failed (1)" in done.output and "ValueError: no such thing" in done.output
    ways.clear()
    assert run(tmp_path, "--resume").exit_code == 0 and made(tmp_path) == ["fuzz", "oracle", "mutation"]


PARENT = """
import sys
from tests.validation.dashboard.test_everything import NAMES, faked
from validation.__main__ import app
from validation.dashboard import everything
everything.Job.command = faked({"mutation": "endless"} if sys.argv[1] == "endless" else {})
everything.TOPICS = {name: everything.TOPICS[name] for name in NAMES}
everything.NEEDS, everything._POLL_SECONDS = {}, 0.01
everything.present = lambda topic: "of this code"
everything.Job._written = lambda job, topic: (job.output / f"{topic.name}.json").exists()
app(["all", *sys.argv[2:]])
"""


def parent(folder: Path, way: str, *words: str) -> subprocess.Popen[bytes]:
    asked = ["--output", str(folder), "--work", str(folder / "work"), *words]
    command = [sys.executable, "-c", PARENT, way, *asked]
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    return subprocess.Popen(
        command,
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": paths},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # A shell's background jobs ignore it.
    )


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_run_that_is_ended_goes_on_where_it_was(tmp_path: Path, how: signal.Signals) -> None:
    """Ctrl-C reaches the whole group of processes; a kill leaves no time for words."""
    process = parent(tmp_path, "endless")
    log = tmp_path / "work/mutation.log"
    end = time.monotonic() + 120.0
    while not (log.exists() and b"doing" in log.read_bytes()) and time.monotonic() < end:
        time.sleep(0.1)
    os.killpg(process.pid, how)
    said, _ = process.communicate(timeout=60)
    assert made(tmp_path) == ["fuzz"] and set(json.loads((tmp_path / "work/state.json").read_text())) == {"fuzz"}
    if how == signal.SIGINT:
        assert process.returncode == 130 and b"mutation: interrupted; --resume goes on with it" in said, said
        return
    again = parent(tmp_path, "at once", "--resume")
    said, _ = again.communicate(timeout=120)
    assert again.returncode == 0 and made(tmp_path) == ["fuzz", "mutation", "oracle"], said
    assert b"fuzz: made already of this code" in said
