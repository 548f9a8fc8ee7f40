"""A run is not lost at its end: not by Ctrl-C while it is examined, nor by a disk that is full when it is written."""

from __future__ import annotations

import errno
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest
from click.testing import Result
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app
from symofros.simulation.results import saving

ROOT = Path(__file__).parents[3]
# File, and what looks at the steps of its runs.
RUNS = {
    "model": ("rigid/cart_pole.yaml", "symofros.simulation.results.examination.diagnosis.examine_run"),
    "diagram": ("square.yaml", "symofros.diagrams.run.examination.diagnosis.examine_steps"),
}


@pytest.fixture(autouse=True)
def _ctrl_c_is_heard() -> Iterator[None]:
    """A process that was started in the background ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def _simulated(kind: str, output: Path) -> Result:
    file = ROOT / "reference_models" / RUNS[kind][0]
    return CliRunner().invoke(app, ["simulate", str(file), "0.1", "-o", str(output)])


def _ctrl_c(*_: Any, **__: Any) -> NoReturn:
    os.kill(os.getpid(), signal.SIGINT)
    raise AssertionError("Ctrl-C is no exception here")


@pytest.mark.parametrize("kind", RUNS)
def test_ctrl_c_while_a_run_is_examined_keeps_the_run(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(RUNS[kind][1], _ctrl_c)
    ended = _simulated(kind, tmp_path / "run.npz")
    assert ended.exit_code == 130
    assert "while it was examined; all of the run is kept" in " ".join(ended.output.split())
    assert np.load(tmp_path / "run.npz")["t"][-1] == pytest.approx(0.1)


def test_ctrl_c_while_a_run_with_events_is_examined_as_a_whole_keeps_it(monkeypatch: pytest.MonkeyPatch) -> None:
    model = sf.compile(sf.load(ROOT / "reference_models" / RUNS["model"][0]))
    half = sf.Event("t - 0.05", action={"dx": 0.5})
    monkeypatch.setattr("symofros.simulation.simulate.switched_run_note", _ctrl_c)
    run = sf.simulate(model, [0.0, 0.1], [0.0, 0.0], 0.1, events={"half": half})
    assert run.outcome.kind == "interrupted" and not run.outcome.ok and run.t[-1] == pytest.approx(0.1)


@pytest.mark.parametrize("kind", RUNS)
def test_a_disk_that_is_full_when_a_run_is_written_does_not_lose_it(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    full, spare = tmp_path / "full", tmp_path / "spare"
    full.mkdir()
    spare.mkdir()
    monkeypatch.chdir(spare)
    write = saving.write_atomically

    def write_where_there_is_room(path: Path, content: str | bytes) -> None:
        if path.parent == full:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        write(path, content)

    monkeypatch.setattr(saving, "write_atomically", write_where_there_is_room)
    ended = _simulated(kind, full / "run.npz")
    assert ended.exit_code == 2 and "No space left" in ended.output
    (kept,) = spare.iterdir()
    assert str(kept) in ended.output.replace("\n", "")
    assert np.load(kept)["t"][-1] == pytest.approx(0.1)


def test_where_no_folder_has_room_the_fault_is_that_of_the_file(tmp_path: Path) -> None:
    def save(path: Path) -> NoReturn:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    with pytest.raises(OSError, match="run.npz") as caught:
        saving.save_or_keep(save, tmp_path / "run.npz")
    assert caught.value.filename == str(tmp_path / "run.npz")
