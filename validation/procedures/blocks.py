"""Blocks of the library by what they compute: outputs from recorded inputs by NumPy; inlets, starts, steps by hand."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import symofros as sf
from symofros import blocks

from ..mechanics.geometry import Array
from .scene import Cell, Scene, off

ROUNDING, SAME = 1e-9, 0.5
_TABLE = ((-1.0, -0.2, 0.5, 1.2), (0.3, -0.4, 0.8, 0.1))
_ORDERS = ("xyz", "zyx", "yxz", "zxz", "xyx", "yzy")
_FORMS = ("quaternion", "axis_angle", "rotation_vector", *(f"euler_{order}" for order in _ORDERS))
_KP, _KD = np.array([40.0, 30.0]), np.array([4.0, 3.0])


def _plant(plant: sf.System) -> tuple[sf.Diagram, sf.Model]:
    """A diagram with a mechanism of two joints under a wave, and sources of a scalar and of a vector."""
    d = sf.Diagram("library")
    model = sf.compile(plant)
    d.add_model("plant", plant, start=dict(zip(model.names.q, (0.3, -0.4), strict=True)))
    d.add(blocks.Sine(name="wave", amplitude=1.5, frequency=0.9, phase=0.3))
    d.add(blocks.Sine(name="other", amplitude=0.7, frequency=1.7))
    d.add(blocks.Join(name="pair", count=2), u1="wave.y", u2="other.y")
    d.add(blocks.ForwardDynamics(name="plant", model="plant"), u="pair")
    return d, model


def computed(plant: sf.System) -> Iterator[Cell]:
    """Blocks without a state, at each record.

    Args:
        plant: A mechanism of two hinges that both have inputs.
    """
    d, model = _plant(plant)
    frame = model.names.frames[-1]
    wave, pair = {"u": "wave.y"}, {"u": "pair"}
    d.add(blocks.Gain(name="gain", gain=[[2.0, -1.0], [0.5, 3.0]]), **pair)
    d.add(blocks.Sum(name="sum", signs="+-+"), u1="wave.y", u2="other.y", u3="wave.y")
    d.add(blocks.Product(name="product", operations="**/"), u1="wave.y", u2="other.y", u3="above.y")
    d.add(blocks.Constant(name="above", value=2.5))
    d.add(blocks.Pick(name="pick", entries=[1]), **pair)
    d.add(blocks.Reshape(name="column", shape=(2, 1)), **pair)
    d.add(blocks.DeadZone(name="zone", low=-0.4, high=0.6), **wave)
    d.add(blocks.Quantizer(name="rounded", step=0.25), **wave)
    d.add(blocks.Saturation(name="limited", low=-0.8, high=0.9), **wave)
    d.add(blocks.LookupTable(name="table", x=_TABLE[0], y=_TABLE[1]), **wave)
    d.add(blocks.Switch(name="switch", threshold=0.2), u1="wave.y", u2="other.y", by="other.y")
    d.add(blocks.JointPD(name="pd", kp=_KP, kd=_KD), q_desired="pair", q="plant.q", v="plant.v")
    d.add(blocks.GravityCompensation(name="weight", model="plant"), q="plant.q")
    d.add(blocks.InverseDynamics(name="efforts", model="plant"), q="plant.q", v="plant.v", a="pair")
    law = {"q_desired": "pair", "q": "plant.q", "v": "plant.v"}
    d.add(blocks.ComputedTorque(name="torque", model="plant", kp=_KP, kd=_KD), **law)
    motion = {"q": "plant.q", "v": "plant.v"}
    d.add(blocks.ForwardKinematics(name="tip", model="plant", frame=frame), a="plant.a", **motion)
    d.add(blocks.Jacobian(name="slope", model="plant", frame=frame), **motion)
    d.add(blocks.ModelFunction(name="bias", model="plant", function="bias"), **motion)
    d.add(blocks.FrameTransform(name="there", model="plant", source=frame), q="plant.q", u="tip.p")
    d.add(blocks.Transform(name="back", inverse=True), p="tip.p", R="tip.R", u="there.y")
    for target in _FORMS:
        d.add(blocks.Orientation(name=target, source="matrix", target=target), u="tip.R")
        d.add(blocks.Orientation(name=f"from_{target}", source=target, target="matrix"), u=f"{target}.y")
    d.add(blocks.Constant(name="goal", value=Rotation.from_rotvec([0.4, -0.3, 0.8]).as_matrix()))
    for axes in ("world", "body"):
        d.add(blocks.OrientationError(name=f"error_{axes}", axes=axes), desired="goal.y", actual="tip.R")
    run = sf.Simulation(d).run(0.6, dt=2e-3, record=0.04)
    x, y = (np.asarray(run[name]).ravel() for name in ("wave.y", "other.y"))
    q, v, a, both = (np.asarray(run[name]) for name in ("plant.q", "plant.v", "plant.a", "pair.y"))
    p, R = (np.asarray(run[name]) for name in ("tip.p", "tip.R"))
    wanted_p, wanted_R = model.frame_pose(frame, q)
    turned = Rotation.from_matrix(R)
    goal = Rotation.from_rotvec([0.4, -0.3, 0.8])
    wanted: dict[str, Array] = {
        "plant.a": model.forward_dynamics(q, v, both),
        "gain.y": both @ np.array([[2.0, -1.0], [0.5, 3.0]]).T,
        "sum.y": 2 * x - y,
        "product.y": x * y / 2.5,
        "pick.y": y,
        "column.y": both,
        "zone.y": np.maximum(x - 0.6, 0.0) + np.minimum(x + 0.4, 0.0),
        "rounded.y": 0.25 * np.floor(x / 0.25 + 0.5),
        "limited.y": np.clip(x, -0.8, 0.9),
        "table.y": np.interp(x, *_TABLE),
        "switch.y": np.where(y >= 0.2, x, y),
        "pd.effort": _KP * (both - q) - _KD * v,
        "weight.effort": model.bias(q, 0 * v),
        "efforts.tau": model.inverse_dynamics(q, v, both),
        "torque.tau": model.inverse_dynamics(q, v, _KP * (both - q) - _KD * v),
        "torque.error": both - q,
        "tip.p": wanted_p,
        "tip.R": wanted_R,
        "tip.velocity": model.frame_velocity(frame, q, v),
        "tip.acceleration": model.frame_acceleration(frame, q, v, a),
        "slope.J": model.frame_jacobian(frame, q),
        "bias.h": model.bias(q, v),
        "there.y": p + np.einsum("nij,nj->ni", R, p),
        "back.y": p,
        "there.p": p,
        "error_world.error": (goal * turned.inv()).as_rotvec(),
        "error_body.error": (turned.inv() * goal).as_rotvec(),
        "rotation_vector.y": turned.as_rotvec(),
        **{f"from_{one}.y": R for one in _FORMS},
    }
    for name, value in wanted.items():
        yield Cell(
            f"block {name}", off(np.asarray(run[name]).reshape(len(run.t), -1), value.reshape(len(run.t), -1)), ROUNDING
        )
    quaternions = np.asarray(run["quaternion.y"])
    yield Cell("block quaternion.y", off(Rotation.from_quat(quaternions).as_matrix(), R), ROUNDING)
    for order in _ORDERS:  # About axes that turn, one after the other.
        angles = np.asarray(run[f"euler_{order}.y"])
        yield Cell(f"block euler_{order}.y", off(Rotation.from_euler(order.upper(), angles).as_matrix(), R), ROUNDING)


def timed(_: Scene) -> Iterator[Cell]:
    """Sources by time, and blocks with a state, against closed forms."""
    d = sf.Diagram("timed")
    d.add(blocks.Step(name="step", time=0.3, before=-1.0, after=2.0))
    d.add(blocks.Ramp(name="ramp", time=0.2, slope=3.0, start=0.5, duration=0.4))
    d.add(blocks.Pulse(name="pulse", time=0.1, every=0.3, width=1 / 3, high=2.0, low=-1.0))
    d.add(blocks.Chirp(name="chirp", amplitude=1.2, first=1.0, last=3.0, duration=1.0))
    d.add(blocks.Integrator(name="sum"), u="step.y")
    d.add(blocks.Integrator(name="area"), u="pulse.y")
    d.add(blocks.StateSpace(name="lag", A=[[-2.0]], B=[[3.0]], C=[[0.5]], D=[[0.1]], start=[0.4]), u="ramp.y")
    d.add(blocks.Derivative(name="slope", tau=0.05), u="chirp.y")
    units = _measured(d)
    run = sf.Simulation(d).run(1.0, method="dop853", rtol=1e-10, atol=1e-12, record=0.0371)
    t = run.t
    phase = 2 * math.pi * (t + t**2)
    since = np.mod(t - 0.1, 0.3)
    rising = np.clip(t - 0.2, 0.0, 0.4)
    wanted = {
        "step.y": np.where(t >= 0.3, 2.0, -1.0),
        "ramp.y": 0.5 + 3.0 * rising,
        "pulse.y": np.where((t >= 0.1) & (since < 0.1), 2.0, -1.0),
        "chirp.y": 1.2 * np.sin(phase),
        "chirp.frequency": 1.0 + 2.0 * t,
        "sum.y": -np.minimum(t, 0.3) + 2.0 * np.maximum(t - 0.3, 0.0),
        "area.y": -t + 3.0 * _on(t),
        "lag.y": 0.5 * _lag(t) + 0.1 * (0.5 + 3.0 * rising),
    }
    for name, value in wanted.items():
        yield Cell(f"block {name}", off(np.asarray(run[name]).ravel(), value), 1e-7)
    wrong = [f"{name} in {run.unit(name)}" for name, unit in units.items() if run.unit(name) != unit]
    yield Cell("units of coordinates and speeds", float(len(wrong)), SAME, ", ".join(wrong))


def _measured(d: sf.Diagram) -> dict[str, str]:
    """Add bodies on a free joint, a ball, a plane and a slide, one picked entry of their motion a block; its units."""
    kinds = {"free": ("m",) * 3 + ("1",) * 4, "ball": ("1",) * 4, "planar": ("m", "m", "rad"), "prismatic": ("m",)}
    speeds = {"free": ("m",) * 3 + ("rad",) * 3, "ball": ("rad",) * 3, "planar": kinds["planar"], "prismatic": ("m",)}
    bodies = [sf.RigidBody(kind, sf.Joint(f"j_{kind}", kind), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))) for kind in kinds]  # type: ignore[arg-type]
    d.add_model("bodies", sf.System("bodies", tuple(bodies), gravity=(0, 0, 0)))
    d.add(blocks.ForwardDynamics(name="bodies", model="bodies"))
    units = {f"q{i}.y": unit for i, unit in enumerate(chain.from_iterable(kinds.values()))}
    units |= {f"v{i}.y": f"{unit}/s" for i, unit in enumerate(chain.from_iterable(speeds.values()))}
    for name in units:
        entry = name.removesuffix(".y")
        d.add(blocks.Pick(name=entry, entries=[int(entry[1:])]), u=f"bodies.{entry[0]}")
    return units


def _on(t: Array) -> Array:
    """Time for which the pulse was high."""
    begins = 0.1 + 0.3 * np.arange(4)
    return np.asarray(np.clip(t[:, None] - begins, 0.0, 0.1).sum(axis=1))


def _lag(t: Array) -> Array:
    """Solve x' = -2 x + 3 u from 0.4 for the ramp: on each of its three parts, by its closed form."""

    def part(x0: float, u0: float, slope: float, s: Array) -> Array:
        held = 1.5 * u0 - 0.75 * slope
        return np.asarray((x0 - held) * np.exp(-2 * s) + held + 1.5 * slope * s)

    first = float(part(0.4, 0.5, 0.0, np.array(0.2)))
    second = float(part(first, 0.5, 3.0, np.array(0.4)))
    pieces = [part(0.4, 0.5, 0.0, t), part(first, 0.5, 3.0, t - 0.2), part(second, 1.7, 0.0, t - 0.6)]
    return np.asarray(np.select([t < 0.2, t < 0.6], pieces[:2], pieces[2]))


