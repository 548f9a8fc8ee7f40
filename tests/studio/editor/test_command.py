"""`symofros edit` as a process of its own: started, talked to, killed, started again."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2 as httpx
import pytest
from typer.testing import CliRunner

from symofros.__main__ import app
from tests.studio.editor.texts import FILES

ROOT = Path(__file__).parents[3]


@contextmanager
def served(*arguments: str) -> Iterator[tuple[subprocess.Popen[str], httpx.Client]]:
    """A server, and a client that knows its address and token as it printed them."""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    process = subprocess.Popen(
        [sys.executable, "-m", "symofros", "edit", *arguments, "--no-browser"],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": path},
        cwd=ROOT,
    )
    try:
        assert process.stdout is not None
        address = re.fullmatch(r"(http://127\.0\.0\.1:\d+)/\?token=(\S+)\n", process.stdout.readline())
        assert address
        headers = {"Authorization": f"Bearer {address[2]}"}
        with httpx.Client(base_url=address[1], headers=headers, timeout=60) as client:
            yield process, client
    finally:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return Path(shutil.copy(FILES["four_bar"], tmp_path))


def edit(client: httpx.Client, value: float) -> dict[str, Any]:
    revision = client.get("/api/document").json()["revision"]
    change = {"op": "set", "path": ["parameters", "m", "value"], "value": value}
    answer = client.post("/api/edit", json={"revision": revision, "edits": [change]})
    assert answer.status_code == 200
    found: dict[str, Any] = answer.json()
    return found


@pytest.mark.slow
def test_a_worker_ends_with_a_server_that_is_killed(file: Path) -> None:
    with served(str(file)) as (process, client):
        client.post("/api/jobs", json={"kind": "simulate", "options": {"t_end": 1e7}})
        while client.get("/api/jobs/1").json()["progress"]["text"] in ("starting", "reading"):
            time.sleep(0.05)
        workers = children(process.pid)
        assert workers
        process.send_signal(signal.SIGKILL)
    end = time.monotonic() + 20
    while any(alive(pid) for pid in workers) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(alive(pid) for pid in workers)


def children(pid: int) -> list[int]:
    found = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for line in found for child in line.read_text().split()]


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.slow
def test_pages_are_notified_of_edits_jobs_and_file_changes(file: Path) -> None:
    with served(str(file)) as (process, client), served(str(file)) as (_, other):
        assert len(other.headers["Authorization"]) > 40  # A token of its own.
        assert client.get("/api/document", headers=other.headers).status_code == 401
        token = client.headers["Authorization"].removeprefix("Bearer ")
        with httpx.stream("GET", f"{client.base_url}/api/events?token={token}", timeout=60) as stream:
            assert stream.headers["content-type"].startswith("text/event-stream")
            lines = stream.iter_lines()
            assert next(lines) == ": listening"
            client.headers["X-Client"] = "tab 2"
            edit(client, 3.0)
            assert event(lines, "document") == '{"revision": 2, "name": "four_bar.yaml", "client": "tab 2"}'
            client.post("/api/jobs", json={"kind": "compile"})
            assert '"state": "running"' in event(lines, "job")
            file.write_text("# theirs\n")
            assert event(lines, "disk") == '{"name": "four_bar.yaml"}'
            process.send_signal(signal.SIGINT)  # A page that listens does not hold it up.
            assert process.wait(20) in (0, 130, -signal.SIGINT)


def event(lines: Iterator[str], kind: str) -> str:
    for line in lines:
        if line == f"event: {kind}":
            return next(lines).removeprefix("data: ")
    raise AssertionError("the stream ended")


def test_a_port_in_use_and_a_file_that_is_not_text_are_reported(file: Path, tmp_path: Path) -> None:
    with served(str(file)) as (_, client):
        taken = CliRunner().invoke(app, ["edit", str(file), "--port", str(client.base_url.port), "--no-browser"])
        assert taken.exit_code == 2 and "in use" in taken.output
    (tmp_path / "odd.yaml").write_bytes(b"\xff\xff")
    odd = CliRunner().invoke(app, ["edit", str(tmp_path / "odd.yaml"), "--no-browser"])
    assert odd.exit_code == 2 and "is not UTF-8" in odd.output
