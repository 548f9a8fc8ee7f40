"""Runs of diagrams in worker processes: messages meanwhile agree with the result; orders are followed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.jobs.processes import Job, Jobs

TEXT = """symofros_diagram: 1
simulation: {t_end: 1, dt: 0.01, record: 0.05, plots: [{title: Path, signals: [both], xy: true}, [wave.rate]]}
blocks:
  wave: {kind: sine, unit: rad}
  both: {kind: join, inputs: {u1: wave.y, u2: wave.rate}}
"""

Told = list[tuple[str, dict[str, Any]]]


@pytest.fixture
def reported() -> Told:
    return []


@pytest.fixture
def jobs(reported: Told) -> Iterator[Jobs]:
    jobs = Jobs(lambda kind, data: reported.append((kind, data)))
    yield jobs
    jobs.close()


def started(jobs: Jobs, folder: Path, text: str = TEXT, **options: Any) -> Job:
    return jobs.start("run", {"file": str(folder / "d.yaml"), "text": text, "options": options})


def samples(reported: Told) -> list[dict[str, Any]]:
    return [data for kind, data in reported if kind == "samples"]


def paused(reported: Told) -> bool:
    return any(data["progress"].get("paused") for kind, data in reported if kind == "job")


@pytest.mark.parametrize(("order", "end"), [("resume", 1.0), ("stop", 0.5)])
def test_a_run_waits_at_its_breakpoint_and_follows_the_order(
    jobs: Jobs, reported: Told, tmp_path: Path, order: str, end: float
) -> None:
    job = started(jobs, tmp_path, mode="interpreted", breakpoints=[0.5])
    waiting = time.monotonic() + 60.0
    while not paused(reported) and time.monotonic() < waiting:
        time.sleep(0.02)
    first, *rest = samples(reported)
    assert [plot["title"] for plot in first["plots"]] == ["Path", "wave.rate"] and first["plots"][0]["xy"]
    assert rest[-1]["t"][-1] == pytest.approx(0.5) and not job.over.is_set()
    jobs.order(job.key, order)
    assert job.over.wait(60.0)
    assert job.state == "done" and job.result["outcome"]["ok"], job.error
    assert job.result["t"][-1] == pytest.approx(end)
    # Messages meanwhile agree with the result.
    assert [t for part in samples(reported) for t in part["t"]] == job.result["t"]
    curves = {curve["name"]: curve for plot in job.result["plots"] for curve in plot["curves"]}
    names = list(dict.fromkeys(curve["name"] for plot in first["plots"] for curve in plot["curves"]))
    for i, name in enumerate(names):
        assert [x for part in samples(reported)[1:] for x in part["values"][i]] == curves[name]["values"]
    assert curves["wave.rate"]["unit"] == "rad/s"


@pytest.mark.slow
def test_a_real_time_run_pauses_and_stops_on_request(jobs: Jobs, reported: Told, tmp_path: Path) -> None:
    job = started(jobs, tmp_path, TEXT.replace("t_end: 1", "t_end: 60"), realtime=1.0)

    def wait_until(holds: Callable[[], bool]) -> None:
        end = time.monotonic() + 60.0
        while not holds():
            assert time.monotonic() < end and not job.over.is_set(), job.error
            time.sleep(0.02)

    wait_until(lambda: any(part["t"] for part in samples(reported)))
    jobs.order(job.key, "pause")
    wait_until(lambda: paused(reported))
    before = samples(reported)[-1]["t"][-1]
    time.sleep(0.3)
    assert samples(reported)[-1]["t"][-1] == before  # Time stands still.
    jobs.order(job.key, "resume")
    wait_until(lambda: samples(reported)[-1]["t"][-1] > before)
    # Not made up for: the motion goes on from where it stood.
    assert samples(reported)[-1]["t"][-1] < before + 20.0
    jobs.order(job.key, "stop")
    assert job.over.wait(30.0) and job.state == "done"
    assert job.result["outcome"]["reason"] == "stopped where you said"
    assert before < job.result["t"][-1] < 60.0


def test_failed_runs_report_four_parts_and_invalid_orders_are_refused(jobs: Jobs, tmp_path: Path) -> None:
    job = started(jobs, tmp_path, TEXT.replace("u2: wave.rate", "u2: wave.fish"))
    assert job.over.wait(60.0)
    assert job.state == "failed" and job.error is not None
    assert "no output 'fish'" in job.error["object"] and all(job.error.values())
    job = started(jobs, tmp_path)
    with pytest.raises(EditError, match="no such order"):
        jobs.order(job.key, "explode\nresume")
    with pytest.raises(EditError, match="no job"):
        jobs.order("77", "pause")
