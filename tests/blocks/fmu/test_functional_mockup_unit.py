"""Units of FMI as blocks: our own exports give what the one diagram gives; foreign code ends in words."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros import blocks
from symofros.diagrams.files.reader import read_diagram
from tests.blocks.fmu.wilful import changed, wilful_unit

PERIOD = 0.001


@pytest.fixture(scope="module")
def wilful(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A unit that passes its input on, crashes, hangs, fails, prints or ends, as its input says."""
    return str(wilful_unit(tmp_path_factory.mktemp("wilful")))


def fed(unit: str, *values: float, **fields: Any) -> sf.Diagram:
    """A unit whose input follows some values, a sample each."""
    diagram = sf.Diagram("fed")
    diagram.add(blocks.Sequence(name="wish", t=[0.1 * i for i in range(len(values))], values=list(values), kind="hold"))
    diagram.add(blocks.FMU(name="unit", file=unit, period=0.1, **fields), pump_u="wish.y")
    return diagram


def plant() -> sf.Diagram:
    """A double pendulum, driven from outside."""
    diagram = sf.Diagram("plant")
    diagram.add_model("arm", MODELS["double_pendulum"], start={"q1": 0.3})
    diagram.add(blocks.ForwardDynamics(name="arm", model="arm"))
    diagram.add_inlet("effort", "arm.u")
    diagram.outlets = {"q": "arm.q", "v": "arm.v"}
    return diagram


def controlled(part: str, add: Callable[[sf.Diagram], object]) -> sf.DiagramRun:
    """A run under a sampled controller, whose plant is a part of any kind."""
    diagram = sf.Diagram("whole")
    diagram.add(blocks.Sine(name="wish", amplitude=[0.4, 0.2], frequency=0.5, period=PERIOD))
    pd = blocks.JointPD(name="pd", kp=[50.0, 30.0], kd=[5.0, 3.0], period=PERIOD)
    diagram.add(pd, q_desired="wish.y", q=f"{part}.q", v=f"{part}.v")
    add(diagram)
    return sf.Simulation(diagram).run(0.2, dt=PERIOD, record=PERIOD)


def entries(name: str, separator: str = "[{}]") -> list[str]:
    """Names of the two scalars of a vector."""
    return [name + separator.format(i) for i in range(2)]


def vectors(q: list[str], v: list[str], u: list[str]) -> dict[str, Any]:
    """Ports of a plant."""
    return {"inputs": {"u": u}, "outputs": {"q": q, "v": v}, "allow_native": True}


def one_program(diagram: sf.Diagram) -> None:
    """The plant as a block of the same program."""
    diagram.add_model("arm", MODELS["double_pendulum"], start={"q1": 0.3})
    diagram.add(blocks.ForwardDynamics(name="arm", model="arm"), u="pd.effort")


@pytest.mark.parametrize("version", ["fmu2", "fmu3"])
def test_an_exported_plant_gives_what_the_one_program_gives(version: str, tmp_path: Path) -> None:
    """Without feedthrough: no algebraic loop, and no delay beyond the sample. Paths are taken as exports give them."""
    file: Any = sf.export(plant(), version, tmp_path, dt=PERIOD).files[0]  # type: ignore[arg-type]
    ports = vectors(entries("q"), entries("v"), entries("effort"))
    unit = blocks.FMU(name="unit", file=file, period=PERIOD, **ports)
    assert not unit.feeds_through()
    run = controlled("unit", lambda diagram: diagram.add(unit, u="pd.effort"))
    whole = controlled("arm", one_program)
    assert run.outcome.ok and np.abs(run["pd.effort"] - whole["pd.effort"]).max() < 1e-11
    assert np.abs(run["unit.q"] - whole["arm.q"]).max() < 1e-13 and np.ptp(whole["arm.q"]) > 1e-2


