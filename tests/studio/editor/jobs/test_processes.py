"""Work in processes of its own: done, failed, cancelled, crashed; the server goes on."""

from __future__ import annotations

import json
import math
import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from symofros.errors import DescriptionError, Problem, SymofrosError
from symofros.runtime.beams import BeamBending, slope_error, slope_of_error
from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.jobs import operations, processes, worker_process
from symofros.studio.editor.jobs.bent_beams import bent_beams
from symofros.studio.editor.jobs.processes import Jobs
from symofros.studio.editor.jobs.worker import error_of
from tests.studio.editor.conftest import finished
from tests.studio.editor.texts import FILES


def test_a_job_simulates_the_closed_loop(client: TestClient) -> None:
    """The loop is closed first; its energy stays."""
    start = {"q1": 1.2, "q2": -1.2, "q3": 1.2}
    job = finished(client, "simulate", t_end=0.5, method="dop853", points=50, q0=start, parameters={"m": 2.0})
    assert job["state"] == "done", job
    found = job["result"]
    assert len(found["t"]) == 51 and found["t"][-1] == pytest.approx(0.5)
    series = [(s["name"], s["kind"], s["unit"]) for s in found["series"]]
    assert series[:4] == [*((f"q{k}", "q", "rad") for k in (1, 2, 3)), ("dq1", "v", "rad/s")]
    assert all(len(s["values"]) == 51 for s in found["series"])
    total = found["energy"]["total"]
    assert max(total) - min(total) < 1e-4 * max(map(abs, found["energy"]["kinetic"]))
    assert found["outcome"]["ok"] and found["method"] == "dop853" and found["steps"] > 3


def simulated(text: str, **options: Any) -> dict[str, Any]:
    """In this process."""
    return operations.simulate({"file": "model.yaml", "text": text, "options": options}, lambda *_: None)


def test_typed_loop_starts_are_kept_or_refused(client: TestClient) -> None:
    text = client.get("/api/document").json()["text"]
    found = simulated(text, t_end=0.01, q0={"q1": 1.0}, v0={"dq1": 1.0})
    first = {series["name"]: series["values"][0] for series in found["series"]}
    assert first["q1"] == 1.0 and first["dq1"] == 1.0 and not found["outcome"]["notes"]
    with pytest.raises(SymofrosError, match=r"q2 = -0\.5 would be -"):
        simulated(text, t_end=0.01, q0={"q1": 1.0, "q2": -0.5, "q3": 0.3})
    notes = simulated(text, t_end=0.01, q0={"q1": 1.2, "q2": -1.2004, "q3": 1.2})["outcome"]["notes"]
    assert any("q2 = -1.2004 was taken as -1.2001" in note for note in notes)


def test_a_loop_that_was_just_drawn_is_simulated(client: TestClient) -> None:
    """Its links lie in one line."""
    text = client.get("/api/document").json()["text"].replace("[L, 0, 0], axis", "[0.7*L, 0, 0], axis")
    found = simulated(text, t_end=0.1)
    assert found["outcome"]["ok"], found["outcome"]


def test_a_document_that_cannot_be_simulated_is_refused_with_a_reason(client: TestClient) -> None:
    """In this process; a worker sends the same words."""
    text = client.get("/api/document").json()["text"]
    refused: list[tuple[dict[str, Any], str]] = [
        ({"method": "rk99"}, "no method 'rk99'"),
        ({"t_end": "soon"}, "t_end is not a number"),
        ({"q0": {"q9": 1}}, "no coordinate 'q9'"),
        ({"q0": {"q1": None}}, "q1 is not a number"),
        ({"inputs": {"nothing": 1}}, "nothing"),
        ({"dt": -1}, "not positive"),
    ]
    for options, says in refused:
        with pytest.raises((SymofrosError, ValueError)) as caught:
            simulated(text, **options)
        error = error_of(caught.value)
        assert says in error["object"] and error["remedy"], options


def test_a_faulty_document_is_reported_without_compiling(client: TestClient) -> None:
    text = client.get("/api/document").json()["text"].replace("parent: crank", "parent: crnk")
    client.post("/api/text", json={"revision": 1, "text": text})
    error = finished(client, "compile")["error"]
    assert "names a parent that does not exist" in error["object"] and error["remedy"] == "did you mean 'crank'?"


