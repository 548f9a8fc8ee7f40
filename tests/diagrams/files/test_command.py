"""`symofros simulate` and `symofros info` of a diagram."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app
from tests.diagrams.files.cases import TEXT, folder_with


def run(*arguments: object):
    return CliRunner().invoke(app, list(map(str, arguments)))


def test_simulate_reports_the_outcome_and_writes_the_run(tmp_path: Path) -> None:
    file, table, picture = folder_with(tmp_path), tmp_path / "r.csv", tmp_path / "r.png"
    found = run("simulate", file, "-o", table, "--plot", picture, "--json", "--signals", "plant.q,pd.effort[1]")
    assert found.exit_code == 0, found.output
    said = json.loads(found.stdout)
    assert said["ok"] and said["outcome"]["t"] == 0.2 and said["files"] == [str(table), str(picture)]
    rows = list(csv.reader(table.open()))
    assert rows[0] == ["t [s]", "plant.q[0] [rad]", "plant.q[1] [rad]", "pd.effort[1] [N m]"] and len(rows) == 22
    assert picture.stat().st_size > 10_000


def test_written_files_contain_the_run(tmp_path: Path) -> None:
    run_ = sf.Simulation(sf.load_diagram(folder_with(tmp_path))).run()
    run_.save(tmp_path / "r.npz")
    arrays = np.load(tmp_path / "r.npz")
    assert np.array_equal(arrays["plant.q"], run_["plant.q"])
    assert dict(zip(arrays["names"], arrays["units"], strict=True))["plant.v"] == "rad/s"
    run_.save(tmp_path / "r.parquet", "plant.q")
    columns = parquet.read_table(tmp_path / "r.parquet")
    assert columns.column_names == ["t", "plant.q[0]", "plant.q[1]"]
    assert columns.schema.field("plant.q[0]").metadata == {b"unit": b"rad"}
    assert np.array_equal(columns["plant.q[1]"].to_numpy(), run_["plant.q"][:, 1])
    with pytest.raises(sf.SymofrosError, match="can't save as 'r.xlsx'"):
        run_.save(tmp_path / "r.xlsx")


def test_parameters_are_set_on_the_command_line(tmp_path: Path) -> None:
    file = folder_with(tmp_path)
    ends = []
    for values in ("40,20", "[0,0]", "0"):
        found = run(
            "simulate", file, "--set", f"pd.kp={values}", "--set", "pd.kd=0", "-o", tmp_path / "r.npz", "--json"
        )
        assert found.exit_code == 0, found.output
        ends.append(np.load(tmp_path / "r.npz")["pd.effort"][-1])
    assert np.all(ends[1] == 0.0) and np.all(ends[2] == 0.0)


def test_real_time_runs_keep_the_stated_speed_and_report_jitter(tmp_path: Path) -> None:
    found = run("simulate", folder_with(tmp_path), "--speed", "2", "--jitter", tmp_path / "j.png", "--json")
    said = json.loads(found.stdout)
    jitter = said["jitter"]
    assert (
        said["statistics"]["seconds"] >= 0.0999 and jitter["instants"] == 21 and jitter["spacing"] == 0.005
    )  # On the clock.
    assert 0.0 <= jitter["minimum"] <= jitter["median"] <= jitter["p999"] <= jitter["maximum"]
    assert (tmp_path / "j.png").stat().st_size > 10_000


def test_info_lists_the_contents_of_a_diagram(tmp_path: Path) -> None:
    file = folder_with(tmp_path)
    found = run("info", file, "--json")
    assert found.exit_code == 0, found.output
    said = json.loads(found.stdout)
    assert said["blocks"]["pd"]["inputs"]["v_desired"] == "0.0" and said["blocks"]["pd"]["period"] == 0.01
    assert said["order"].index("plant.q") < said["order"].index("pd.effort") and said["models"]["arm"]["nv"] == 2
    assert said["parameters"]["pd.kp[0]"] == 40.0 and said["parameters"]["arm.m2"] == 0.9
    for_people = run("info", file)
    assert for_people.exit_code == 0 and "order: plant -> pd" in for_people.output
    file.write_text(TEXT.replace("q: plant.q\n", "q: plant.z\n", 1))
    spoilt = run("info", file)
    assert spoilt.exit_code == 2 and "diagram.yaml:24" in spoilt.output


def test_inlets_are_given_by_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "part.yaml"
    path.write_text(
        "symofros_diagram: 1\nblocks:\n  pd: {kind: joint_pd, kp: 2, kd: 1, period: 0.01}\n"
        "inlets: {q: {to: pd.q, shape: [2]}, v: [pd.v], goal: [pd.q_desired]}\n"
    )
    common = "simulate", path, "0.1", "-o", tmp_path / "run.npz"
    given = "--input", "q=atan2(t,1),0.5", "--input", "v=0", "--input", "goal=1"
    result = run(*common, *given)
    assert result.exit_code == 0, result.output
    with np.load(tmp_path / "run.npz") as arrays:
        np.testing.assert_allclose(arrays["pd.effort"][-1], [2 * (1 - np.arctan(0.1)), 1.0], rtol=1e-12)
    result = run(*common, *given[:4])
    assert result.exit_code == 2 and "inlet 'goal' is not given" in " ".join(result.output.split())
