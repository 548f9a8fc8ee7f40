"""FMUs by FMPy: legal by its validator, moved by its simulator and its CVODE, and strict about bad calls."""

from __future__ import annotations

import ctypes
import math
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.simulation import FMICallException
from fmpy.validation import validate_fmu

import symofros as sf
from reference_models import MODELS as REFERENCE
from symofros.exports.c import compiling
from symofros.exports.fmi.fmu_variables import Variable, _distinct
from tests.exports.cases import MODELS, PLANAR, STARTS, STEP, STRICT, first_state, relative, run, system_of, trajectory
from tests.exports.fmi.logs import heard
from tests.models import sampled
from tests.simulation.beam_models import at_rest, cantilever_system

SAME = 1e-12
# CVODE's own tolerance, over the run.
MODEL_EXCHANGE = 1e-6
# Central differences of a function of size 1 by a step of 1e-6.
DIFFERENCES = 1e-6

FLOATING = sf.load(Path(__file__).with_name("floating.yaml"))

# The importer moves the first joint and the last; the tip moves with them.
DRIVEN = sf.load(Path(__file__).with_name("driven.yaml"))
# The importer turns the base by a quaternion.
TURNED = sf.System(
    "turned",
    (
        sf.RigidBody("base", sf.Joint("gimbal", "ball", prescribed=True), sf.Inertia(1.0, moments=(1, 1, 1))),
        sf.RigidBody("arm", sf.Joint("q1", "revolute", "base", axis=(0, 1, 0)), sf.Inertia(1.0, (0.3, 0.1, 0))),
    ),
)
# A weak beam under its weight, which is a parameter; a column under axial load.
BLADE = sf.Beam("blade", sf.Joint("root", "fixed"), 1.0, 1.0, EI_z=1.0, bend_y=2)
LIMP = sf.System("limp", (BLADE,), [sf.Parameter("g", 0.2)], gravity=(0, "-g", 0))
BENT = {"limp": LIMP, "column": cantilever_system()}
OWN = {"floating": FLOATING, "driven": DRIVEN, "planar": PLANAR, "turned": TURNED}


def simulated(path: str, **options: Any) -> tuple[Any, list[str]]:
    """What FMPy's simulator returns, or None where the unit refuses to go on, and the unit's log."""
    with heard() as (logger, log):
        try:
            return fmpy.simulate_fmu(path, logger=logger, **options), log
        except FMICallException:
            return None, log


def system_called(name: str) -> sf.System:
    return (OWN | BENT)[name] if name in OWN | BENT else system_of(name)


def exported(of: sf.System | sf.Diagram, version: int, folder: Path, quick: bool = True, **options: Any) -> Path:
    """The unit of a system or a diagram, its library compiled in a fraction of the time; or as it ships."""
    target: Any = f"fmu{version}"
    with pytest.MonkeyPatch.context() as patch:
        if quick:
            patch.setattr(compiling, "FLAGS", ("-O0", *(flag for flag in compiling.FLAGS if flag != "-O2")))
        return sf.export(of, target, folder, **options).files[0]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """(name, version) -> path; each made once."""
    known: dict[tuple[str, int], Path] = {}

    def make(name: str, version: int) -> Path:
        if (name, version) not in known:
            folder = tmp_path_factory.mktemp("fmu") / "out"
            stated: dict[str, Any] = {"limp": {"method": "dopri5"}, "column": {}}
            options = {"start": STARTS.get(name)} | stated.get(name, {"dt": STEP.get(name, 1e-3)})
            quick = (name, version) != ("four_bar", 3)
            known[name, version] = exported(system_called(name), version, folder, quick, **options)
        return known[name, version]

    return make


@pytest.fixture(params=[2, 3])
def version(request: pytest.FixtureRequest) -> int:
    return request.param


ONE_VERSION = [pytest.param(2, marks=pytest.mark.slow), 3]
# Every model by one version of the standard in every run, by the other with --slow; a loop by both.
VERSIONS = {"planar_robot": 3, "floating": 2, "driven": 3, "planar": 3, "spatial_rod": 3}
# The robot takes as long to make as all others: a beam that a motor turns stands for it.
SAMPLED = sampled(MODELS, ("four_bar", "spatial_rod"))


def by_version(*cases: Any) -> list[Any]:
    """Models and versions that a test is tried with."""
    listed = [case if hasattr(case, "values") else pytest.param(case) for case in cases]
    return [
        pytest.param(version, *case.values, marks=[*case.marks, *([pytest.mark.slow] if other else [])])
        for case in listed
        for version in (2, 3)
        for other in [VERSIONS.get(case.values[0], version) != version]
    ]


