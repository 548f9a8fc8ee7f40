"""`symofros view`, and `symofros simulate` with `--view` and `--record-view`, of models and of diagrams."""

from __future__ import annotations

import errno
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import symofros as sf
from symofros.__main__ import app
from symofros.simulation.stepping.time_slice import TimeSlice
from tests.diagrams.files.cases import ARM, TEXT, folder_with

FOUR_BAR = ARM.parents[1] / "closed" / "four_bar.yaml"
SECOND = "  second:\n    kind: forward_dynamics\n    model: arm\n"


def run(*arguments: object, command: str = "simulate") -> Result:
    return CliRunner().invoke(app, [command, *map(str, arguments)])


@pytest.fixture
def seen(monkeypatch: pytest.MonkeyPatch) -> list[sf.Viewer]:
    """The viewers that were waited for; nothing opens a browser."""
    found: list[sf.Viewer] = []
    monkeypatch.setattr(sf.Viewer, "wait", lambda self: found.append(self))
    monkeypatch.setattr("webbrowser.open", lambda url: True)
    return found


def test_simulate_records_the_motion_of_a_model(tmp_path: Path) -> None:
    found = run(ARM, "0.1", "--set", "q1=0.5", "--record-view", tmp_path / "r.gif", "-o", tmp_path / "r.npz")
    said = "".join(found.output.split())  # Long names of folders are folded.
    assert found.exit_code == 0 and f"wrote{tmp_path / 'r.gif'}" in said, found.output
    assert (tmp_path / "r.gif").read_bytes().startswith(b"GIF89a") and (tmp_path / "r.npz").exists()


def test_simulate_records_a_picture_of_a_diagram(tmp_path: Path) -> None:
    found = run(folder_with(tmp_path), "--record-view", tmp_path / "r.png", "--json")
    assert found.exit_code == 0 and str(tmp_path / "r.png") in found.stdout, found.output
    assert (tmp_path / "r.png").read_bytes().startswith(b"\x89PNG")


def test_simulate_plays_the_motion_of_a_model(seen: list[sf.Viewer]) -> None:
    found = run(ARM, "0.1", "--set", "q1=0.5", "--view", "--exaggeration", "2")
    (viewer,) = seen
    assert found.exit_code == 0 and f"it plays at {viewer.url} (Ctrl-C ends)" in found.output, found.output
    assert viewer._player is not None and viewer._player.motion.end == pytest.approx(0.1)
    assert viewer.exaggeration == 2.0 and viewer.is_closed


def test_a_real_time_diagram_is_shown_while_it_runs(seen: list[sf.Viewer], tmp_path: Path) -> None:
    found = run(folder_with(tmp_path), "--view", "--realtime")
    (viewer,) = seen
    assert found.exit_code == 0, found.output
    assert "view3d.shown: 6" in found.output and f"view3d: {viewer.url}" in found.output  # Every 0.04 s of 0.2 s.
    assert viewer._player is not None and viewer._player.motion.end == pytest.approx(0.2)  # Then it is played.


def test_simulate_shows_the_mechanism_of_the_chosen_block(seen: list[sf.Viewer], tmp_path: Path) -> None:
    file = folder_with(tmp_path, TEXT.replace("blocks:\n", "blocks:\n" + SECOND))
    refused = run(file, "--view")
    assert refused.exit_code == 2 and "blocks that move one: second, plant" in refused.output and not seen
    found = run(file, "--view", "--view-block", "second")
    (viewer,) = seen
    q = sf.Simulation(sf.load_diagram(file)).run()["second.q"]
    assert found.exit_code == 0 and viewer._player is not None
    assert np.array_equal(viewer._player.motion.q, q)


