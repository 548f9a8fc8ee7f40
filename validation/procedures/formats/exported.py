"""Exports where their tools are: a package of C built by the system's compiler, FMUs run by FMPy, CasADi."""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from importlib import import_module, util
from pathlib import Path
from typing import Any, Literal

import numpy as np

import symofros as sf
from symofros.tools import find_toolchain

from ...mechanics.geometry import Array
from ..equations.analyses import DIFFERENCED
from ..scene import Cell, Scene, derivative, off

T_END, STEP = 0.1, 1e-3
# The same steps in the same order; compiled with other flags, products are rounded otherwise.
SAME = 1e-10
# CVODE at 1e-9, through a few hundred steps.
CHOSEN = 1e-6


def packages(scene: Scene) -> Iterator[Cell]:
    """What an exported model ends at is what a run of ours does."""
    model = scene.model
    start = dict(zip(model.names.q, map(float, scene.q), strict=True))
    start |= {f"d{name}": float(x) for name, x in zip(model.names.v, scene.v, strict=True)}
    run = sf.simulate(model, scene.q, scene.v, T_END, method="rk4", dt=STEP)
    wanted = np.r_[run.q[-1], run.v[-1]]
    with tempfile.TemporaryDirectory() as folder:
        sf.export(scene.system, "c", folder, start=start, method="rk4", dt=STEP)
        yield Cell("a package of C", off(_by_c(Path(folder)), wanted), SAME)
    if util.find_spec("fmpy") is None:
        yield Cell("FMUs", 0.0, SAME, absent="FMPy runs FMUs; pip install fmpy")
        return
    targets: tuple[Literal["fmu2", "fmu3"], ...] = ("fmu2", "fmu3")
    for target in targets:
        with tempfile.TemporaryDirectory() as folder:
            unit = sf.export(scene.system, target, folder, start=start, method="rk4", dt=STEP).files[0]
            yield Cell(f"{target}, derivatives", _misdirected(unit, target, Path(folder, "unit")), 1e-6)
            for kind, tolerance in (("CoSimulation", SAME), ("ModelExchange", CHOSEN)):
                yield Cell(f"{target}, {kind}", off(_by_fmpy(str(unit), kind, model), wanted), tolerance)


def _by_c(folder: Path) -> Array:
    """The last state (nq + nv) that the example of a package prints."""
    said = printed(folder, str(T_END), str(STEP), "--fast")
    lines = {words[0]: words[1:] for line in said.splitlines() if (words := line.split())}
    return np.array([float(x) for key in ("q", "v") for x in lines[key]])


def printed(folder: Path, *arguments: str) -> str:
    """What the program of a package's sources prints."""
    compiler = find_toolchain()
    assert compiler is not None  # Models were compiled by it.
    files = sorted(path.name for path in folder.glob("*.c"))
    command = [*compiler.command, "-O0", "-std=c99", "-I.", *files, "-lm", "-o", "program"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    done = subprocess.run(["./program", *arguments], cwd=folder, check=True, capture_output=True, text=True)
    return done.stdout


def _misdirected(unit: Path, target: str, folder: Path) -> float:
    """Largest error of directional derivatives of a unit's rates and outputs, against differences of its answers."""
    fmpy, version = import_module("fmpy"), int(target[-1])
    fmpy.extract(str(unit), str(folder))
    description = fmpy.read_model_description(str(unit))
    kind = getattr(import_module(f"fmpy.fmi{version}"), f"FMU{version}Model")
    it = kind(
        guid=description.guid,
        unzipDirectory=str(folder),
        instanceName="unit",
        modelIdentifier=description.modelExchange.modelIdentifier,
    )
    it.instantiate()
    if version == 2:
        it.setupExperiment(startTime=0.0)
    it.enterInitializationMode()
    it.exitInitializationMode()
    it.newDiscreteStates() if version == 2 else it.updateDiscreteStates()
    it.enterContinuousTimeMode()
    places = {one.name: one.valueReference for one in description.modelVariables}
    read, write = (it.getReal, it.setReal) if version == 2 else (it.getFloat64, it.setFloat64)
    known = [[places[name] for name in places if name.startswith(group)] for group in (("q.", "v."), "u.")]
    unknown = [places[name] for name in places if name.startswith(("der(", "p."))]
    rng = np.random.default_rng(22)
    x, u = (np.array(read(some)) if some else np.zeros(0) for some in known)
    x = x + 0.1 * rng.standard_normal(len(x))
    dx, du = rng.standard_normal(len(x)), rng.standard_normal(len(u))

    def answers(h: float) -> Array:
        moved = x + h * dx
        it.setContinuousStates((ctypes.c_double * len(x))(*moved), len(x))
        for place, value in zip(known[1], u + h * du, strict=True):
            write([place], [value])
        return np.array(read(unknown))

    h = 1e-6
    wanted = (answers(h) - answers(-h)) / (2 * h)
    answers(0.0)
    found = np.array(it.getDirectionalDerivative(unknown, known[0] + known[1], [*dx, *du]))
    it.terminate()
    it.freeInstance()
    return off(found, wanted)


def planned(_: Scene) -> Iterator[Cell]:
    """A plan of events with actions in a package of C and in units: the same as in a run."""
    ball = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(sf.formula("m")))
    system = sf.System("bouncing", (ball,), (sf.Parameter("m", 2.0),), gravity=(0, 0, -10))
    events = {
        "floor": sf.Event("z", "falling", action={"dz": "-0.5*dz", "m": "m/2"}),
        "top": sf.Event("dz", "falling", once=True, action={"dz": 0.5}),
    }
    start = {"z": 0.8}
    model = sf.compile(system, sf.Options(backend="tape"))
    run = sf.simulate(model, [0.8], t_end=0.9, events=events, dt=STEP, method="rk4")
    wanted = np.r_[run.q[-1], run.v[-1]]
    with tempfile.TemporaryDirectory() as folder:
        sf.export(system, "c", folder, start=start, method="rk4", dt=STEP, events=events)
        said = printed(Path(folder), "0.9", str(STEP), "--fast")
        lines = {words[0]: words[1:] for line in said.splitlines() if (words := line.split())}
        found = np.array([float(lines[key][0]) for key in ("q", "v")])
        yield Cell("events in a package of C", off(found, wanted), 1e-8)
    if util.find_spec("fmpy") is None:
        yield Cell("events in FMUs", 0.0, SAME, absent="FMPy runs FMUs; pip install fmpy")
        return
    with tempfile.TemporaryDirectory() as folder:
        unit = sf.export(system, "fmu3", folder, start=start, method="rk4", dt=STEP, events=events).files[0]
        simulate = import_module("fmpy").simulate_fmu
        done = simulate(str(unit), fmi_type="CoSimulation", stop_time=0.9, output_interval=0.01)
        yield Cell("events in an FMU", off(np.array([done["q.z"][-1], done["v.z"][-1]]), wanted), 1e-8)