def fed(plant: sf.System) -> Iterator[Cell]:
    """Inlets by numbers, formulas, samples that hold and lines; steps by hand; parameters of blocks.

    Args:
        plant: A mechanism of two hinges that both have inputs.
    """
    d, _ = _plant(plant)
    for name in ("held", "lines", "formula", "number", "both"):
        d.add(blocks.Integrator(name=name))
        d.add_inlet(f"to_{name}", f"{name}.u", shape=(2,) if name == "both" else ())
    d.add(blocks.Gain(name="gain", gain=2.0), u="held")
    t = np.array([0.0, 0.1, 0.25, 0.4])
    values = np.array([1.0, -2.0, 3.0, 0.5])
    inputs: dict[str, Any] = {
        "to_held": sf.Signal(t, values, "hold"),
        "to_lines": sf.Signal(t, values),
        "to_formula": "3*t^2",
        "to_number": 0.7,
        "to_both": ["t", "1 - t"],
    }
    simulation = sf.Simulation(d)
    options: dict[str, Any] = {"dt": 1e-3, "method": "rk4", "inputs": inputs}
    run = simulation.run(0.35, record=0.05, **options)
    at = run.t
    wanted = {
        "held.y": np.array([_area(t, values, one, hold=True) for one in at]),
        "lines.y": np.array([_area(t, values, one, hold=False) for one in at]),
        "formula.y": at**3,
        "number.y": 0.7 * at,
        "both.y": np.c_[at**2 / 2, at - at**2 / 2],
    }
    for name, value in wanted.items():
        yield Cell(f"inlets, {name}", off(np.asarray(run[name]).reshape(value.shape), value), 1e-9)
    names = ("plant.q", "plant.v", "held.y", "both.y", "gain.y")
    tuned = {"gain.gain": -3.0}
    other = simulation.run(0.35, record=0.05, parameters=tuned, **options)
    stepper = simulation.stepper(output=0.05, **options)
    stepper.step(steps=3)
    stepper.reset()
    differing = 0
    for k in range(1, 8):
        stepper.step()
        differing += sum(int(np.sum(np.asarray(stepper[name]) != np.asarray(run[name])[k])) for name in names)
    made = stepper.trajectory()
    differing += sum(int(np.sum(np.asarray(made[name])[-1] != np.asarray(run[name])[-1])) for name in names)
    yield Cell("a diagram stepped by hand", float(differing), SAME, "entries of other bits")
    yield Cell("parameters of blocks", off(np.asarray(other["gain.y"]), -1.5 * np.asarray(run["gain.y"])), 1e-12)