@pytest.mark.slow
def test_export_stays_in_the_workspace(client: TestClient, folder: Path) -> None:
    beside = set(folder.parent.iterdir())
    for target, sub, main in (("c", "out/c", "bar.c"), ("urdf", "out2", "bar.urdf")):
        job = finished(client, "export", target=target, folder=sub, name="bar")
        assert job["state"] == "done", job["error"]
        files = job["result"]["files"]
        assert f"{sub}/{main}" in files and all(file.startswith(f"{sub}/") for file in files)
        assert all((folder / file).stat().st_size for file in files)
    assert set(folder.parent.iterdir()) == beside
    for outside in ("../out", "/tmp/out", ".git", ""):
        answer = client.post("/api/jobs", json={"kind": "export", "options": {"target": "c", "folder": outside}})
        assert answer.status_code == 422


def test_an_unknown_job_is_refused(client: TestClient) -> None:
    for body in ({"kind": "import"}, {"kind": "os.system"}, {}, {"kind": "compile", "options": [1]}):
        assert client.post("/api/jobs", json=body).status_code == 422
    assert client.get("/api/jobs/99").status_code == 422


def test_a_job_imports_a_file(client: TestClient, folder: Path) -> None:
    inertia = '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    link = f'<link name="{{}}"><inertial>{inertia}</inertial></link>'
    joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
    urdf = f'<robot name="r">{link.format("a")}{link.format("b")}{joint}</robot>'
    answer = client.post("/api/import", json={"name": "my robot.urdf", "text": urdf})
    found = answer.json()
    assert answer.status_code == 200 and found["path"] == "my_robot.yaml" and found["dirty"]
    assert (
        found["problems"] == []
        and list(found["data"]["bodies"]) == ["a", "b"]
        and "draws them" not in str(found["notes"])
    )
    drawn = '<link name="b"><visual><geometry><sphere radius="0.1"/></geometry></visual>'
    (folder / "r.urdf").write_text(urdf.replace('<link name="b">', drawn))
    found = client.post("/api/import", json={"path": "r.urdf"}).json()
    assert found["path"] == "r.yaml" and "`symofros view r.urdf` draws them" in found["notes"][-1]
    for wrong in (
        {"name": "x.urdf", "text": "<robot"},
        {"name": "x.exe", "text": ""},
        {"path": "../r.urdf"},
        {"name": "../../x.yaml", "text": "a: ]"},
        {"name": "x.urdf"},
    ):
        assert client.post("/api/import", json=wrong).status_code == 422
    assert client.get("/api/document").json()["path"] == "r.yaml"


