"""Runs of diagrams: the mechanisms that they move are shown at a time, filmed, and exported as a program."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

import symofros as sf
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import Workspace
from symofros.studio.editor.server.app import application
from tests.studio.editor.conftest import BASE, GRANTED, PORT, TOKEN, finished, look, pose

Json = dict[str, Any]
# One plant falls, another one's joint is driven by a signal.
TEXT = """symofros_diagram: 1
simulation: {t_end: 0.4, dt: 0.002, record: 0.01, method: euler}
models:
  falling: {file: double_pendulum.yaml, start: {q1: 0.3}}
  crane: {file: driven.yaml}
blocks:
  arm: {kind: forward_dynamics, model: falling}
  hoist: {kind: forward_dynamics, model: crane, inputs: {u: course}}
  ramp: {kind: ramp, slope: 2.0}
  still: {kind: constant, value: [2.0, 0.0]}
  course: {kind: join, inputs: {u1: ramp.y, u2: still}}
"""
DRIVEN = """symofros: 1
bodies:
  base: {}
  jib:
    joint: {kind: revolute, name: turn, axis: [0, 0, 1], parent: base, prescribed: true}
    inertia: {mass: 2, moments: [1, 1, 1]}
    frames: {tip: {position: [1, 0, 0]}}
  load:
    joint: {kind: revolute, name: sway, axis: [0, 1, 0], parent: jib, frame: tip}
    inertia: {mass: 1, center_of_mass: [0, 0, -0.5], moments: [0.1, 0.1, 0.1]}
"""


@pytest.fixture
def client(folder: Path) -> Any:
    (folder / "driven.yaml").write_text(DRIVEN)
    (folder / "two.yaml").write_text(TEXT)
    session = Session(Workspace(folder), folder / "two.yaml")
    with TestClient(application(session, TOKEN, PORT), base_url=BASE, headers=GRANTED) as opened:
        yield opened


@pytest.mark.parametrize("mode", ["compiled", "interpreted"])
def test_each_mechanism_of_a_run_is_shown_at_a_time(client: TestClient, folder: Path, mode: str) -> None:
    document = client.get("/api/document").json()
    assert document["problems"] == [] and document["diagram"]["moving"] == ["arm", "hoist"]
    job = finished(client, "run", mode=mode)
    assert job["state"] == "done" and job["result"]["outcome"]["ok"], job["error"]
    run = sf.Simulation(sf.load_diagram(folder / "two.yaml")).run()
    i = int(np.searchsorted(run.t, 0.2))
    # The first one if none is named; a run of it moves what is shown.
    for block in ("", "arm"):
        assert [one["name"] for one in look(client, block)["coordinates"]] == ["q1", "q2"]
        shown = pose(client, run=job["id"], t=0.2, block=block)["q"]
        assert list(shown.values()) == pytest.approx(run.motion("arm")[0][i], abs=1e-6)
    assert look(client, "hoist")["fault"] is None
    shown = pose(client, run=job["id"], t=0.2, block="hoist")["q"]
    assert shown["sway"] == pytest.approx(run.motion("hoist")[0][i, 0], abs=1e-6)
    # The driven joint is drawn where the signal holds it.
    motion = job["result"]["motions"]["hoist"]
    (turn,) = (one["values"] for one in motion["series"] if one["name"] == "turn")
    assert turn == pytest.approx([2.0 * t for t in motion["t"]], abs=1e-6)


@pytest.mark.slow
def test_blocks_that_move_nothing_are_refused(client: TestClient) -> None:
    answer = client.get("/api/view", params={"block": "ramp"})
    assert answer.status_code == 422 and "arm, hoist" in answer.json()["error"]["rule"]
    look(client)
    job = finished(client, "run")
    for run, block in ((job["id"], "ramp"), (job["id"], "hoist")):  # The second is not the one that is shown.
        answer = client.post("/api/pose", json={"run": run, "t": 0.1, "block": block})
        assert answer.status_code == 422 and answer.json()["error"]["remedy"], block
    exported = finished(client, "export", target="c", folder="program")
    answer = client.post("/api/pose", json={"run": exported["id"], "t": 0.1})
    assert answer.status_code == 422 and "no such motion" in answer.json()["error"]["object"]


@pytest.mark.slow
def test_a_diagram_becomes_a_program_that_steps_as_its_file_says(client: TestClient, folder: Path) -> None:
    job = finished(client, "export", target="c", folder="program")
    assert job["state"] == "done", job["error"]
    assert "program/main.c" in job["result"]["files"]
    plant = (folder / "program" / "two_part0_plant.c").read_text()
    assert re.search(r'"euler", .*\n.*, 0\.002, ', plant)
    refused = finished(client, "export", target="wasm", folder="other")
    assert refused["state"] == "failed" and "use target 'c'" in refused["error"]["remedy"]