def _area(t: Array, values: Array, end: float, hold: bool) -> float:
    fine = np.union1d(t[t < end], [end])
    if hold:
        return float(np.sum(np.diff(fine) * values[: len(fine) - 1]))
    return float(np.trapezoid(np.interp(fine, t, values), fine))


def begun(scene: Scene) -> Iterator[Cell]:
    """A loop in a diagram begins on its conditions with what its start states, and notes what it took otherwise."""
    model, names = scene.model, scene.model.names
    rate, angle = 0.7, float(scene.q[0])
    d = sf.Diagram("loop")
    d.add_model("plant", scene.system, start={names.q[0]: angle, f"d{names.v[1]}": rate})
    d.add(blocks.ForwardDynamics(name="plant", model="plant"))
    run = sf.Simulation(d).run(0.02, dt=1e-3, record=0.01)
    q, v = np.asarray(run["plant.q"]), np.asarray(run["plant.v"])
    gap = max(float(np.abs(model.constraint(q[0])).max()), float(np.abs(model.constraint_rate(q[0], v[0])).max()))
    kept = abs(q[0, 0] - angle) + abs(v[0, 1] - rate)
    yield Cell("a loop in a diagram: start", gap + kept, 1e-9)
    plain = sf.simulate(model, q[0], v[0], 0.02, dt=1e-3, method=run.cost.method)
    yield Cell("a loop in a diagram: motion", max(off(q[-1], plain.q[-1]), off(v[-1], plain.v[-1])), 1e-9)

    stated = {name: float(x) for name, x in zip(names.q, q[0], strict=True)}
    stated |= {f"d{name}": float(x) for name, x in zip(names.v, v[0], strict=True)}
    yield _noted("a loop in a diagram", scene.system, stated)
    motion = stated.pop(names.q[0]), stated.pop(f"d{names.v[0]}")
    first, *others = scene.system.bodies
    assert first.joint is not None
    drive = replace(first, joint=replace(first.joint, prescribed=True))
    yield _noted("a driven loop in a diagram", replace(scene.system, bodies=(drive, *others)), stated, motion)


