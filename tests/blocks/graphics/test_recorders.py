"""What is kept and drawn of a run."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import ExtremityPlot, ForwardDynamics, Scope, StatePlot, Store
from symofros.diagrams.block import Block
from symofros.diagrams.run.plots import plots_of
from symofros.diagrams.settings import Plot, RunSettings
from tests.diagrams.files.cases import ARM
from tests.diagrams.parts import ramp


def arm(*blocks: tuple[Block, dict[str, str]]) -> sf.Simulation:
    d = sf.Diagram("arm")
    d.add_model("arm", sf.load(ARM), {"q1": 0.4})
    d.add(ForwardDynamics(name="plant", model="arm"))
    d.add(ramp())
    for block, inputs in blocks:
        d.add(block, **inputs)
    return sf.Simulation(d)


def test_a_store_records_at_its_own_samples() -> None:
    store = Store(name="log", signals=("time", "q"), period=0.004, offset=0.001)
    simulation = arm((store, {"time": "ramp.y", "q": "plant.q"}))
    coarse = simulation.run(0.1, dt=1e-3, record=0.05)
    kept = coarse.kept["log"]
    assert np.allclose(kept["t"], 0.001 + 0.004 * np.arange(25), atol=1e-12) and len(coarse.t) == 3
    assert np.array_equal(kept["time"], np.stack([kept["t"], 2.0 * kept["t"]], axis=1)) and kept["q"].shape == (25, 2)
    fine = simulation.run(0.1, dt=1e-3, record=1e-3)
    # Recording does not move the samples; steps that end elsewhere round otherwise.
    assert np.allclose(kept["q"], fine["plant.q"][1::4], rtol=0, atol=1e-14)
    interpreted = simulation.interpret(0.1, dt=1e-3, record=0.05)
    assert np.allclose(interpreted.kept["log"]["q"], kept["q"], rtol=0, atol=1e-14)


def test_a_store_is_bounded_and_saved_beside_the_run(tmp_path: Path) -> None:
    run = arm((Store(name="log", signals=("q",), period=0.001, most=5), {"q": "plant.q"})).run(0.02, dt=1e-3)
    assert run.kept["log"]["t"].tolist() == pytest.approx([0.016, 0.017, 0.018, 0.019, 0.02])
    files = run.save(tmp_path / "r.csv", "plant.v")
    assert [file.name for file in files] == ["r.csv", "r.log.csv"]
    assert next(csv.reader(files[1].open())) == ["t", "q[0]", "q[1]"]
    run.save(tmp_path / "r.npz", "plant.v")
    assert np.load(tmp_path / "r.npz")["log.q"].shape == (5, 2)


def test_recorders_draw_their_signals() -> None:
    simulation = arm(
        (Scope(name="both", signals=("q", "time"), title="Two"), {"q": "plant.q", "time": "ramp.y"}),
        (StatePlot(name="states", model="arm"), {"q": "plant.q", "v": "plant.v"}),
        (ExtremityPlot(name="ends", model="arm", frames=("elbow", "tip")), {"q": "plant.q"}),
    )
    found = [(plot.title, plot.signals) for plot in plots_of(simulation.resolved.wired)]
    assert found == [
        ("Two", ("plant.q", "ramp.y")),
        ("states: coordinates", ("plant.q",)),
        ("states: speeds", ("plant.v",)),
        ("ends: elbow", ("ends.p_elbow",)),
        ("ends: tip", ("ends.p_tip",)),
    ]
    run = simulation.run(0.05, dt=1e-3)
    model = sf.compile(sf.load(ARM))
    assert np.allclose(run["ends.p_tip"], model.frame_pose("tip", run["plant.q"])[0], rtol=0, atol=1e-15)
    figure = run.plot()
    assert [axis.get_title(loc="left") for axis in figure.axes] == [title for title, _ in found]
    assert [line.get_label() for line in figure.axes[0].lines] == ["plant.q[0]", "plant.q[1]", "ramp.y[0]", "ramp.y[1]"]
    assert figure.axes[0].get_ylabel() == "[rad], [s]" and figure.axes[3].get_ylabel() == "[m]"
    drawn = figure.axes[1].lines[1]
    assert np.array_equal(drawn.get_ydata(), run["plant.q"][:, 1]) and np.array_equal(drawn.get_xdata(), run.t)


def test_plots_of_the_diagram_come_first_and_single_signals_by_name() -> None:
    simulation = arm((Scope(name="s", signals=("q",)), {"q": "plant.q"}))
    simulation.diagram.simulation = RunSettings(plots=(Plot("One", ("plant.v[1]",)),))
    run = sf.Simulation(simulation.diagram).run(0.01, dt=1e-3)
    assert [axis.get_title(loc="left") for axis in run.plot().axes] == ["One", "s"]
    assert [axis.get_title(loc="left") for axis in run.plot("plant.a", "ramp.y[0]").axes] == ["plant.a", "ramp.y[0]"]
    with pytest.raises(sf.DescriptionError, match="no such entry"):
        run.plot("plant.a[9]")


def test_a_diagram_without_plots_is_reported() -> None:
    with pytest.raises(sf.SymofrosError, match="there is nothing to draw"):
        sf.Simulation(sf.Diagram("empty")).run(0.01, dt=1e-3).plot()


@pytest.mark.parametrize(
    ("block", "words"),
    [
        (Scope(name="b", signals=("a b",)), "no inputs can be named so"),
        (Scope(name="b", signals=("a",)), "input 'b.a' is not connected"),
        (Store(name="b", signals=("t",), period=0.1), "can't store that"),
        (StatePlot(name="b", model="leg"), "no model 'leg'"),
        (ExtremityPlot(name="b", model="arm", frames=("tipp",)), "did you mean 'tip'"),
    ],
)
def test_invalid_fields_of_recorders_are_refused(block: Block, words: str) -> None:
    with pytest.raises(sf.DescriptionError, match=words):
        arm((block, {}))
