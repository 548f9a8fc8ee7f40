"""A diagram as a C program: it compiles without a warning, and tells what the same run from Python tells."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.settings import RunSettings
from tests.diagrams.parts import Ball, Counter, Lag, Spoken, arm
from tests.diagrams.run.test_states_of_forces import driven
from tests.exports.cases import build, run
from tests.models import sampled
from tests.pulses import SHAPES, cart

MODELS = Path(__file__).parents[2] / "reference_models"


def pendulum() -> sf.Diagram:
    return arm(sf.load(MODELS / "rigid" / "double_pendulum.yaml"), 2e-3, q1=0.3)


def crank() -> sf.Diagram:
    """Constraints, multipliers at samples, and a constraint that engages."""
    system = sf.load(MODELS / "closed" / "slider_crank.yaml")
    model = sf.compile(system)
    closed = sf.assemble(model, model.neutral(), np.full(model.nv, 0.5))
    diagram = sf.Diagram("crank")
    stated = dict(zip(model.names.q, closed.q, strict=True))
    diagram.add_model("plant", system, start=stated)
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant", engaged=True), engaged="after")
    diagram.add(blocks.Step(name="after", time=0.03, before=[0.0], after=[1.0], period=0.01))
    diagram.add(blocks.Hold(name="felt", period=0.01), u="plant.lam")
    return diagram


def loop() -> sf.Diagram:
    """Constraints, and nothing that is sampled: multipliers are outputs nevertheless."""
    diagram, plant = sf.Diagram("loop"), crank().models["plant"]
    model = sf.compile(plant.system)
    q = [plant.start[name] for name in model.names.q]
    moving = sf.assemble(model, q, np.full(model.nv, 0.5))
    speeds = {f"d{name}": x for name, x in zip(model.names.v, moving.v, strict=True)}
    diagram.add_model("plant", plant.system, {**plant.start, **speeds})
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant"))
    return diagram


def table() -> sf.Diagram:
    diagram = sf.Diagram("1 table")
    values = [[0.0, 1.0], [1.0, 0.0], [0.5, 0.5]]
    diagram.add(blocks.Sequence(name="given", t=[0.0, 0.5, 1.0], values=values))
    diagram.add(blocks.Pick(name="first", entries=[0]), u="given")
    diagram.add(Lag(name="lag"), x="first")
    diagram.add(blocks.Hold(name="held", period=0.25), u="given")
    return diagram


def ball() -> sf.Diagram:
    diagram = sf.Diagram("ball")
    diagram.add(Ball(name="ball"))
    diagram.add(Counter(name="ticks", period=0.1))
    return diagram


def still() -> sf.Diagram:
    """A diagram in which nothing moves between samples."""
    diagram = sf.Diagram("still")
    diagram.add(Counter(name="ticks", period=0.5))
    return diagram


CASES: dict[str, tuple[Any, list[str]]] = {
    "pendulum": (pendulum, ["plant.q", "plant.a", "pd.effort"]),
    "crank": (crank, ["plant.q", "plant.lam", "felt"]),
    "loop": (loop, ["plant.q", "plant.lam"]),
    "table": (table, ["given", "lag", "held"]),
    "ball": (ball, ["ball.height", "ball.bounces", "ticks"]),
    "still": (still, ["ticks"]),
    "bristles": (lambda: driven("bristles"), ["plant.q", "plant.v", "plant.z"]),
}


# A model under control, one with a loop, events, states of forces; the others' blocks are among theirs.
SAMPLED = sampled(tuple(CASES), ("pendulum", "loop", "table", "ball", "bristles"))


@pytest.mark.parametrize("case", SAMPLED)
def test_the_program_prints_the_values_of_python(case: str, tmp_path: Path) -> None:
    make, outputs = CASES[case]
    diagram = make()
    exported = sf.export(diagram, "c", tmp_path / "c", outputs=outputs)
    assert exported.target == "c"
    program = build(exported.folder, "program")
    check = subprocess.run([program, "--check"], capture_output=True, text=True)
    assert check.returncode == 0, check.stdout
    done = subprocess.run([program, "1.1", "0.05"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    header, *rows = done.stdout.splitlines()
    reported = np.array([[float(x) for x in row.split(",")] for row in rows])
    moved = sf.Simulation(diagram).run(1.1, dt=1e-3, record=0.05)
    if case != "ball":  # Whose crossings are recorded, too.
        want = np.concatenate([np.asarray(moved[name]).reshape(len(moved.t), -1) for name in outputs], axis=1)
        assert header.split(",")[0] == "t" and len(header.split(",")) == 1 + want.shape[1]
        assert np.abs(reported[:, 0] - moved.t).max() < 1e-12
        assert np.abs(reported[:, 1:] - want).max() < 1e-8 * max(1.0, np.abs(want).max())
    else:
        assert reported[-1, 2] == moved["ball.bounces"][-1] == 2


def switching() -> tuple[sf.Diagram, list[str]]:
    """A relay that begins on, a machine that reads it, integrals and relays that are enabled; outputs of all."""
    diagram = sf.Diagram("switching")
    diagram.add(blocks.Sine(name="u", frequency=1.0, phase=2.0))
    diagram.add(blocks.Relay(name="relay", lower=-0.5, upper=0.5), u="u.y")
    states = {
        "low": blocks.MachineState(during={"y": "0-u"}, entry={"n": "n + 1"}),
        "high": blocks.MachineState(exit={"y": "elapsed"}),
    }
    ways = (blocks.Transition("low", "high", "on-0.5"), blocks.Transition("high", "low", "0.5-on"))
    outputs = {"y": 0.0, "n": 0.0}
    diagram.add(
        blocks.StateMachine(name="m", machine_states=states, transitions=ways, outputs=outputs), u="u.y", on="relay.y"
    )
    part = sf.Diagram("part")
    part.add(blocks.Integrator(name="sum", start=0.25))
    part.add(blocks.Relay(name="sign", lower=0.1, upper=0.4), u="sum.y")
    part.add_inlet("u", "sum.u")
    part.outlets = {"x": "sum.y", "sign": "sign.y"}
    resets = sf.Condition(enabled="u.y", outputs="reset", states="reset", initial={"x": -1.0})
    diagram.include("wave", part, None, resets, u="u.y")
    diagram.include("relayed", part, None, sf.Condition(enabled="relay.y"), u="u.y")
    return diagram, ["relay.y", "m.state", "m.y", "m.n", "wave/sum.y", "relayed/sum.y", "relayed/sign.y"]


def test_programs_switch_where_python_does(tmp_path: Path) -> None:
    """Located in time; what begins on is on, and one switches what another reads."""
    diagram, outputs_printed = switching()
    program = build(sf.export(diagram, "c", tmp_path / "c", outputs=outputs_printed).folder, "program")
    assert subprocess.run([program, "--check"], capture_output=True).returncode == 0
    done = subprocess.run([program, "1.1", "0.05"], capture_output=True, text=True)
    printed = np.array([[float(x) for x in row.split(",")] for row in done.stdout.splitlines()[1:]])
    run = sf.Simulation(diagram).run(1.1, dt=1e-3, record=0.05)
    last = [np.flatnonzero(np.abs(run.t - t) < 1e-12)[-1] for t in printed[:, 0]]  # Crossings are recorded, too.
    last[0] = 0  # What is met at the start is so in the first step.
    want = np.column_stack([run[name][last] for name in outputs_printed])
    assert len({tuple(row) for row in want[:, [0, 1, 3]]}) == 4 and set(want[:, -1]) == {0.0, 1.0}
    np.testing.assert_allclose(printed[:, 1:], want, atol=1e-9)


@pytest.mark.parametrize(("shape", "method"), [*((shape, "dopri5") for shape in SHAPES), ("tent", "rk4")])
def test_programs_resolve_pulses_of_model_formulas(shape: str, method: str, tmp_path: Path) -> None:
    """However its run is cut: a part whose steps end at no instants stays at rest."""
    force, impulse = SHAPES[shape]
    diagram = sf.Diagram("cart")
    diagram.add_model("plant", cart(force.replace("late", "(late + 0.0055)")))
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant"))
    program = build(sf.export(diagram, "c", tmp_path / "c", method=method, dt=0.01).folder, "program")
    for period in ("10", "0.1"):
        last = run(program, "10", period, cwd=tmp_path).splitlines()[-1].split(",")
        assert float(last[-1]) == pytest.approx(impulse, rel=1e-4), period
    moved = sf.Simulation(diagram).run(10.0, method=method, dt=0.01, record=0.5)
    assert moved["plant.v"][-1, 0] == pytest.approx(impulse, rel=1e-4)


NONSENSE = (
    ["--fast"],
    ["1", "x"],
    ["1s"],
    ["1", "0.1", "2"],
    ["nan"],
    ["inf"],
    ["1", "0"],
    ["-1"],
    ["1", "--quiett"],
    [""],
)


def test_the_program_refuses_invalid_arguments_and_the_readme_names_its_outputs(tmp_path: Path) -> None:
    exported = sf.export(pendulum(), "c", tmp_path / "c")
    program = build(exported.folder, "program")
    for arguments in NONSENSE:
        done = subprocess.run([program, *arguments], capture_output=True, text=True)
        assert done.returncode == 2, arguments
        assert done.stderr.startswith("usage: arm SECONDS [PERIOD]"), arguments
        assert done.stdout == "", arguments
    readme = (exported.folder / "README.md").read_text()
    header = subprocess.run([program, "0"], capture_output=True, text=True).stdout.splitlines()[0]
    assert all(f"`{entry.partition('[')[0]}`" in readme for entry in header.split(",")[1:])
    assert readme.startswith("# arm\n")
    assert "--realtime" in readme


def test_a_program_uses_the_stated_step_settings_or_notes_others(tmp_path: Path) -> None:
    stated = pendulum()
    stated.simulation = RunSettings(method="dopri5", dt=0.004, rtol=1e-3, atol=1e-4, beam_limit=0.03)
    written = {
        name: (sf.export(stated, "c", tmp_path / name, **said).folder / "arm_part0_plant.c").read_text()
        for name, said in (("file", {}), ("said", {"method": "dop853", "dt": 0.002, "rtol": 1e-5}))
    }
    assert re.search(r'"dopri5", .*\n.*, 0\.004, 0\.001, 0\.0001,\n', written["file"])
    assert re.search(r'"dop853", .*\n.*, 0\.002, 1e-05, 0\.0001,\n', written["said"])
    assert all("0.03}" in text or "0.03," in text for text in written.values())
    with pytest.raises(sf.UnknownNameError, match="no method 'rk5'"):
        sf.export(pendulum(), "c", tmp_path / "other", method="rk5")
    with pytest.raises(sf.ExportError, match="dt is not positive"):
        sf.export(pendulum(), "c", tmp_path / "other", dt=-1.0)


def test_a_wrong_program_fails_its_check(tmp_path: Path) -> None:
    exported = sf.export(pendulum(), "c", tmp_path / "c")
    program = exported.folder / "arm_program.c"
    program.write_text(program.read_text().replace("u_start[] = {0", "u_start[] = {0, 0", 1))
    instants = exported.folder / "arm_instants.c"
    text = instants.read_text()
    assert "50.0" in text
    instants.write_text(text.replace("50.0", "51.0", 1))
    assert subprocess.run([build(exported.folder, "program"), "--check"], capture_output=True).returncode == 1


def test_diagrams_that_cannot_become_programs_are_refused() -> None:
    diagram = pendulum()
    diagram.add(Spoken(name="spoken", period=0.01, heard=[]), x="pd.effort")
    with pytest.raises(sf.ExportError, match="block 'spoken' calls Python"):
        sf.export(diagram, "c", "unused")
    with pytest.raises(sf.ExportError, match="implicit"):
        sf.export(pendulum(), "c", "unused", method="rodas4")
    with pytest.raises(sf.ExportError, match="becomes a program"):
        sf.export(pendulum(), "urdf", "unused")
    with pytest.raises(sf.DescriptionError, match="no output 'z'"):
        sf.export(pendulum(), "c", "unused", outputs=["pd.z"])
