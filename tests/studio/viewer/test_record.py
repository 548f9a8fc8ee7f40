"""Recordings: what is in the files, and what is refused."""

from __future__ import annotations

import importlib.util
import re
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import SymofrosError
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.render.camera import Camera, scale_bar
from symofros.studio.viewer.replays.replay import replay_page
from tests.late import require
from tests.studio.viewer.replays.unpacking import messages_of

SYSTEM = MODELS["planar_robot"]
NQ = 10


def swing(seconds: float) -> tuple[np.ndarray, np.ndarray]:
    t = np.linspace(0.0, seconds, 5)
    q = np.zeros((5, NQ))
    q[:, 0], q[:, 4] = np.sin(t), 0.02 * np.sin(5 * t)
    return t, q


def test_a_gif_moves_at_the_speed_that_was_asked_for(tmp_path: Path) -> None:
    images = import_module("PIL.Image")
    file = sf.record(SYSTEM, swing(1.0), tmp_path / "m.gif", rate=10, speed=2.0, size=(160, 120))
    with images.open(file) as gif:
        assert gif.size == (160, 120) and gif.n_frames == 6 and gif.info["duration"] == 100
        assert gif.info["loop"] == 0  # For ever.
        first = np.asarray(gif.convert("RGB")).astype(int)
        gif.seek(5)
        assert (np.abs(np.asarray(gif.convert("RGB")) - first).max(axis=2) > 40).sum() > 50
    with images.open(sf.record(SYSTEM, swing(0.1), tmp_path / "n.gif", size=(64, 48))) as gif:
        assert gif.info["duration"] == 30 and gif.n_frames == 5  # Whole hundredths: 0.1 s by 0.03 s, and the first.


@pytest.mark.slow
def test_a_film_is_as_long_as_the_motion(tmp_path: Path) -> None:
    ffmpeg = require("imageio_ffmpeg", "video")
    file = sf.record(SYSTEM, swing(1.0), tmp_path / "m.mp4", rate=20, size=(160, 120))
    frames, seconds = ffmpeg.count_frames_and_secs(str(file))
    assert frames == 21 and seconds == pytest.approx(21 / 20, abs=0.03)


def test_a_page_holds_all_states_and_asks_for_nothing_else(tmp_path: Path) -> None:
    file = sf.record(SYSTEM, swing(0.5), tmp_path / "m.html", rate=10)
    page = file.read_text()
    messages = messages_of(page)
    kinds = [message["type"] for _, message in messages]
    assert kinds.count("SkinnedMeshMessage") == 2  # Its beams.
    times = {time for time, message in messages if message["type"] == "SetPositionMessage"}
    assert times == {0.0, 0.1, 0.2, 0.3, 0.4, 0.5}
    assert not re.findall(r'<(?:script|link)[^>]+(?:src|href)="https?:', page)


@pytest.mark.parametrize(
    ("name", "more", "expected"),
    [
        ("m.avi", {}, r"can't write 'm.avi'\n  found:  .avi\n  rule:   one of .html, .mp4, .gif, .png"),
        ("m.gif", {"speed": 0.0}, r"no such speed\n  found:  0.0\n  rule:   speed is a finite number above 0"),
        ("m.gif", {"rate": float("nan")}, "rate is not a number"),
        ("m.gif", {"exaggeration": float("inf")}, "exaggeration is a finite number\n"),
        ("m.mp4", {"size": (161, 120)}, r"no such size\n  found:  \(161, 120\)\n  rule:   even numbers"),
        ("m.mp4", {"size": (64, 48)}, r"MP4 needs ffmpeg\n(.*\n)*  remedy: pip install 'symofros\[video\]'"),
        ("m.gif", {"speed": 1e-6}, r"too long\n  found:  \d+ pictures\n  rule:   20000 at most"),
    ],
)
def test_invalid_recording_options_are_refused(
    name: str, more: dict, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(SymofrosError, match=expected):
        sf.record(SYSTEM, swing(1.0), tmp_path / name, **more)
    assert not list(tmp_path.iterdir())


def test_time_and_exaggeration_are_written_on_pictures(tmp_path: Path) -> None:
    images = import_module("PIL.Image")
    how = {"size": (320, 240), "exaggeration": 20.0}
    pictures = []
    for caption in (False, True):
        with images.open(sf.record(SYSTEM, swing(1.0), tmp_path / f"{caption}.png", caption=caption, **how)) as image:
            pictures.append(np.asarray(image.convert("RGB")).astype(int))
    rows, columns = np.nonzero(np.abs(pictures[1] - pictures[0]).max(axis=2) > 60)
    assert rows.size > 100 and rows.min() > 200 and columns[columns < 240].size > 50  # A line at the foot.
    # The camera sees 1.4 times the mechanism's size: its scale bar is as long as what it says, to a pixel.
    bar = scale_bar(1.4 * Mechanism(SYSTEM).drawing().size)
    drawn = columns[(columns > 240) & (rows == rows[columns > 240].max())]
    assert np.ptp(drawn) == pytest.approx(bar.share * 240, abs=1.5)


def test_names_cannot_end_the_script_of_a_replay() -> None:
    evil = "</script><script>alert(1)</script>"
    camera = Camera(np.array([0.0, -2.0, 1.0]), np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.7)
    page = f"<head><title>Viser</title>{'{darkMode:false}'}</head>"
    made = replay_page(page, evil, camera, np.zeros(1), 0.1, "", np.zeros((1, 1)), [evil], [evil])
    assert (
        evil not in made and made.count("</script>") == 3 and "prefers-color-scheme" in made.rpartition("</script>")[2]
    )


def test_a_page_that_simulates_needs_a_trajectory_a_page_and_zig(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(SymofrosError, match="simulate is for .html"):
        sf.record(SYSTEM, swing(1.0), tmp_path / "m.gif", simulate=True)
    with pytest.raises(SymofrosError, match="a motion of tuple"):
        sf.record(SYSTEM, swing(1.0), tmp_path / "m.html", simulate=True)
    model = sf.compile(SYSTEM)
    run = sf.simulate(model, model.neutral(), np.zeros(model.nv), 0.01, method="rk4", dt=1e-3)
    with pytest.raises(SymofrosError, match="any of method, dt"):
        sf.record(SYSTEM, run, tmp_path / "m.html", simulate={"step": 1e-3})
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    ends = replace(SYSTEM, events={"late": sf.Event("t - 1", terminal=True)})  # The page goes on there.
    for system in (SYSTEM, ends):
        with pytest.raises(sf.CompileError, match=r"pip install 'symofros\[zig\]'"):
            sf.record(system, run, tmp_path / "m.html", simulate=True)
    assert not list(tmp_path.iterdir())