def _by_fmpy(unit: str, kind: str, model: sf.Model) -> Array:
    """The last state (nq + nv) of a unit's run."""
    given = {"relative_tolerance": 1e-9} if kind == "ModelExchange" else {}
    simulate = import_module("fmpy").simulate_fmu
    found = simulate(unit, fmi_type=kind, stop_time=T_END, output_interval=0.01, **given)
    names = [name for group in ("q.", "v.") for name in found.dtype.names if name.startswith(group)]
    assert len(names) == model.nq + model.nv
    return np.array([float(found[name][-1]) for name in names])


def in_casadi(scene: Scene) -> Iterator[Cell]:
    """Functions of CasADi and their Jacobians, its own rules around our C, against those of the model."""
    if util.find_spec("casadi") is None:
        yield Cell("CasADi", 0.0, SAME, absent="pip install 'symofros[casadi]'")
        return
    casadi, model = import_module("casadi"), scene.model
    dynamics = import_module("symofros.interop.casadi").Dynamics(scene.system, model.names.frames[-1:])
    q, v, u = scene.q, scene.v, scene.law(0.0, scene.q, scene.v)
    given = casadi.MX.sym("q", model.nq), casadi.MX.sym("v", model.nv)

    def answers(expression: Callable[[Any, Any], Any]) -> tuple[Array, Array]:
        """A function and its derivative along the rates of both, by CasADi."""
        value = expression(*given)
        rates = dynamics.coordinate_rates(*given), u_rate
        slope = sum(casadi.jtimes(value, x, rate) for x, rate in zip(given, rates, strict=True))
        both = casadi.Function("f", [*given], [value, slope])(q, v)
        return np.asarray(both[0]).ravel(), np.asarray(both[1]).ravel()

    u_rate = np.linspace(0.4, -0.3, model.nv)
    asked: dict[str, tuple[Callable[[Any, Any], Any], Callable[[Array, Array], Any]]] = {
        "forward dynamics": (
            lambda x, w: dynamics.forward_dynamics(x, w, u),
            lambda x, w: model.forward_dynamics(x, w, u),
        ),
        "inverse dynamics": (
            lambda x, w: dynamics.inverse_dynamics(x, w, u_rate),
            lambda x, w: model.inverse_dynamics(x, w, u_rate),
        ),
        "place of a frame": (
            lambda x, _: dynamics.frame_position(model.names.frames[-1], x),
            lambda x, _: model.frame_pose(model.names.frames[-1], x)[0],
        ),
        "integrate": (lambda x, w: dynamics.integrate(x, w), lambda x, w: model.integrate(x, w)),
        "difference": (
            lambda x, w: dynamics.difference(q, dynamics.integrate(x, 0.3 * w)),
            lambda x, w: model.difference(q, model.integrate(x, 0.3 * w)),
        ),
    }
    frame, twice = model.names.frames[-1], np.linspace(-0.5, 0.5, 3)
    place = casadi.Function("p", [given[0]], [casadi.dot(dynamics.frame_position(frame, given[0]), twice)])
    gradient = casadi.Function("g", [given[0]], [casadi.gradient(place(given[0]), given[0])])
    H = np.asarray(casadi.Function("H", [given[0]], [casadi.hessian(place(given[0]), given[0])[0]])(q))
    by_steps = derivative(lambda x: np.asarray(gradient(x)).ravel(), q)
    yield Cell("CasADi, place of a frame: Hessian", off(H, by_steps), DIFFERENCED)
    for name, (theirs, ours) in asked.items():
        value, slope = answers(theirs)

        def along(s: Array, ours: Callable[[Array, Array], Any] = ours) -> Array:
            return np.asarray(ours(scene.manifold.retract(q, s[0] * v), v + s[0] * u_rate))

        yield Cell(f"CasADi, {name}", off(value, np.asarray(ours(q, v))), SAME)
        yield Cell(f"CasADi, {name}: derivative", off(slope, derivative(along, np.zeros(1))[:, 0]), DIFFERENCED)