def columns(result: Any, prefix: str) -> np.ndarray:
    return np.array([result[name][-1] for name in result.dtype.names if name.startswith(prefix)])


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED, *OWN))
def test_fmpy_validates_the_fmu(made: Any, name: str, version: int) -> None:
    assert validate_fmu(str(made(name, version))) == []


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED))
def test_co_simulation_moves_as_python_does(made: Any, name: str, version: int) -> None:
    found = fmpy.simulate_fmu(str(made(name, version)), fmi_type="CoSimulation", stop_time=0.2, output_interval=0.01)
    wanted = trajectory(name, 0.2)
    assert relative(columns(found, "q."), wanted.q[-1]) < SAME
    assert relative(columns(found, "v."), wanted.v[-1]) < SAME


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED, *OWN))
def test_model_exchange_moves_as_python_does(made: Any, name: str, version: int) -> None:
    found = fmpy.simulate_fmu(
        str(made(name, version)), fmi_type="ModelExchange", stop_time=0.2, output_interval=0.01, relative_tolerance=1e-9
    )
    model = sf.compile(system_called(name))
    q, v = first_state(model, name) if name in STARTS else (model.neutral(), np.zeros(model.nv))
    wanted = sf.simulate(model, q, v, 0.2, dt=1e-4)
    assert relative(columns(found, "q."), wanted.q[-1]) < MODEL_EXCHANGE


def test_shipped_sources_compile_strictly(made: Any, version: int, tmp_path: Path) -> None:
    """The sources that travel with it, as an importer builds them, under the strictest flags."""
    fmpy.extract(str(made("four_bar", version)), tmp_path)
    headers = Path(fmpy.__file__).parent / "c-code"
    run(
        "gcc",
        *STRICT,
        "-fsyntax-only",
        "-isystem",  # The headers of FMI are not ours.
        headers,
        f"four_bar_fmi{version}.c",
        cwd=tmp_path / "sources",
    )


def test_sources_of_two_fmus_share_no_symbol(made: Any, version: int, tmp_path: Path) -> None:
    """FMI 3 asks sources to prefix their functions; FMPy's header of FMI 2 knows no prefix."""
    headers = Path(fmpy.__file__).parent / "c-code"
    defined = []
    for name in ("planar", "four_bar"):
        fmpy.extract(str(made(name, version)), tmp_path / name)
        source = tmp_path / name / "sources" / f"{name}_fmi{version}.c"
        run("gcc", "-std=c99", "-O0", f"-I{headers}", "-c", source, "-o", f"{name}.o", cwd=tmp_path)
        symbols = run("nm", "--defined-only", "--extern-only", f"{name}.o", cwd=tmp_path).split()[2::3]
        defined.append({symbol for symbol in symbols if not symbol.startswith("fmi2")})
    assert all(symbol.startswith("planar_") for symbol in defined[0])
    assert not defined[0] & defined[1]
    assert ("planar_fmi3GetVersion" in defined[0]) == (version == 3)


def test_only_the_interface_is_visible(made: Any, version: int, tmp_path: Path) -> None:
    fmpy.extract(str(made("four_bar", version)), tmp_path)
    (library,) = (tmp_path / "binaries").rglob("*.so")
    symbols = run("nm", "-D", "--defined-only", library, cwd=tmp_path).split()[2::3]
    assert symbols
    assert all(symbol.startswith(f"fmi{version}") for symbol in symbols)


