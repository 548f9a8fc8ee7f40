"""A guarded application on a folder of its own, as a client sees it."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import Workspace
from symofros.studio.editor.server.app import application
from tests.studio.editor.texts import FILES

TOKEN = "the-token"
PORT = 4711
BASE = f"http://127.0.0.1:{PORT}"
GRANTED = {"Authorization": f"Bearer {TOKEN}"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    root = tmp_path / "work"
    root.mkdir()
    for name in ("four_bar", "double_pendulum"):
        shutil.copy(FILES[name], root)
    return root


@pytest.fixture
def session(folder: Path) -> Session:
    return Session(Workspace(folder), folder / "four_bar.yaml")


@pytest.fixture
def client(session: Session) -> Iterator[TestClient]:
    with TestClient(application(session, TOKEN, PORT), base_url=BASE, headers=GRANTED) as found:
        yield found


def finished(client: TestClient, kind: str, seconds: float = 120.0, **options: Any) -> dict[str, Any]:
    """A job that is over."""
    answer = client.post("/api/jobs", json={"kind": kind, "options": options})
    assert answer.status_code == 202, answer.text
    return over(client, answer.json()["id"], seconds)


def over(client: TestClient, key: str, seconds: float = 120.0) -> dict[str, Any]:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        job: dict[str, Any] = client.get(f"/api/jobs/{key}").json()
        if job["state"] != "running":
            return job
        time.sleep(0.05)
    raise AssertionError(f"job {key} is still running")


def look(client: TestClient, block: str = "") -> dict[str, Any]:
    """The 3-D view of the document; of a diagram, of the mechanism that a block moves."""
    return _answered(client.get("/api/view", params={"block": block}))


def pose(client: TestClient, **body: Any) -> dict[str, Any]:
    """Where the 3-D view stands after a request to move."""
    return _answered(client.post("/api/pose", json=body))


def _answered(answer: Any) -> dict[str, Any]:
    assert answer.status_code == 200, answer.text
    content: dict[str, Any] = answer.json()
    return content