def test_a_cross_check_without_the_harness_is_reported(
    client: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In this process: the worker's finds it."""
    monkeypatch.setattr("symofros.harness._PACKAGE", folder / "symofros")
    request = {"file": "x.yaml", "text": client.get("/api/document").json()["text"]}
    with pytest.raises(Exception, match="no package 'validation'") as caught:
        operations.cross_check(request, lambda *_: None)
    assert "pip install 'symofros[validation]'" in error_of(caught.value)["remedy"]


@pytest.mark.slow
def test_cross_check_by_workers_that_take_nothing_from_their_folder(
    client: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A module beside a model is not imported, however it is called: neither by the worker nor by the harness."""
    for name in ("numpy", "json", "sympy", "validation"):
        (folder / f"{name}.py").write_text("raise SystemExit('taken from the workspace')")
    monkeypatch.chdir(folder)
    job = finished(client, "crosscheck", states=2)
    assert job["state"] == "done", job
    rows = job["result"]["rows"]
    assert job["result"]["ok"] and rows and all(row["passed"] and row["worst"] <= row["tolerance"] for row in rows)
    assert {"quantity", "engine", "states"} <= rows[0].keys()


def test_a_job_is_cancelled_with_all_that_it_started(client: TestClient) -> None:
    key = client.post("/api/jobs", json={"kind": "simulate", "options": {"t_end": 1e7}}).json()["id"]
    again = client.post("/api/jobs", json={"kind": "simulate", "options": {}})
    assert again.status_code == 422 and "running already" in again.json()["error"]["object"]
    job = client.delete(f"/api/jobs/{key}").json()
    assert job["state"] == "cancelled"  # Its run would take hours.
    assert finished(client, "simulate", t_end=0.01)["state"] == "done"
    assert client.delete(f"/api/jobs/{key}").json()["state"] == "cancelled"


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (DescriptionError(Problem("a", "b", "c", "d", "x:1")), ("a", "b", "c", "d")),
        (DescriptionError([Problem("a"), Problem("b"), Problem("c")]), ("a (and 2 more)", "", "", "")),
        (SymofrosError(Problem("a", "b: b", "", "d")), ("a", "b: b", "", "d")),
        (ValueError("plain: words\n  and more"), ("plain: words\n  and more", "", "", "")),
        (ValueError(), ("ValueError", "", "", "")),
    ],
)
def test_an_error_is_taken_apart(error: Exception, expected: tuple[str, ...]) -> None:
    assert tuple(error_of(error).values()) == expected


def test_a_long_run_says_every_second_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hundredth of a run of a million seconds takes hours: its progress is shown by the clock as well."""
    reported: list[str] = []

    def simulate(*_: Any, progress: Any, **__: Any) -> None:
        for t in (1.0, 2.0, 3.0):
            progress(t)
        raise InterruptedError

    monkeypatch.setattr(operations, "PERIOD", 0.0)
    monkeypatch.setattr(operations.sf, "simulate", simulate)
    request = {"file": "x.yaml", "text": PENDULUM.read_text(), "options": {"t_end": 1e6}}
    with pytest.raises(InterruptedError):
        operations.simulate(request, lambda done, total, text: reported.append(text))
    assert reported[-3:] == ["t = 1 s of 1e+06 s", "t = 2 s of 1e+06 s", "t = 3 s of 1e+06 s"]


# The machinery by itself, with workers that misbehave.


def run(monkeypatch: pytest.MonkeyPatch, code: str) -> tuple[Jobs, Any, list[tuple[str, Any]]]:
    """A job whose worker runs some code."""
    real = worker_process.subprocess.Popen
    reported: list[tuple[str, Any]] = []
    monkeypatch.setattr(
        worker_process.subprocess, "Popen", lambda command, **k: real([sys.executable, "-c", code], **k)
    )
    jobs = Jobs(lambda kind, data: reported.append((kind, data)))
    return jobs, jobs.start("x", {}), reported


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("import os; os.kill(os.getpid(), 11)", "signal 11"),
        ("import sys; sys.stderr.write('because'); raise SystemExit(1)", "because"),
        ("print('no json'); print(3); print('{\"progress\"')", "exit code 0"),
        ("print('[' * 100000)", "exit code 0"),
    ],
)
def test_a_crashed_worker_is_reported_and_replaced(monkeypatch: pytest.MonkeyPatch, code: str, says: str) -> None:
    jobs, job, reported = run(monkeypatch, code)
    assert job.over.wait(30)
    assert job.state == "failed" and says in job.error["found"] and reported[-1][1]["state"] == "failed"
    assert jobs.start("x", {}).over.wait(30)


def test_progress_is_reported_during_the_job(monkeypatch: pytest.MonkeyPatch) -> None:
    code = """if True:
        import json
        for i in range(3):
            print(json.dumps({"progress": {"done": i, "total": 2, "text": "x"}}), flush=True)
        print(json.dumps({"result": {"a": 1}}))
    """
    _, job, reported = run(monkeypatch, code)
    assert job.over.wait(30) and job.state == "done" and job.result == {"a": 1}
    assert [data["progress"]["done"] for _, data in reported] == [0, 1, 2, 2] and "result" not in reported[-1][1]


def test_a_job_of_a_document_that_was_left_gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    jobs, first, _ = run(monkeypatch, "import time; time.sleep(60)")
    assert jobs.running() == [first]
    with pytest.raises(EditError, match="running already"):
        jobs.start("x", {})
    second = jobs.start("x", {}, path="other.yaml")
    assert first.state == "cancelled" and jobs.running() == [second]
    assert second.as_json(whole=False)["path"] == "other.yaml"
    jobs.close()


