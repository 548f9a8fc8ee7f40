"""`symofros view`."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import reference_models
import symofros as sf
from symofros.__main__ import app

MODELS = Path(reference_models.__file__).parent
PENDULUM, FOUR_BAR = MODELS / "rigid" / "double_pendulum.yaml", MODELS / "closed" / "four_bar.yaml"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["view", *map(str, arguments)])


@pytest.fixture(scope="module")
def motion(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("motion")
    return sf.simulate(sf.compile(sf.load(PENDULUM)), [1.0, 0.0], None, 0.1, dt=0.01).save(folder / "run.npz")


@pytest.mark.slow
def test_it_records(motion: Path, tmp_path: Path) -> None:
    found = run(PENDULUM, "--trajectory", motion, "--record", tmp_path / "run.gif")
    assert found.exit_code == 0 and f"wrote{tmp_path / 'run.gif'}" in "".join(found.output.split())
    assert (tmp_path / "run.gif").read_bytes().startswith(b"GIF89a")


def test_it_takes_a_picture_of_what_does_not_move(tmp_path: Path) -> None:
    assert run(FOUR_BAR, "--record", tmp_path / "bar.png").exit_code == 0
    assert (tmp_path / "bar.png").read_bytes().startswith(b"\x89PNG")


def test_it_serves_until_it_is_interrupted(motion: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[tuple[str, float]] = []
    monkeypatch.setattr(sf.Viewer, "wait", lambda self: shown.append((self.url, self.exaggeration)))
    found = run(PENDULUM, "--trajectory", motion, "--port", 0, "--no-browser", "--exaggeration", 3)
    ((url, exaggeration),) = shown
    assert found.exit_code == 0 and exaggeration == 3.0
    assert f"double_pendulum is at {url} (Ctrl-C ends)" in found.output and "127.0.0.1" in url


def test_a_motion_of_another_model_is_refused(motion: Path, tmp_path: Path) -> None:
    found = run(FOUR_BAR, "--trajectory", motion, "--record", tmp_path / "run.gif")
    assert found.exit_code == 2 and "coordinates q1, q2" in found.output and "q1, q2, q3" in found.output