@pytest.mark.parametrize("variant", ["co_simulation", "model_exchange"])
def test_an_exported_model_is_integrated_between_samples(variant: Any, tmp_path: Path) -> None:
    """By itself, or by CVODE, which begins anew at each sample with steps of first order: its error shows."""
    file = str(sf.export(MODELS["double_pendulum"], "fmu2", tmp_path, dt=PERIOD).files[0])
    ports = vectors(["q.q1", "q.q2"], ["v.q1", "v.q2"], ["u.q1", "u.q2"])
    start = {"q.q1": 0.3}
    unit = blocks.FMU(name="unit", file=file, period=PERIOD, variant=variant, start=start, rtol=1e-10, **ports)
    run = controlled("unit", lambda diagram: diagram.add(unit, u="pd.effort"))
    off = np.abs(run["unit.q"] - controlled("arm", one_program)["arm.q"]).max()
    assert run.outcome.ok and off < (1e-13 if variant == "co_simulation" else 1e-7)
    assert off > 0.0 or variant == "co_simulation"


def test_ports_are_the_variables_of_the_unit(wilful: str) -> None:
    """With their units, where these are known; a wire of another unit is refused."""
    run = sf.Simulation(fed(wilful, 0.0, 0.25, 0.5, allow_native=True)).run(0.3, record=0.1)
    assert run.outcome.ok and run["unit.pump_y"].tolist() == [0.0, 0.25, 0.5, 0.5]
    late = fed(wilful, 0.0, 0.25, 0.5, allow_native=True, feedthrough=False)
    assert sf.Simulation(late).run(0.3, record=0.1)["unit.pump_y"].tolist() == [0.0, 0.0, 0.25, 0.5]
    diagram = sf.Diagram("wrong")
    diagram.add(blocks.Constant(name="angle", value=1.0, unit="rad"))
    diagram.add(blocks.FMU(name="unit", file=wilful, period=0.1), pump_u="angle.y")
    with pytest.raises(sf.DescriptionError, match="N m"):
        sf.Simulation(diagram)


def test_communication_steps_are_the_period(wilful: str) -> None:
    """Differences of times are not, to the last bit: a unit that counts steps of its own lost some of them."""
    diagram = sf.Diagram("counted")
    diagram.add(blocks.FMU(name="unit", file=wilful, period=0.01, allow_native=True))
    counts = sf.Simulation(diagram).run(1.0, record=0.01)["unit.milliseconds"]
    assert counts.tolist() == [10.0 * k for k in range(101)]


def test_a_unit_is_initialised_with_its_inputs(wilful: str) -> None:
    """It was with their starts; without feedthrough those of the first sample are not known then."""
    for through, first in ((True, 0.25), (False, 0.0)):
        diagram = fed(wilful, 0.25, 0.5, 0.75, allow_native=True, feedthrough=through)
        assert sf.Simulation(diagram).run(0.2, record=0.1)["unit.first"].tolist() == [first] * 3


@pytest.mark.parametrize("version", ["fmu2", "fmu3"])
def test_a_sampled_controller_reads_inputs_of_the_communication_before(version: str, tmp_path: Path) -> None:
    """But the first, which it is initialised with: samples at the end of a step lie within it."""
    held = sf.Diagram("held")
    held.add(blocks.Hold(name="hold", period=0.02))
    held.add_inlet("u", "hold.u", shape=())
    held.outlets = {"y": "hold.y"}
    file = str(sf.export(held, version, tmp_path).files[0])  # type: ignore[arg-type]
    for period, late in ((0.02, 1), (0.01, 2)):
        diagram = sf.Diagram("late")
        diagram.add(blocks.Formula(name="wish", formulas={"y": "3 + t"}))
        diagram.add(blocks.FMU(name="unit", file=file, period=period, allow_native=True), u="wish.y")
        run = sf.Simulation(diagram).run(0.1, dt=0.01, record=0.02)
        assert np.allclose(run["unit.y"], [3.0, *(run["wish.y"][1:] - 0.02 / late)], atol=1e-12)