def test_children_of_a_worker_end_with_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    mark = tmp_path / "pid"
    code = f"""if True:
        import subprocess, sys, time
        child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])
        open({str(mark)!r}, 'w').write(str(child.pid))
        time.sleep(600)
    """
    jobs, job, _ = run(monkeypatch, code)
    for _ in range(3000):
        if mark.exists() and mark.read_text():
            break
        time.sleep(0.02)
    jobs.cancel(job.key)
    child = int(mark.read_text())
    for _ in range(200):
        try:
            os.kill(child, 0)
            if "Z" in Path(f"/proc/{child}/stat").read_text().split()[2]:
                return
        except (ProcessLookupError, FileNotFoundError):
            return
        time.sleep(0.02)
    os.kill(child, signal.SIGKILL)
    raise AssertionError("a child outlives its worker")


def test_a_worker_serves_jobs_in_turn_and_orders_reach_only_their_job(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    code = """if True:
        import json, os, sys
        for line in sys.stdin:
            if line.startswith("{"):
                print(json.dumps({"progress": {"done": 1, "total": 2, "text": "x"}}), flush=True)
                print(json.dumps({"result": os.getpid()}), flush=True)
    """
    jobs, first, _ = run(monkeypatch, code)
    assert first.over.wait(30)
    second = jobs.start("x", {})
    assert second.over.wait(30) and second.result == first.result
    jobs.order(second.key, "stop")
    os.kill(second.result, signal.SIGKILL)  # While it waits: the next job gets another one.
    third = jobs.start("x", {})
    assert third.over.wait(30) and third.state == "done" and third.result != first.result
    jobs.close()


def test_few_jobs_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "KEPT", 3)
    jobs, first, _ = run(monkeypatch, "print('{\"result\": 1}')")
    assert first.over.wait(30)
    for _ in range(4):
        assert jobs.start("x", {}).over.wait(30)
    with pytest.raises(EditError, match="no job"):
        jobs.get(first.key)


PENDULUM = FILES["double_pendulum"].parents[1] / "flexible" / "flexible_pendulum.yaml"


def bending(error: float, sections: int = 0) -> BeamBending:
    return BeamBending("rod", 0.5, math.sqrt(abs(error)), 0.0, 0.01, error, sections=sections)


@pytest.mark.parametrize(
    ("error", "grade"),
    [(0.0, "fine"), (0.01, "fine"), (0.02, "noted"), (0.5, "noted"), (0.6, "beyond"), (math.inf, "beyond")],
)
def test_errors_are_graded_as_results_note_and_refuse_them(error: float, grade: str) -> None:
    (judged,) = bent_beams([bending(error)])
    assert judged["grade"] == grade and judged["t"] is None
    assert judged["error"] == (error if math.isfinite(error) else None)
    json.dumps(judged, allow_nan=False)
    assert bent_beams([bending(0.02)], limit=0.015)[0]["grade"] == "beyond"
    assert bent_beams([bending(0.001, sections=8)])[0]["exact"]  # A rod.


def test_slope_of_error_solves_equation_24() -> None:
    for error in (1e-6, 0.01, 0.1, 0.5, 3.0):
        assert slope_error(slope_of_error(error) ** 2) == pytest.approx(error, rel=1e-12)


def test_a_simulation_carries_the_judgement_of_its_beams() -> None:
    text = PENDULUM.read_text()
    options = {"t_end": 0.2, "q0": {"swing": 1.2}, "points": 20}
    found = operations.simulate({"file": "p.yaml", "text": text, "options": options}, lambda *_: None)
    (rod,) = found["beams"]
    assert rod["beam"] == "rod" and 0.0 < rod["slope"] < 1.0 and 0.0 <= rod["t"] <= 0.2
    assert rod["error"] == pytest.approx(slope_error(rod["slope"] ** 2), rel=0.5)  # Axial loads amplify it.
    assert not rod["exact"] and "rod" in rod["text"]
