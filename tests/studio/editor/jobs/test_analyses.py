"""Analyses in worker processes, against formulas of small models."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from symofros.errors import SymofrosError
from symofros.studio.editor.jobs.analyses import SHARE, TURN
from symofros.studio.editor.jobs.sweeps import analyse
from tests.studio.editor.conftest import finished

G, L = 9.81, 0.4
# A rod's mass at its tip, on a joint that starts level: it rests hanging down, q = pi/2.
PENDULUM = f"""symofros: 1
system: {{gravity: [0, 0, -{G}]}}
parameters: {{l: {L}, m: 0.5}}
bodies:
  bob:
    joint: {{kind: revolute, name: q, axis: [0, 1, 0], actuated: true}}
    inertia: {{mass: m, center_of_mass: [l, 0, 0], moments: [0, 0, 0]}}
"""


def analysed(text: str = PENDULUM, **options: Any) -> dict[str, Any]:
    """In this process; a worker does the same."""
    return analyse({"file": "model.yaml", "text": text, "options": options}, lambda *_: None)


def rows(result: dict[str, Any], caption: str) -> dict[str, list[Any]]:
    (found,) = (table for table in result["tables"] if table["caption"].startswith(caption))
    assert all(len(row) == len(found["head"]) for row in found["rows"])
    return {row[0]: row[1:] for row in found["rows"]}


def test_a_pendulum_rests_and_swings_as_its_formula_says() -> None:
    """It hangs down; omega^2 = g / l; A = [[0, 1], [-g/l, 0]], B = [0, 1/(m l^2)]."""
    rest = analysed(what="equilibrium")
    assert rows(rest, "Coordinates") == {"q [rad]": [pytest.approx(math.pi / 2)]}
    assert rest["start"] == {"q": pytest.approx(math.pi / 2)} and rest["motions"]["at rest"]["t"] == [0.0]
    found = analysed(what="modes")
    omega = math.sqrt(G / L)
    assert found["title"].startswith("1 mode about the equilibrium;")
    (row,) = rows(found, "Modes").values()
    assert row == [pytest.approx(omega / (2 * math.pi)), pytest.approx(omega), 0.0, 0.0, pytest.approx(omega), "q"]
    ((name, motion),) = found["motions"].items()
    assert name == f"mode 1, {omega / (2 * math.pi):.4g} Hz"
    swing = np.array(motion["series"][0]["values"]) - math.pi / 2
    assert abs(swing).max() == pytest.approx(TURN) and motion["t"][-1] == 4.0
    # A turn a second: after a half the other way, after one where it was.
    half = len(swing) // 8
    assert swing[half] == pytest.approx(-swing[0]) and swing[2 * half] == pytest.approx(swing[0])
    flat = analysed(what="linear")
    A, B = rows(flat, "A"), rows(flat, "B")
    assert A["q"] == [0.0, 1.0] and A["dq"] == [pytest.approx(-G / L), pytest.approx(0.0, abs=1e-12)]
    assert B["q"] == [0.0] and B["dq"] == [pytest.approx(1 / (0.5 * L**2))]


def test_held_coordinates_need_an_effort_and_the_posture_itself_can_be_analysed() -> None:
    level = analysed(what="equilibrium", held=["q"])
    torque = -0.5 * G * L
    assert rows(level, "Efforts")["q"] == rows(level, "Inputs")["q"] == [pytest.approx(torque)]
    # Upright it falls: a real pair +-sqrt(g/l).
    up = analysed(what="linear", about="pose", q0={"q": -math.pi / 2})
    reals = sorted(row[3] for row in rows(up, "Eigenvalues").values())
    assert reals == [pytest.approx(-math.sqrt(G / L)), pytest.approx(math.sqrt(G / L))]
    assert up["notes"] == [] and "about the stated pose" in up["title"]
    # An input moves the equilibrium.
    turned = analysed(what="equilibrium", u={"q": torque / 2}, q0={"q": 1.0})
    assert rows(turned, "Coordinates")["q [rad]"] == [pytest.approx(math.pi / 3)]


def test_what_is_noted_of_modes_is_noted_of_linear_models_and_of_sweeps() -> None:
    """At 0.5 rad it falls: neither a rest nor a steady motion, whatever its length."""
    at = {"about": "pose", "q0": {"q": 0.5}}
    (note,) = analysed(what="modes", **at)["notes"]
    assert note.startswith("the state is neither an equilibrium")
    assert analysed(what="linear", **at)["notes"] == [note]
    (swept,) = analysed(what="sweep", of="frequencies", parameter="l", low=L, high=2 * L, count=3, **at)["notes"]
    assert swept == f"l = {L} and 2 more: {note}"


SLIDER = PENDULUM.replace(
    "kind: revolute, name: q, axis: [0, 1, 0], actuated: true",
    "kind: prismatic, name: q, axis: [0, 0, 1], elements: [{spring: {stiffness: 50}}]",
)


def test_a_displacement_is_drawn_as_a_share_of_the_mechanism() -> None:
    found = analysed(SLIDER, what="modes")
    ((_, motion),) = found["motions"].items()
    q = np.array(motion["series"][0]["values"])
    assert q.max() - q.min() == pytest.approx(2 * SHARE * L, rel=1e-6)


def test_invalid_analyses_are_refused() -> None:
    refused: list[tuple[dict[str, Any], str]] = [
        ({"what": "horoscope"}, "no analysis"),
        ({"what": "equilibrium", "held": ["z"]}, "z"),
        ({"what": "modes", "u": {"z": 1}}, "no input 'z'"),
        ({"what": "modes", "q0": {"q": "soon"}}, "q is not a number"),
    ]
    for options, says in refused:
        with pytest.raises(SymofrosError, match=says):
            analysed(**options)


def test_a_loop_is_analysed_in_a_worker_and_its_modes_are_shown(client: TestClient) -> None:
    """The four-bar keeps one degree of freedom: a mode, two states."""
    job = finished(client, "analyse", what="linear")
    assert job["state"] == "done", job
    assert len(rows(job["result"], "A")) == 2 and "what the constraints leave" in job["result"]["title"]
    job = finished(client, "analyse", what="modes")
    (name,) = job["result"]["motions"]
    assert client.get("/api/view").status_code == 200
    shown = client.post("/api/pose", json={"run": job["id"], "t": 0.25, "block": name})
    q = {series["name"]: series["values"] for series in job["result"]["motions"][name]["series"]}
    index = job["result"]["motions"][name]["t"].index(0.25)
    assert shown.json()["q"] == {key: pytest.approx(values[index]) for key, values in q.items()}
