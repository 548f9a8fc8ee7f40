"""What judging beams costs a run: instructions with it over instructions without, less one (docs/theory/beams.md, 6).

Counted by valgrind's callgrind in packages of C, as gcc -O2 compiles them, over the steps alone. No time is measured:
the numbers are those of the compiler and the machine's instruction set, whatever else runs.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import symofros as sf
from tests.exports.cases import need
from tests.simulation.beam_models import cantilever_system
from validation.inputs.cases import named

# Steps, their length and whether beams are judged; then pairs of an index and a value: of q, v, u and parameters.
_DRIVER = Path(__file__).with_name("judging_beams.c").read_text()


def spatial() -> sf.System:
    """A strip that bends in both planes and twists, two coordinates each."""
    tip = sf.BeamLoad((0.0, sf.formula("F", "load"), 0.0), at=1.0, axes="world")
    stiffness = {"EI_z": 4.0, "EI_y": 1.0, "GJ": 2.0, "rhoJ": 0.1}
    shapes = {"bend_y": 2, "bend_z": 2, "twist": 2}
    strip = sf.Beam("strip", sf.Joint("root", "fixed"), 0.5, 1.0, **stiffness, **shapes, loads=(tip,))
    return sf.System("strip", (strip,), gravity=(0, 0, 0), parameters=(sf.Parameter("F", 0.0),))


def robot() -> sf.System:
    """The paper's planar robot: two flexible links, eleven speeds."""
    return named(["planar_robot"])[0].load().system


SYSTEMS = {"cantilever": cantilever_system, "strip": spatial, "planar_robot": robot}


@dataclass(frozen=True)
class Scene:
    """A run of a system.

    Attributes:
        system: Its name in SYSTEMS.
        steps: Number of steps.
        h: Step [s].
        q: First values of coordinates, by index.
        v: Of speeds.
        u: Inputs.
        par: Parameters, by name.
    """

    system: str
    steps: int
    h: float
    q: Mapping[int, float] = field(default_factory=dict)
    v: Mapping[int, float] = field(default_factory=dict)
    u: Mapping[int, float] = field(default_factory=dict)
    par: Mapping[str, float] = field(default_factory=dict)


# Periods of the cantilever: 1.79, 0.285, 0.1 s; RK4 is stable up to 0.03 s. With "few" or "coarse" steps the motion
# grows or turns by much from one to the next.
SCENES = {
    "beam swings": Scene("cantilever", 4000, 1e-3, par={"F": 0.3}),
    "beam swings, many modes": Scene("cantilever", 4000, 1e-3, q={0: 0.1, 1: -0.03, 2: 0.01}),
    "beam swings, coarse steps": Scene("cantilever", 2000, 0.02, par={"F": 0.3}),
    "beam swings, coarse steps, many modes": Scene("cantilever", 2000, 0.02, q={0: 0.1, 1: -0.03, 2: 0.01}),
    "beam bends further": Scene("cantilever", 5000, 1.6e-4, par={"F": 0.3}),
    "beam bends further, few steps": Scene("cantilever", 2000, 4e-4, par={"F": 0.3}),
    "beam buckles": Scene("cantilever", 2000, 1e-3, q={0: 1e-3}, par={"P": 4.0}),
    "strip swings": Scene("strip", 4000, 5e-4, q={4: 0.3}, par={"F": 0.5}),
    "strip swings, coarse steps": Scene("strip", 2000, 5e-3, q={4: 0.3}, par={"F": 0.5}),
    "robot moves": Scene("planar_robot", 2000, 5e-4, u={0: 6.0, 1: 3.0, 2: 0.5}),
    "robot vibrates": Scene("planar_robot", 2000, 5e-4, q={2: 0.02, 6: 0.02}),
    "robot bends further": Scene("planar_robot", 4000, 1e-5, u={0: 60.0, 1: 30.0, 2: 5.0}),
    "robot bends further, few steps": Scene("planar_robot", 2000, 2e-5, u={0: 60.0, 1: 30.0, 2: 5.0}),
}


@cache
def package(name: str, folder: Path) -> tuple[Path, sf.Model]:
    """The program of a system's package, and its model for indices of parameters."""
    system = SYSTEMS[name]()
    target = folder / name
    sf.export(system, "c", target, method="rk4", dt=1e-3)
    (target / "main.c").write_text(_DRIVER.replace("NAME", name))
    files = sorted(path.name for path in target.glob("*.c"))
    subprocess.run(["gcc", "-std=c99", "-g", "-O2", "-I.", *files, "-lm", "-o", "run"], cwd=target, check=True)
    return target / "run", sf.compile(system)


def counted(program: Path, model: sf.Model, scene: Scene, judged: bool) -> tuple[int, str]:
    """Instructions of a run, and what it said: status and stated error of the first beam."""
    par = {model.names.par.index(name): value for name, value in scene.par.items()}
    arrays = (scene.q, scene.v, scene.u, par)
    given = [(array, *pair) for array, values in enumerate(arrays) for pair in values.items()]
    arguments = [scene.steps, scene.h, int(judged), *(item for one in given for item in one)]
    tool = ("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=sym_instance_advance")
    done = subprocess.run([*tool, program, *map(str, arguments)], capture_output=True, text=True, check=True)
    match = re.search(r"Collected : (\d+)", done.stderr)
    assert match is not None, done.stderr
    return int(match[1]), done.stdout.strip()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("judging")


@pytest.mark.tools
@pytest.mark.skipif(shutil.which("valgrind") is None, reason="counts by valgrind")
@pytest.mark.parametrize("name", SCENES)
def test_cost_share_of_judging_beams(benchmark: BenchmarkFixture, name: str, folder: Path) -> None:
    need("valgrind")
    scene = SCENES[name]
    program, model = package(scene.system, folder)
    with_it, said = benchmark.pedantic(counted, args=(program, model, scene, True))
    without, _ = counted(program, model, scene, False)
    share = with_it / without - 1.0
    benchmark.extra_info["share"] = share
    status, error = said.split()
    each = f"{without / scene.steps:.0f} instructions a step, {(with_it - without) / scene.steps:.1f} of judging"
    print(f"{name}: {100.0 * share:.2f} % ({each}; status {status}, error {100.0 * float(error):.3g} %)")
