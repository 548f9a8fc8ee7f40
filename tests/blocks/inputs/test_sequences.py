"""Sequences over time, given or read from files, which nobody trusts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Sequence
from symofros.blocks.inputs import sequences
from symofros.diagrams.wiring import surroundings, wire
from tests.blocks.support import run

T = np.array([0.0, 0.05, 0.2])
VALUES = np.array([[1.0, 2.0], [3.0, -2.0], [0.0, 1.0]])


@pytest.fixture
def csv(tmp_path: Path) -> Path:
    path = tmp_path / "moves.csv"
    rows = np.hstack([T[:, None], VALUES])
    path.write_text("t, q1,q2\n" + "\n".join(",".join(map(str, row)) for row in rows) + "\n")
    return path


def lines(t: np.ndarray) -> np.ndarray:
    return np.stack([np.interp(t, T, column) for column in VALUES.T], axis=1)


def test_values_between_samples_are_linear_or_held() -> None:
    found = run(Sequence(name="s", t=T, values=VALUES, units={"y": "N m"}), t_end=0.3)
    np.testing.assert_allclose(found["y"], lines(found["t"]), atol=1e-15)
    held = run(Sequence(name="s", t=T, values=VALUES, kind="hold"), t_end=0.3)
    np.testing.assert_array_equal(held["y"][[0, 4, 5, 19, 20, 30]], VALUES[[0, 0, 1, 1, 2, 2]])


def test_a_trajectory_file_can_have_several_outputs(csv: Path, tmp_path: Path) -> None:
    np.savez(tmp_path / "moves.npz", t=T, q=VALUES, v=2 * VALUES, a=VALUES[:, 0])
    found = run(Sequence(name="s", file=str(tmp_path / "moves.npz"), outputs={"q": "q", "v": "v", "a": "a"}), t_end=0.2)
    np.testing.assert_allclose(found["v"], 2 * lines(found["t"]), atol=1e-15)
    assert found["a"].ndim == 1
    found = run(Sequence(name="s", file=str(csv), outputs={"back": ["q2", "q1"], "one": "q1"}), t_end=0.2)
    np.testing.assert_allclose(found["back"], lines(found["t"])[:, ::-1], atol=1e-15)
    np.testing.assert_allclose(found["one"], lines(found["t"])[:, 0], atol=1e-15)
    np.testing.assert_allclose(run(Sequence(name="s", file=str(csv)), t_end=0.2)["y"], lines(found["t"]), atol=1e-15)


def test_a_saved_run_is_read_as_it_was_written(tmp_path: Path) -> None:
    """Names without units, which outputs have; columns of several units make an output without."""
    diagram = sf.Diagram("first")
    diagram.add(sf.blocks.Sine(name="wave", amplitude=[1.0, 2.0], unit="rad"))
    first = sf.Simulation(diagram).run(1.0, dt=0.1, record=0.1)
    first.save(tmp_path / "run.csv", "wave.y", "wave.rate")
    outputs = {"y": ["wave.y[0]", "wave.y[1]"], "one": "wave.rate[1]", "mixed": ["wave.y[0]", "wave.rate[0]"]}
    diagram.add(Sequence(name="read", file=str(tmp_path / "run.csv"), outputs=outputs))
    again = sf.Simulation(diagram).run(1.0, dt=0.1, record=0.1)
    np.testing.assert_array_equal(again["read.y"], again["wave.y"])
    np.testing.assert_array_equal(again["read.one"], again["wave.rate"][:, 1])
    assert [again.unit(f"read.{name}") for name in outputs] == ["rad", "rad/s", ""]
    read = diagram.blocks["read"]
    stated = replace(read, units={"y": "m", "mixed": "1/s"}).ports(surroundings(wire(diagram), "read"))
    assert [port.unit for port in stated.outputs] == ["m", "rad/s", "1/s"], "stated ones count first"
    # A column that the file's author called so keeps its name.
    (tmp_path / "own.csv").write_text("t,F [N]\n0,1\n1,2\n")
    assert Sequence(name="s", file=str(tmp_path / "own.csv"), outputs={"F": "F [N]"}).samples()["F"].values.shape == (
        2,
    )


@pytest.mark.parametrize(
    ("text", "found", "where"),
    [
        ("t,q\n0,1\n1,two\n", "1,two", "bad.csv:3"),
        ("t,q\n0,1\n1\n", "1", "bad.csv:3"),
        ("t,q\n0,nan\n1,2\n", "nan", ""),
        ("t,q\n1,1\n0,2\n", "[1. 0.]", ""),
        ("t,t\n", "called t", ""),
        ("q\n1\n", "only q", ""),
        ("", "", ""),
    ],
)
def test_faults_in_files_are_reported_with_their_line(tmp_path: Path, text: str, found: str, where: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(sf.DescriptionError) as caught:
        Sequence(name="s", file=str(path))
    problem = caught.value.problems[0]
    assert found in problem.found
    assert problem.where.endswith(where)
    assert problem.remedy


def test_large_and_foreign_files_are_not_read(tmp_path: Path, csv: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(path: Path) -> str:
        with pytest.raises(sf.DescriptionError) as caught:
            Sequence(name="s", file=str(path))
        return str(caught.value)

    assert "No such file" in refused(tmp_path / "none.csv")
    assert "samples are in a file" in refused(tmp_path)
    (tmp_path / "moves.txt").touch()
    assert "names end in .csv or .npz" in refused(tmp_path / "moves.txt")
    # A pickle inside an archive of arrays would run code.
    np.savez(tmp_path / "objects.npz", t=np.array([{}, {}], dtype=object))
    assert "no NPZ file" in refused(tmp_path / "objects.npz")
    (tmp_path / "text.npz").write_text("not an archive")
    assert "no NPZ file" in refused(tmp_path / "text.npz")
    monkeypatch.setattr(sequences, "MAX_NUMBERS", 4)
    np.savez_compressed(tmp_path / "bomb.npz", t=np.zeros(5, dtype=np.int8))
    assert "at most 4 numbers" in refused(tmp_path / "bomb.npz")
    assert "at most 4 numbers" in refused(csv)
    monkeypatch.setattr(sequences, "MAX_BYTES", 10)
    assert "at most 10" in refused(csv)


def test_lines_beyond_the_csv_field_limit_are_reported(tmp_path: Path) -> None:
    (tmp_path / "long.csv").write_text("t,y\n0," + "1" * 200_000 + "\n")
    with pytest.raises(sf.DescriptionError, match="larger than field limit"):
        Sequence(name="s", file=str(tmp_path / "long.csv"))
