"""symofros-truth: the files are what the truth gives, and readers that know nothing of us read them."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pyarrow.parquet
import pytest
from mpmath import mp
from typer.testing import CliRunner

import symofros as sf
from validation.__main__ import app
from validation.truth_data.catalogue import FUNCTIONS, models
from validation.truth_data.command import FOLDER, changes
from validation.truth_data.dataset import write

MODELS = {model.name: model for model in models()}


def stored(name: str) -> Any:
    return json.loads((FOLDER / name).read_text())


def numbers(value: dict[str, Any]) -> np.ndarray:
    return np.array([float(text) for text in value["digits"]]).reshape(value["shape"])


@pytest.mark.parametrize("name", ["two_hinges", *(pytest.param(n, marks=pytest.mark.slow(1)) for n in [*MODELS][1:])])
def test_the_truth_files_are_current(name: str, tmp_path: Path) -> None:
    write(tmp_path, [MODELS[name]])
    assert changes(FOLDER, tmp_path) == []


def test_the_manifest_states_every_file(tmp_path: Path) -> None:
    manifest = stored("manifest.json")
    assert set(manifest["models"]) == set(MODELS) and set(manifest["functions"]) == set(FUNCTIONS)
    for name, stated in manifest["files"].items():
        content = (FOLDER / name).read_bytes()
        assert (len(content), hashlib.sha256(content).hexdigest()) == (stated["bytes"], stated["sha256"]), name
    listed = {*manifest["files"], "manifest.json"}
    there = {str(path.relative_to(FOLDER)) for path in FOLDER.rglob("*") if path.is_file()}
    assert {name for name in there - listed if "readers" not in name and name != "README.md"} == set()


def test_the_files_keep_the_schema() -> None:
    schema = stored("schema.json")
    for path in [*FOLDER.glob("models/*.json"), *FOLDER.glob("values/*.json")]:
        jsonschema.validate(json.loads(path.read_text()), schema)
    broken = stored("values/two_hinges.json")
    broken["states"][0]["values"]["bias"]["digits"][0] = "1.0"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(broken, schema)


def test_values_carry_thirty_digits() -> None:
    """M M^-1 = 1 in fractions of the texts, to as many digits as cond(M) leaves."""
    for state in stored("values/two_hinges.json")["states"]:
        M, inverse = (fractions(state["values"][name]) for name in ("mass_matrix", "mass_matrix_inverse"))
        unit = [[sum(M[i][k] * inverse[k][j] for k in range(2)) for j in range(2)] for i in range(2)]
        assert all(abs(unit[i][j] - (i == j)) < Fraction("1e-27") for i in range(2) for j in range(2))


def fractions(value: dict[str, Any]) -> list[list[Fraction]]:
    rows, columns = value["shape"]
    return [[Fraction(value["digits"][i * columns + j]) for j in range(columns)] for i in range(rows)]


@pytest.mark.parametrize("name", MODELS)
def test_our_readers_of_each_format_give_the_same_equations(name: str) -> None:
    values = stored(f"values/{name}.json")
    for path in FOLDER.glob(f"models/{name}.*"):
        if path.suffix == ".json":
            continue
        system = sf.load(path, floating_base=name == "floating" and path.suffix == ".urdf")
        model = sf.compile(system, sf.Options(backend="interpreter"))
        for state in values["states"]:
            q, v, a = (np.array(state[key]) for key in ("q", "v", "a"))
            M = numbers(state["values"]["mass_matrix"])
            forces = numbers(state["values"]["inverse_dynamics"])
            assert np.allclose(model.mass_matrix(q), M, rtol=0, atol=1e-13 * np.abs(M).max()), path.name
            ours = model.inverse_dynamics(q, v, a)
            assert np.allclose(ours, forces, rtol=0, atol=1e-12 * np.abs(forces).max()), path.name


class InSixtyDigits:
    """A model of the data worked out anew by mpmath, from what manifest.json says: nothing of ours has a part in it."""

    def __init__(self, name: str, q: list[float]) -> None:
        data = stored(f"models/{name}.json")
        self.links, self.nv, self.gravity = data["links"], data["nv"], mp.matrix(data["gravity"])
        self.poses: list[tuple[Any, Any]] = []  # R and p in the world.
        self.axes: list[list[tuple[int, str, Any, Any]]] = []  # Of the joints before: speed, kind, axis, origin.
        for link in self.links:
            joint, parent = link["joint"], link["parent"]
            R0, p0 = self.poses[parent] if parent >= 0 else (mp.eye(3), mp.zeros(3, 1))
            U, _, V = mp.svd_r(mp.matrix(joint["R"]))
            R, p, axes = R0 * U * V, p0 + R0 * mp.matrix(joint["p"]), [*(self.axes[parent] if parent >= 0 else [])]
            if joint["kind"] != "fixed":
                u, angle = mp.matrix(joint["axis"]), mp.mpf(q[joint["q"][0]])
                u /= mp.norm(u)
                axes.append((joint["v"][0], joint["kind"], R * u, p))
                if joint["kind"] == "revolute":
                    K = mp.matrix([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
                    R = R * (mp.eye(3) + mp.sin(angle) * K + (1 - mp.cos(angle)) * K * K)
                else:
                    p = p + R * u * angle
            self.poses.append((R, p))
            self.axes.append(axes)

    def values(self) -> dict[str, list[Any]]:
        """Values of some functions, row by row."""
        M, g, V = mp.zeros(self.nv), mp.zeros(self.nv, 1), mp.mpf(0)
        for link, (R, p), axes in zip(self.links, self.poses, self.axes, strict=True):
            m, c, inertia = mp.mpf(link["mass"]), p + R * mp.matrix(link["com"]), R * mp.matrix(link["inertia"]) * R.T
            J, W = mp.zeros(3, self.nv), mp.zeros(3, self.nv)
            for k, kind, u, at in axes:
                r = c - at
                turning = (u[1] * r[2] - u[2] * r[1], u[2] * r[0] - u[0] * r[2], u[0] * r[1] - u[1] * r[0])
                for i in range(3):
                    J[i, k] = turning[i] if kind == "revolute" else u[i]
                    W[i, k] = u[i] if kind == "revolute" else 0
            M += m * J.T * J + W.T * inertia * W
            g -= m * J.T * self.gravity
            V -= m * (self.gravity.T * c)[0]
        flat = [x for R, p in self.poses for x in [*p, *R]]
        return {"mass_matrix": [*M], "gravity": [*g], "potential_energy": [V], "link_poses": flat}


@pytest.mark.parametrize("name", ["two_hinges", "slides_and_hinges", "arm", "tree", "fixed_amid"])
def test_sixty_digits_of_another_reader_agree_to_thirty(name: str) -> None:
    with mp.workdps(60):
        for state in stored(f"values/{name}.json")["states"]:
            for function, found in InSixtyDigits(name, state["q"]).values().items():
                expected = [mp.mpf(text) for text in state["values"][function]["digits"]]
                scale = max(abs(x) for x in expected)
                assert max(abs(x - y) for x, y in zip(found, expected, strict=True)) < scale * mp.mpf("1e-28"), function


def test_the_table_and_the_texts_agree() -> None:
    rows = pyarrow.parquet.read_table(FOLDER / "values.parquet").to_pylist()
    by_key = {(row["model"], row["state"], row["function"]): row for row in rows}
    for name in MODELS:
        for index, state in enumerate(stored(f"values/{name}.json")["states"]):
            for function, value in state["values"].items():
                row = by_key.pop((name, index, function))
                assert (row["shape"], row["digits"], row["q"]) == (value["shape"], value["digits"], state["q"])
                assert row["value"] == [float(text) for text in value["digits"]]
    assert by_key == {}


def lines(output: str) -> list[list[str]]:
    return [line.split() for line in output.splitlines()]


@pytest.fixture(scope="module")
def read_by_python() -> list[list[str]]:
    command = [sys.executable, "-I", str(FOLDER / "readers/read.py"), str(FOLDER)]
    return lines(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def test_the_python_reader_needs_no_package(read_by_python: list[list[str]]) -> None:
    model, state, function, shape, *values = read_by_python[0]
    expected = stored(f"values/{model}.json")["states"][int(state)]["values"][function]
    assert shape == "x".join(map(str, expected["shape"])) and [*map(float, values)] == [*map(float, expected["digits"])]
    assert len(read_by_python) == len(MODELS) * 3 * len(FUNCTIONS)


def test_the_check_option_lists_changes(tmp_path: Path) -> None:
    shutil.copytree(FOLDER, tmp_path / "truth")
    arguments = ["truth", "--check", "--model", "two_hinges", "--output", str(tmp_path / "truth")]
    assert CliRunner().invoke(app, arguments).exit_code == 0
    (tmp_path / "truth/models/two_hinges.urdf").write_text("<robot/>")
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 1 and "would change: models/two_hinges.urdf" in result.output


@pytest.mark.slow
@pytest.mark.parametrize("core", ["Nehalem", "Haswell"])
def test_every_processor_writes_the_same_files(core: str) -> None:
    """Kernels of OpenBLAS sum in orders of their own: nothing that is written may rest on them."""
    one = f"{Path(__file__)}::test_the_truth_files_are_current"
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "--slow", f"{one}[heavy_on_light]", f"{one}[balls]"]
    done = subprocess.run(command, env=os.environ | {"OPENBLAS_CORETYPE": core}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:]
