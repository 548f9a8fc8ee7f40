"""Diagram files out: what is read back is the same diagram."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import ForwardDynamics, JointPD
from symofros.diagrams.block import Block
from symofros.diagrams.settings import Plot, RunSettings
from tests.diagrams.files.cases import ARM, RESISTED, folder_with


def control() -> sf.Diagram:
    part = sf.Diagram("control")
    part.add(JointPD(name="pd", kp=np.array([40.0, 20.0]), kd=2.0, period=0.01))
    part.inlets = {"q": ["pd.q"], "v": ["pd.v"], "desired": ["pd.q_desired"]}
    part.outlets = {"effort": "pd.effort"}
    return part


def stated() -> sf.Diagram:
    d = sf.Diagram("arm in Python")
    d.add_model("arm", sf.load(ARM), {"q1": 0.5})
    d.add(ForwardDynamics(name="plant", model="arm"), u="left.effort")
    d.include("left", control(), q="plant.q", v="plant.v", desired="plant.q")
    d.simulation = RunSettings(t_end=0.1, dt=1e-3, realtime=2.0, plots=(Plot("q: first", ("plant.q[0]",)),))
    return d


def test_a_diagram_survives_saving_and_loading(tmp_path: Path) -> None:
    d = sf.load_diagram(folder_with(tmp_path))
    written = sf.save_diagram(d, tmp_path / "again.yaml")
    assert written == [tmp_path / "again.yaml"]  # The model has its file already.
    again = sf.load_diagram(tmp_path / "again.yaml")
    assert again == d
    sf.save_diagram(again, tmp_path / "third.yaml")
    assert (tmp_path / "third.yaml").read_text() == (tmp_path / "again.yaml").read_text()


def test_diagrams_built_in_python_survive_saving(tmp_path: Path) -> None:
    files = sf.save_diagram(stated(), tmp_path / "d.yaml")
    assert [file.name for file in files] == ["d_arm.yaml", "d.yaml"]
    again = sf.load_diagram(tmp_path / "d.yaml")
    assert again.models == stated().models and again.wires == stated().wires and again.outlets == stated().outlets
    assert again.simulation == stated().simulation and again.parts.keys() == {"left"}
    runs = [sf.Simulation(d).run(0.1, dt=1e-3, realtime=False) for d in (stated(), again)]
    assert np.array_equal(runs[0]["left.effort"], runs[1]["left.effort"])


def test_inlets_survive_saving(tmp_path: Path) -> None:
    d = control()
    d.add_inlet("offset", "pd.v_desired", shape=(2,), unit="rad/s", start=[0.5, 0.0])
    sf.save_diagram(d, tmp_path / "d.yaml")
    again = sf.load_diagram(tmp_path / "d.yaml")
    assert again.inlet_ports == d.inlet_ports and again.inlets == {name: tuple(to) for name, to in d.inlets.items()}
    reported = sf.Simulation(again).run(0.01, inputs={"q": [0.1, 0.2], "v": 0.0, "desired": 0.0, "offset": "t"})
    assert reported.unit("offset") == "rad/s" and reported["effort"].shape[1:] == (2,)


@pytest.mark.parametrize(
    ("stated", "words"),
    [("{shape: [2]}", "'to' is missing"), ("{to: pd.q, shape: [0]}", "shape is none"), ("{to: pd.q, sise: 1}", "sise")],
)
def test_inlets_that_are_none_are_refused(stated: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "d.yaml").write_text(f"symofros_diagram: 1\nblocks: {{}}\ninlets:\n  q: {stated}\n")
    with pytest.raises(sf.DescriptionError, match=f"d.yaml:4: inlet 'q'(?s:.)*{words}"):
        sf.load_diagram(tmp_path / "d.yaml")


def test_parts_of_files_stay_references(tmp_path: Path) -> None:
    sf.save_diagram(control(), tmp_path / "control.yaml")
    d = sf.Diagram("d")
    d.add_model("arm", sf.load(ARM))
    d.add(ForwardDynamics(name="plant", model="arm"), u="left.effort")
    d.include("left", sf.load_diagram(tmp_path / "control.yaml"), q="plant.q", v="plant.v")
    d.connect("plant.q", "left/pd.q_desired")
    sf.save_diagram(d, tmp_path / "d.yaml")
    text = (tmp_path / "d.yaml").read_text()
    assert "file: control.yaml" in text and "left/pd.q_desired: plant.q" in text and "joint_pd" not in text
    assert sf.load_diagram(tmp_path / "d.yaml").wires == d.wires


def test_options_of_reading_are_those_of_load_and_are_written_again(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(RESISTED)
    (tmp_path / "meshes").mkdir()
    stated = "dissipation: all, limits: stops, waive: [massless_tip], packages: {meshes: meshes}"
    text = f"symofros_diagram: 1\nmodels:\n  arm: {{file: arm.urdf, {stated}}}\n"
    (tmp_path / "d.yaml").write_text(text)
    d = sf.load_diagram(tmp_path / "d.yaml")
    arm = d.models["arm"].system.body("arm")
    assert arm.joint and {type(item) for item in arm.joint.elements} == {sf.Damper, sf.Friction, sf.Stop}
    assert arm.waive == ("massless_tip",)
    assert sf.save_diagram(d, tmp_path / "again.yaml") == [tmp_path / "again.yaml"]
    assert sf.load_diagram(tmp_path / "again.yaml") == d
    again = (tmp_path / "again.yaml").read_text()
    assert all(words in again for words in ("dissipation: all", "limits: stops", "massless_tip", "meshes: meshes"))


def test_a_model_that_was_changed_gets_a_file_of_its_own(tmp_path: Path) -> None:
    d = sf.load_diagram(folder_with(tmp_path))
    lighter = sf.load(tmp_path / "arm.yaml")
    d.models["arm"] = type(d.models["arm"])(
        sf.System("other", lighter.bodies, lighter.parameters, lighter.inputs), file=d.models["arm"].file
    )
    names = [file.name for file in sf.save_diagram(d, tmp_path / "again.yaml")]
    assert names == ["again_arm.yaml", "again.yaml"]
    assert sf.load_diagram(tmp_path / "again.yaml").models["arm"].system.name == "other"


def test_a_changed_part_is_not_written(tmp_path: Path) -> None:
    d = stated()
    d.blocks["left/pd"] = JointPD(name="left/pd", kp=1.0, kd=0.0, period=0.01)
    with pytest.raises(sf.DescriptionError, match="part 'left' can't be written"):
        sf.save_diagram(d, tmp_path / "d.yaml")
    assert not list(tmp_path.iterdir())


@dataclass(frozen=True, kw_only=True)
class Calls(Block):
    """Holds a function."""

    function: Any


def test_python_functions_are_not_written(tmp_path: Path) -> None:
    d = sf.Diagram("d")
    d.add(Calls(name="c", function=print))
    with pytest.raises(sf.DescriptionError, match="block 'c' can't be written: function"):
        sf.save_diagram(d, tmp_path / "d.yaml")