class Unit:
    """An instance of either version, in the hand."""

    def __init__(self, path: Path, version: int, cosim: bool, folder: Path) -> None:
        fmpy.extract(str(path), folder)
        self.path, self.version, self.description = path, version, fmpy.read_model_description(str(path))
        kind: Any = {(2, 0): FMU2Model, (2, 1): FMU2Slave, (3, 0): FMU3Model, (3, 1): FMU3Slave}[version, int(cosim)]
        interface = self.description.coSimulation if cosim else self.description.modelExchange
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            instanceName="it",
            modelIdentifier=interface.modelIdentifier,
        )
        self.fmu.instantiate()
        self.references = {variable.name: variable.valueReference for variable in self.description.modelVariables}

    def start(self) -> None:
        if self.version == 2:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def get(self, *names: str) -> np.ndarray:
        read = self.fmu.getReal if self.version == 2 else self.fmu.getFloat64
        return np.array(read([self.references[name] for name in names]))

    def set(self, name: str, value: float) -> None:
        (self.fmu.setReal if self.version == 2 else self.fmu.setFloat64)([self.references[name]], [value])

    def named(self, prefix: str) -> list[str]:
        return [name for name in self.references if name.startswith(prefix)]

    def save(self) -> Any:
        return (self.fmu.getFMUstate if self.version == 2 else self.fmu.getFMUState)()

    def restore(self, state: Any) -> None:
        (self.fmu.setFMUstate if self.version == 2 else self.fmu.setFMUState)(state)

    def pack(self, state: Any) -> Any:
        """A state as bytes, which the unit declares to give."""
        assert self.description.coSimulation.canGetAndSetFMUstate and self.description.coSimulation.canSerializeFMUstate
        return (self.fmu.serializeFMUstate if self.version == 2 else self.fmu.serializeFMUState)(state)

    def unpack(self, text: Any) -> Any:
        return (self.fmu.deSerializeFMUstate if self.version == 2 else self.fmu.deserializeFMUState)(text)

    def twice(self, steps: int, h: float, *names: str) -> Iterator[np.ndarray]:
        """What some variables are after each of so many steps, from the present state on and, gone back to it, anew."""
        saved, start = self.save(), self.get("time")[0]
        for _ in range(2):
            rows = []
            for k in range(steps):
                self.fmu.doStep(start + k * h, h)
                rows.append(self.get(*names))
            yield np.array(rows)
            self.restore(saved)

    def continuous(self) -> None:
        """Enter the mode in which states move."""
        (self.fmu.newDiscreteStates if self.version == 2 else self.fmu.updateDiscreteStates)()
        self.fmu.enterContinuousTimeMode()

    def states(self, x: np.ndarray) -> None:
        array = (ctypes.c_double * len(x))(*x)
        self.fmu.setContinuousStates(array, len(x))

    def slope(self, unknown: list[str], known: list[str], seed: np.ndarray) -> np.ndarray:
        at = [[self.references[name] for name in names] for names in (unknown, known)]
        return np.array(self.fmu.getDirectionalDerivative(at[0], at[1], list(seed)))