def _noted(name: str, system: sf.System, exact: Mapping[str, float], motion: tuple[float, float] | None = None) -> Cell:
    """What is noted of a start that was stated to four digits: each coordinate and speed that changed, by its value."""
    rounded = {name: round(x, 4) for name, x in exact.items()}
    rounded[list(rounded)[-2]] += 2e-5
    d = sf.Diagram("loop")
    d.add_model("plant", system, start=rounded)
    d.add(blocks.ForwardDynamics(name="plant", model="plant"), **({"u": "drive.y"} if motion else {}))
    if motion:
        at, rate = motion
        d.add(blocks.Ramp(name="drive", slope=[rate, 0.0, 0.0], start=[at, rate, 0.0]))
    run, names = sf.Simulation(d).run(0.02, dt=1e-3, record=0.01), sf.compile(system).names
    found = dict(zip(names.q, np.asarray(run["plant.q"])[0], strict=True))
    found |= {f"d{name}": x for name, x in zip(names.v, np.asarray(run["plant.v"])[0], strict=True)}
    notes = (re.search(r"start: (\S+) = \S+ was taken as (\S+),", note) for note in run.outcome.notes)
    stated = {note[1]: float(note[2]) for note in notes if note}
    moved = {name for name, x in found.items() if abs(x - rounded[name]) > 1e-6}
    error = max((abs(stated[name] - found[name]) for name in moved & stated.keys()), default=0.0)
    return Cell(f"{name}: what is said of its start", error + len(moved ^ stated.keys()), 1e-5)