@pytest.mark.parametrize(
    ("wish", "words"),
    [
        (1.0, "SIGABRT"),
        (2.0, "takes longer than 0.5 s"),
        (3.0, "it says: the pump is dry"),
        (5.0, "ended with status 3"),
    ],
)
def test_native_code_that_fails_ends_the_run_in_words(wilful: str, wish: float, words: str) -> None:
    diagram = fed(wilful, 0.0, wish, 0.0, allow_native=True, timeout=0.5)
    run = sf.Simulation(diagram).run(0.5, record=0.1)
    said = f"{run.outcome} {run.outcome.failure}"
    assert not run.outcome.ok and words in said and "block 'unit'" in said and "t = 0.2 s" in said


def test_output_printed_by_native_code_is_no_answer(wilful: str) -> None:
    run = sf.Simulation(fed(wilful, 4.0, 4.0, allow_native=True)).run(0.2, record=0.1)
    assert run.outcome.ok and (run["unit.pump_y"] == 4.0).all()


def test_no_native_code_runs_without_consent(wilful: str, tmp_path: Path) -> None:
    """Neither from Python nor from a file, which can't consent for its reader."""
    diagram = fed(wilful, 0.0, 0.0)
    with pytest.raises(sf.DescriptionError, match="allow_native=True"):
        sf.Simulation(diagram).run(0.1)
    path = tmp_path / "fed.yaml"
    (tmp_path / "wilful.fmu").write_bytes(Path(wilful).read_bytes())
    sf.save_diagram(fed(str(tmp_path / "wilful.fmu"), 0.0, 0.0, allow_native=True), path)
    assert "allow_native" not in path.read_text()
    with pytest.raises(sf.DescriptionError, match="--allow-native"):
        sf.Simulation(sf.load_diagram(path)).run(0.1)
    assert sf.Simulation(sf.load_diagram(path, allow_native=True)).run(0.1).outcome.ok
    path.write_text(path.read_text().replace("period:", "allow_native: true\n    period:"))
    with pytest.raises(sf.DescriptionError, match="allow_native"):
        sf.load_diagram(path)


def test_consent_to_certain_bytes_is_to_no_others(wilful: str, tmp_path: Path) -> None:
    """By a block, and by a reader for those files of a diagram that it names."""
    unit, other, path = tmp_path / "wilful.fmu", tmp_path / "other.fmu", tmp_path / "fed.yaml"
    for file in (unit, other):
        file.write_bytes(Path(wilful).read_bytes())
    digest = hashlib.sha256(unit.read_bytes()).hexdigest()
    sf.save_diagram(fed(str(unit), 0.0, 0.25), path)

    def run(consent: dict[str, str]) -> sf.DiagramRun:
        diagram, _ = read_diagram(path, allow_native=consent)
        assert diagram is not None
        return sf.Simulation(diagram).run(0.1, record=0.1)

    assert run({str(unit): digest})["unit.pump_y"].tolist() == [0.0, 0.25]
    with pytest.raises(sf.DescriptionError, match="your consent alone"):
        run({str(other): digest})
    changed(unit)
    with pytest.raises(sf.DescriptionError, match="has changed since"):
        run({str(unit): digest})


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"inputs": {"u": "pumpu"}}, "did you mean 'pump.u'"),
        ({"inputs": {"u": "fixed"}}, "can't be set"),
        ({"start": {"pump.y": 1.0}}, "has no start"),
        ({"start": {"fixed": [1.0, 2.0]}}, "2 numbers"),
        ({"variant": "model_exchange"}, "co_simulation"),
    ],
)
def test_fields_that_do_not_fit_the_unit_are_refused(wilful: str, fields: dict[str, Any], words: str) -> None:
    diagram = sf.Diagram("wrong")
    diagram.add(blocks.FMU(name="unit", file=wilful, period=0.1, allow_native=True, **fields))
    with pytest.raises(sf.DescriptionError, match=words):
        sf.Simulation(diagram).run(0.1)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04broken", b"<xml/>"])
def test_files_that_are_no_units_are_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "unit.fmu").write_bytes(content)
    diagram = sf.Diagram("wrong")
    diagram.add(blocks.FMU(name="unit", file=str(tmp_path / "unit.fmu"), period=0.1))
    with pytest.raises(sf.DescriptionError, match="can't be read"):
        sf.Simulation(diagram)