@pytest.mark.parametrize("of", ["model", "diagram"])
@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--record-view", "r.avi"], "one of .html, .mp4, .gif, .png"),
        (["--view"], "pip install 'symofros[view]'"),
        (["--interactive"], "--interactive: "),
        (["--interactive", "--record-view", "r.gif"], "--interactive: "),
        (["--record-view", "nowhere/r.png"], "check the path"),
        (["--plot", "nowhere/r.png"], "check the path"),
        (["--plot", "."], "plot: can't write ''"),
        (["--plot", "r.xyz"], "choose .png, .svg or .pdf"),
        (["--plot", "r"], "no suffix"),
        (["--signals", "q9"], "q9"),
        (["-o", "nowhere/r.csv"], "check the path"),
        (["-o", "folder.csv"], "Is a directory"),
        (["-o", "r.txt"], ".npz, .csv or .parquet"),
    ],
)
def test_a_run_that_cannot_be_displayed_is_not_started(
    of: str, arguments: list[str], expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "viser", None)
    file = ARM if of == "model" else folder_with(tmp_path)
    monkeypatch.chdir(tmp_path)
    Path("folder.csv").mkdir()
    for module in ("symofros.commands.motion.sf.simulate", "symofros.diagrams.files.command.run_compiled"):
        monkeypatch.setattr(module, lambda *_, **__: pytest.fail("the run has begun"))
    found = run(file, "0.1", "-o", tmp_path / "r.npz", *arguments)
    assert found.exit_code == 2 and expected in found.output and not (tmp_path / "r.npz").exists()


def test_view_draws_a_picture_or_plays_a_trajectory_of_the_same_model(seen: list[sf.Viewer], tmp_path: Path) -> None:
    assert run(FOUR_BAR, "--record", tmp_path / "bar.png", command="view").exit_code == 0
    assert (tmp_path / "bar.png").read_bytes().startswith(b"\x89PNG")
    motion = sf.simulate(sf.compile(sf.load(ARM)), [1.0, 0.0], None, 0.1, dt=0.01).save(tmp_path / "run.npz")
    shown = "--trajectory", motion, "--port", 0, "--no-browser", "--exaggeration", 3
    found = run(ARM, *shown, command="view")
    (viewer,) = seen
    assert found.exit_code == 0 and viewer.exaggeration == 3.0, found.output
    assert f"double_pendulum is at {viewer.url} (Ctrl-C ends)" in found.output and "127.0.0.1" in viewer.url
    other = run(FOUR_BAR, "--trajectory", motion, "--record", tmp_path / "run.gif", command="view")
    assert other.exit_code == 2 and "coordinates q1, q2" in other.output and "q1, q2, q3" in other.output


@pytest.mark.parametrize("of", ["model", "diagram"])
def test_an_interrupted_run_is_kept_and_ends_as_interrupted(
    of: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By 130, as of shells; runs that end by themselves before their time end by 1."""
    steps = iter([None, KeyboardInterrupt])
    measured = TimeSlice.measure

    def measure(self: TimeSlice, advance: Callable[[int], int], count: int) -> int:
        if next(steps) is not None:
            raise KeyboardInterrupt
        return measured(self, advance, 7)

    monkeypatch.setattr(TimeSlice, "measure", measure)
    file = ARM if of == "model" else folder_with(tmp_path)
    found = run(file, "0.1", "--json", "-o", tmp_path / "r.npz")
    assert found.exit_code == 130 and json.loads(found.output)["outcome"]["kind"] == "interrupted", found.output
    instants = {"model": 8, "diagram": 7}  # Steps from the start; instants, the start among them.
    assert len(np.load(tmp_path / "r.npz")["t"]) == instants[of]


def test_pictures_are_whole_or_absent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that is full as Matplotlib writes left a part of a picture, and named no file."""
    picture = tmp_path / "r.svg"
    picture.write_text("old")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("symofros.base.stored.os.replace", full)
    found = run(ARM, "0.01", "--plot", picture)
    assert found.exit_code == 2 and "r.svg" in found.output and "make room" in found.output
    assert picture.read_text() == "old" and [*tmp_path.iterdir()] == [picture]