@pytest.fixture
def unit(made: Any, version: int, tmp_path: Path) -> Iterator[Any]:
    units = []

    def make(name: str, cosim: bool) -> Unit:
        units.append(Unit(made(name, version), version, cosim, tmp_path / str(len(units))))
        return units[-1]

    yield make
    for one in units:
        one.fmu.freeInstance()
        shutil.rmtree(tmp_path, ignore_errors=True)


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED, *OWN))
def test_directional_derivatives_match_the_functions(unit: Any, name: str, rng: np.random.Generator) -> None:
    it = unit(name, cosim=False)
    it.start()
    it.continuous()
    states = it.named("q.") + it.named("v.")
    inputs = it.named("u.")
    unknown = it.named("der(") + it.named("p.")
    # Away from the start, where much is zero; quaternions among the states may be of any length.
    x = it.get(*states) + 0.2 * rng.standard_normal(len(states))
    u = rng.standard_normal(len(inputs))
    turns = [
        k
        for k, label in enumerate(inputs)
        if label.endswith((".qx", ".qy", ".qz", ".qw", ".qx'", ".qy'", ".qz'", ".qw'"))
    ]
    u[turns] /= np.linalg.norm(u[turns]) if turns else 1.0

    def values(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        it.states(x)
        for label, value in zip(inputs, u, strict=True):
            it.set(label, value)
        return it.get(*unknown)

    dx, du, h = rng.standard_normal(len(states)), rng.standard_normal(len(inputs)), 1e-6
    wanted = (values(x + h * dx, u + h * du) - values(x - h * dx, u - h * du)) / (2 * h)
    values(x, u)
    found = it.slope(unknown, states + inputs, np.concatenate([dx, du]))
    assert np.abs(found - wanted).max() < DIFFERENCES * max(1.0, np.abs(wanted).max())


def test_fmu_states_are_saved_and_restored(unit: Any) -> None:
    it = unit("four_bar", cosim=True)
    it.start()
    it.fmu.doStep(0.0, 0.01)
    saved = it.save()
    text = it.pack(saved)
    names = it.named("q.")
    it.fmu.doStep(0.01, 0.02)
    first = it.get(*names)
    for state in (saved, it.unpack(text)):
        it.restore(state)
        assert it.get("time")[0] == 0.01
        it.fmu.doStep(0.01, 0.02)
        assert np.array_equal(it.get(*names), first)


def test_parameters_are_separate_per_instance(unit: Any) -> None:
    one, other = unit("four_bar", cosim=True), unit("four_bar", cosim=True)
    one.set("par.m", 5.0)
    for it in (one, other):
        it.start()
    assert (one.get("par.m")[0], other.get("par.m")[0]) == (5.0, 1.0)
    assert one.get("energy.kinetic")[0] == pytest.approx(5.0 * other.get("energy.kinetic")[0], rel=1e-12)


@pytest.mark.parametrize(("value", "ok"), [(5.0, True), (1e-6, True), (0.0, False), (-5.0, False)])
def test_parameters_that_the_description_refuses_are_refused(unit: Any, value: float, ok: bool) -> None:
    it = unit("four_bar", cosim=True)
    it.set("par.m", value)
    if ok:
        it.start()
        return
    with pytest.raises(FMICallException):
        it.start()


def test_the_condition_that_a_parameter_does_not_meet_is_named(made: Any, version: int) -> None:
    done, log = simulated(str(made("four_bar", version)), stop_time=0.01, start_values={"par.m": -5.0})
    assert done is None and "mass >= 0" in "".join(log), log


def test_calls_forbidden_by_the_standard_are_refused(unit: Any) -> None:
    it = unit("four_bar", cosim=True)
    forbidden = [
        lambda: it.fmu.doStep(0.0, 0.01),  # before initialisation
        lambda: it.get("q.q1"),
        lambda: it.set("der(v.q1)", 1.0),  # calculated
        lambda: it.set("par.m", float("nan")),
        lambda: it.set("lam.'loop.x'", 0.0) if "lam.'loop.x'" in it.references else it.set("time", 1.0),
    ]
    for call in forbidden:
        with pytest.raises(FMICallException):
            call()
    it.start()
    for call in (
        lambda: it.set("q.q1", 0.0),  # a state is not set while it moves
        lambda: it.fmu.doStep(0.5, 0.01),  # not where it is
        lambda: it.fmu.doStep(0.0, -0.01),
        it.fmu.enterInitializationMode,
    ):
        with pytest.raises(FMICallException):
            call()
    it.references["nothing"] = 10_000
    with pytest.raises(FMICallException):
        it.get("nothing")
    it.fmu.doStep(0.0, 0.01)
    it.fmu.terminate()
    with pytest.raises(FMICallException):
        it.fmu.doStep(0.01, 0.01)
    it.fmu.reset()
    it.start()
    it.fmu.doStep(0.0, 0.01)


@pytest.mark.parametrize("version", ONE_VERSION)
def test_units_and_dependencies_are_declared(made: Any, version: int) -> None:
    description = fmpy.read_model_description(str(made("planar", version)))
    units = {variable.name: variable.unit for variable in description.modelVariables}
    assert units["q.q1"] == "rad"
    assert units["der(v.q1)"] == "rad/s2"
    assert units["u.q1"] == "N.m"
    assert units["p.tool.x"] == "m"
    outputs = {output.variable.name: output.dependencies for output in description.outputs}
    assert outputs["p.tool.z"] == []  # It moves in the plane.
    assert {variable.name for variable in outputs["p.tool.x"]} >= {"q.q1", "q.'link.bend_y[0]'"}
    assert float(description.defaultExperiment.stepSize) == 0.01  # Ten steps of the unit's own.


def test_places_of_frames_depend_on_what_moves_them_anywhere(made: Any) -> None:
    """On prescribed motions, and on coordinates that move a frame along an axis where those are not zero, too."""
    description = fmpy.read_model_description(str(made("driven", VERSIONS["driven"])))
    prescribed = {v.name for v in description.modelVariables if v.causality == "input"} - {"u.q1"}
    assert len(prescribed) == 9
    for output in description.outputs:
        if output.variable.name.startswith("p."):
            assert {v.name for v in output.dependencies} == prescribed | {"q.q1"}, output.variable.name


def test_a_missing_fmpy_is_reported(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(sf.ExportError, match=r"pip install 'symofros\[fmi\]'"):
        sf.export(REFERENCE["pendulum"], "fmu2", tmp_path)


@pytest.mark.parametrize(
    ("version", "prescribed"),
    [
        (2, True),
        (3, False),
        pytest.param(2, False, marks=pytest.mark.slow),
        pytest.param(3, True, marks=pytest.mark.slow),
    ],
)
def test_models_without_states_or_inputs_become_fmus(tmp_path: Path, version: int, prescribed: bool) -> None:
    body = sf.RigidBody("b", sf.Joint("j", "revolute", prescribed=prescribed), sf.Inertia(1.0, (1, 0, 0), (1, 1, 1)))
    path = str(exported(sf.System("odd", (body,)), version, tmp_path, outputs=[]))
    assert validate_fmu(path) == []
    assert fmpy.simulate_fmu(path, fmi_type="CoSimulation", stop_time=0.01)["time"][-1] == 0.01


@pytest.mark.parametrize("version", ONE_VERSION)
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_beams_beyond_their_theory_are_reported(made: Any, version: int, kind: str) -> None:
    """A warning from 1 % on; beyond the limit a step of Co-Simulation is discarded, and Model Exchange is ended."""
    remarks: dict[float, list[str]] = {}
    ends: dict[float, float] = {}
    for g in (0.2, 0.5, 60.0):
        given = {"stop_time": 1.0, "output_interval": 0.01, "start_values": {"par.g": g}}
        run, log = simulated(str(made("limp", version)), fmi_type=kind, **given)
        ends[g] = math.nan if run is None else float(run["time"][-1])
        remarks[g] = [line for line in log if "second-order theory errs" in line]
    assert not remarks[0.2] and ends[0.2] == pytest.approx(1.0)
    assert len(remarks[0.5]) == 1 and "'blade'" in remarks[0.5][0] and ends[0.5] == pytest.approx(1.0)
    assert remarks[60.0] and not ends[60.0] == pytest.approx(1.0)


@pytest.mark.parametrize("version", ONE_VERSION)
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_logs_report_the_error_of_beam_theory_at_rest(made: Any, version: int, kind: str) -> None:
    """Axial loads count, at the present length."""
    for share, L in ((0.95, 1.0), (0.9, 0.1), (0.8, 1.0), (-5.0, 10.0)):
        model, rest = at_rest(share, L)
        start = {f"par.{name}": value for name, value in model.parameters.items()}
        start |= {f"q.'{name}'": value for name, value in zip(model.names.q, rest.q.tolist(), strict=True)}
        given = {"stop_time": 0.1 * L**2, "output_interval": 0.005 * L**2, "start_values": start}
        run, log = simulated(str(made("column", version)), fmi_type=kind, **given)
        assert run is not None
        stated = [re.search(r"errs by about ([\d.]+) %", line) for line in log if "second-order theory errs" in line]
        wanted = [100.0 * rest.bendings[0].error] if rest.bendings[0].error > 0.01 else []
        assert [float(match[1]) for match in stated if match] == pytest.approx(wanted, rel=0.05)


@pytest.mark.parametrize("scale", [0.0, 2.0, -1e150, 1.0 + 1e-6])
def test_start_quaternions_are_normalised_or_refused(made: Any, scale: float) -> None:
    """A start of another length is refused in words; one of few digits is a rotation."""
    path = str(made("floating", VERSIONS["floating"]))
    start = {name: scale * value for name, value in quaternion_start(path).items()}
    run, log = simulated(path, stop_time=0.01, output_interval=0.005, start_values=start)
    if abs(scale - 1.0) < 1e-3:
        assert len(run) == 3
    else:
        assert run is None and any("no rotation" in line for line in log)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("length", [0.0, 1.01, -1.0])
def test_input_quaternions_are_normalised_or_refused(made: Any, kind: Any, length: float) -> None:
    path = str(made("turned", 3))
    inputs = [v.name for v in fmpy.read_model_description(path).modelVariables if v.causality == "input"]
    (last,) = (name for name in inputs if name.rstrip("'").endswith("qw"))
    run, log = simulated(path, fmi_type=kind, stop_time=0.01, output_interval=0.005, start_values={last: length})
    if length == -1.0:
        assert len(run) == 3
    else:
        assert run is None
        assert any("inputs that prescribe a motion" in line and "no rotation" in line for line in log)


def quaternion_start(path: str) -> dict[str, float]:
    """Start values of the components of quaternions."""
    variables = fmpy.read_model_description(path).modelVariables
    ends = ("qx'", "qy'", "qz'", "qw'")
    return {v.name: float(v.start) for v in variables if v.name.startswith("q.") and v.name.endswith(ends)}


def test_equal_names_of_variables_are_numbered_inside_their_quotes() -> None:
    names = ("'a'", "'b'", "'a'", "'a'")
    variables = [Variable(k, name, "output", "continuous") for k, name in enumerate(names)]
    assert [one.name for one in _distinct(variables)] == ["'a'", "'b'", "'a 1'", "'a 2'"]
    assert [one.reference for one in variables] == [0, 1, 2, 3]
