"""Signals of a motion that are plotted beside it."""

from __future__ import annotations

import base64
import html
import json
import re
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import ShapeError
from symofros.studio.viewer.page.plots import plot_html
from symofros.studio.viewer.playing.motion import motion_of
from symofros.studio.viewer.playing.signals import Signal, signals_of

SYSTEM = MODELS["four_bar"]


@pytest.fixture(scope="module")
def run() -> sf.Trajectory:
    model = sf.compile(SYSTEM)
    q = sf.assemble(model, model.neutral()).q
    return sf.simulate(model, q, np.zeros(model.nv), 0.2, method="rk4", dt=1e-3)


def test_there_are_coordinates_inputs_energies_and_what_is_stated(run: sf.Trajectory) -> None:
    motion = motion_of(run.model, run)
    units = dict.fromkeys(run.model.names.q, "rad")
    more = {"tip": np.stack([run.t, 2 * run.t], axis=1), "one": run.t**2}
    found = {signal.name: signal for signal in signals_of(motion, units, run, more)}
    np.testing.assert_array_equal(found["coordinates [rad]"].values, run.q)
    assert found["coordinates [rad]"].curves == run.model.names.q
    np.testing.assert_array_equal(found["energies [J]"].values[:, 2], run.energy)
    np.testing.assert_array_equal(found["energies [J]"].values[:, 0], run.kinetic_energy)
    assert found["tip"].curves == ("tip[0]", "tip[1]") and found["one"].curves == ("one",)
    for i, name in enumerate(run.model.names.q):
        np.testing.assert_array_equal(found[f"{name} [rad]"].values[:, 0], run.q[:, i])
    assert ("inputs" in found) == (run.model.nu > 0)
    assert "energies [J]" not in {signal.name for signal in signals_of(motion, units, None, None)}


@pytest.mark.parametrize(
    ("values", "found"),
    [
        (np.zeros(3), r"shape \(3,\)"),
        (np.zeros((201, 2, 2)), r"shape \(201, 2, 2\)"),
        (np.full(201, np.nan), "not finite"),
    ],
)
def test_signals_that_do_not_fit_are_refused(
    run: sf.Trajectory, values: np.ndarray, found: str, tmp_path: Path
) -> None:
    with pytest.raises(ShapeError, match=rf"signal 'it' does not fit the motion\n  found:  .*{found}"):
        sf.record(SYSTEM, run, tmp_path / "m.html", signals={"it": values})


def test_a_view_plots_few_points_of_a_long_signal() -> None:
    t = np.linspace(0.0, 1.0, 5001)
    made = plot_html(Signal("a <b> 'c'", ('x"y',), t, np.sin(3 * t)[:, None]))
    data = json.loads(html.unescape(re.findall(r'data-plot="([^"]*)"', made)[0]))
    assert "<b>" not in made and data["name"] == "a <b> 'c'" and data["curves"][0]["name"] == 'x"y'
    assert len(data["t"]) == 500 and data["t"][-1] == 1.0
    np.testing.assert_allclose(data["curves"][0]["values"], np.sin(3 * np.array(data["t"])), atol=1e-5)


def test_a_replay_has_signals_at_its_pictures(run: sf.Trajectory, tmp_path: Path) -> None:
    page = sf.record(SYSTEM, run, tmp_path / "m.html", rate=100, signals={"twice": 2 * run.t}).read_text()
    given = json.loads(re.findall(r"const given = (\{.*\});", page)[0])
    signals = {signal["name"]: signal for signal in given["signals"]}
    assert signals["coordinates [rad]"]["of"] == list(range(run.model.nq))
    values = np.frombuffer(base64.b64decode(signals["twice"]["values"]), "<f4")
    np.testing.assert_allclose(values, 2 * np.array(given["t"]), atol=1e-6)
    energies = np.frombuffer(base64.b64decode(signals["energies [J]"]["values"]), "<f4").reshape(3, -1)
    np.testing.assert_allclose(energies[2], np.interp(given["t"], run.t, run.energy), rtol=1e-5, atol=1e-6)
