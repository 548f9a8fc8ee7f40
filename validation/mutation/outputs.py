"""Does a fault change any result at all? Values of functions, C text and motions, compared with the sound package's."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

import symofros as sf
from symofros.blocks import ForwardDynamics, PythonBlock
from symofros.tools import METHODS

from ..mechanics.geometry import Array
from ..references import MODELS
from .check_judge import BEAMS, GENERAL, READ, subject

ROUNDING = 1e-11  # Of the largest entry; other orders of the same operations differ by less.
MOTION_ROUNDING = 1e-8  # Of runs, in which rounding grows.
_FUNCTIONS = (
    "mass_matrix",
    "bias",
    "generalized_force",
    "kinetic_energy",
    "potential_energy",
    "inverse_dynamics",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
)
_DERIVED = ("double_pendulum", "friction_arm", "rolling_disc", "four_bar", "spinning_beam", "heavy_top")
_RUNS = {
    "friction_arm": ("euler", "semi_implicit_euler", "rk4", "dopri5", "dop853", "implicit_euler", "rodas4", "cvode"),
    "double_pendulum": ("dopri5", "variational", "generalized_alpha", "cvode_adams"),
    "heavy_top": ("rk4", "variational", "generalized_alpha"),
    "rolling_disc": ("rk4", "rodas4", "generalized_alpha"),
    "four_bar": ("dopri5", "generalized_alpha", "variational", "rodas4", "ida"),
    "flexible_pendulum": ("dopri5", "rodas4", "generalized_alpha"),
    "soft_pendulum": ("rk4", "dop853"),
}
_STARTS = {"four_bar": [1.2, -1.2, 1.2], "rolling_disc": [0.0, 0.0, 0.5, 0.5, 0.5, 0.5, 0.5]}


def record(path: str) -> dict[str, Any]:
    """Write the sound package's outputs to a file."""
    outputs = _outputs()
    np.savez(path, allow_pickle=False, **outputs)
    return {"status": "recorded", "outputs": len(outputs)}


def compare(path: str) -> dict[str, Any]:
    """Compare the outputs of the package that has a fault with the sound ones of a file.

    Returns:
        "status": "same bits", "same text", "rounding" or "changed"; "where": the first output that differs most.
    """
    outputs = _outputs()
    with np.load(path) as sound:
        names = [name for name in sound.files if name != "libraries"]
        differing = [name for name in names if not _same(sound[name], outputs[name])]
        worst = max(((_distance(name, sound[name], outputs[name]), name) for name in differing), default=(0.0, ""))
        same_text = bool(_same(sound["libraries"], outputs["libraries"]))
    if not differing:
        return {"status": "same bits" if same_text else "other text"}
    status = "changed" if worst[0] > 1.0 else "rounding"
    return {"status": status, "where": worst[1], "over_rounding": float(min(worst[0], 1e300))}


def _same(sound: Array, faulty: Array) -> bool:
    return sound.shape == faulty.shape and sound.dtype == faulty.dtype and sound.tobytes() == faulty.tobytes()


def _distance(name: str, sound: Array, faulty: Array) -> float:
    """Largest difference between sound and faulty values, as a multiple of what rounding explains."""
    if sound.shape != faulty.shape or sound.dtype.kind != "f" or faulty.dtype.kind != "f":
        return float("inf")
    if not np.array_equal(np.isfinite(sound), np.isfinite(faulty)):
        return float("inf")
    with np.errstate(all="ignore"):
        largest = float(np.nanmax(np.abs(sound), initial=0.0)) or 1.0
        difference = float(np.nanmax(np.abs(sound - faulty), initial=0.0))
    return difference / largest / (MOTION_ROUNDING if name.startswith("run ") else ROUNDING)


def _outputs() -> dict[str, Array]:
    warnings.simplefilter("ignore")
    loaded: set[str] = set()

    def note(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "ctypes.dlopen" and arguments[0] is not None:
            loaded.add(Path(str(arguments[0])).name)

    sys.addaudithook(note)
    outputs: dict[str, Array] = {}
    for name, work in (*_values(), *_motions(), *_analyses()):
        try:
            outputs[name] = np.asarray(work())
        except Exception as error:
            outputs[name] = np.array(f"{type(error).__name__}: {error}"[:200])
        if outputs[name].dtype == object:
            outputs[name] = np.array(repr(outputs[name])[:200])
    # The name of a library is the digest of its C text and of what it is compiled by.
    outputs["libraries"] = np.array(sorted(loaded))
    return outputs


def _flat(value: Any) -> Array:
    parts = value if isinstance(value, tuple | list) else (value,)
    return np.concatenate([np.asarray(part, float).ravel() for part in parts])


def _random(model: sf.Model, n: int) -> tuple[Array, Array, Array, Array]:
    rng = np.random.default_rng(5)
    q = np.array([model.random_state(rng)[0] for _ in range(n)])
    return q, rng.standard_normal((n, model.nv)), rng.standard_normal((n, model.nv)), rng.standard_normal((n, model.nu))


def _values() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Functions of the interpreted models at two states."""

    def values(system: sf.System, name: str = "") -> Array:
        functions: tuple[str, ...] = _FUNCTIONS if name in _DERIVED else _FUNCTIONS[:7]
        functions += ("constraint_jacobian", "constraint_bias") if system.constraints else ()
        model = sf.compile(system, sf.Options(functions=functions, backend="interpreter"))
        q, v, a, u = _random(model, 2)
        results = []
        for function in functions:
            results.append(_flat(_called(model, function, q, v, a, u)))
        return np.concatenate(results)

    for name in dict.fromkeys((*GENERAL, *BEAMS, *READ["urdf"], *READ["mjcf"])):
        yield f"values {name}", lambda name=name: values(subject(name).system, name)  # type: ignore[misc]
    for order in ("zeroth_order", "first_order", "all"):
        yield f"values loaded beam, {order}", partial(values, _loaded_beam(order))


def _wrench(force: tuple[Any, ...], torque: tuple[Any, ...]) -> dict[str, Any]:
    return {"force": force, "torque": torque}


def _loaded_beam(retain: Literal["zeroth_order", "first_order", "all"]) -> sf.System:
    """A beam with rotary inertia, with forces and moments at a station and along the span."""
    loads = [
        sf.BeamLoad(**_wrench(("u", 1.0, 0.5), (0.3, 0.2, "u")), at=0.4),
        sf.BeamLoad(**_wrench((0.2, "x", 0.1), ("x", 0.4, "u*x")), axes="world"),
    ]
    beam = sf.Beam(
        "beam",
        sf.Joint("q", "ball"),
        length=1.2,
        rhoA=0.7,
        EI_y=30.0,
        EI_z=20.0,
        GJ=15.0,
        rhoJ=0.02,
        rhoI_y=0.01,
        rhoI_z=0.01,
        rotary_inertia=True,
        retain=retain,
        bend_y=2,
        bend_z=2,
        twist=1,
        loads=tuple(loads),
    )
    return sf.System("loaded_beam", bodies=(beam,), inputs=(sf.Input("u"),))


def _called(model: sf.Model, function: str, q: Array, v: Array, a: Array, u: Array) -> Any:
    call = getattr(model, function)
    if function in ("mass_matrix", "potential_energy", "constraint_jacobian"):
        return call(q, u=u)
    if function in ("bias", "kinetic_energy", "constraint_bias"):
        return call(q, v, u=u)
    if function.startswith("inverse_dynamics"):
        return call(q, v, a, u=u)
    return call(q, v, u)


def _motions() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Short runs of compiled models by every method."""

    def run(name: str, **options: Any) -> Array:
        model = sf.compile(MODELS[name])
        q, v = model.random_state(np.random.default_rng(3))[:2]
        if model.nc:
            start = sf.assemble(model, _STARTS[name], 0.3 * np.ones(model.nv))
            q, v = start.q, start.v
        motion = sf.simulate(model, q, v, options.pop("t_end", 0.05), u=[0.1] * model.nu or None, **options)
        bent = [(one.slope, one.twist, one.foreshortening, one.error) for one in motion.bendings]
        return _flat([motion.t, motion.q, motion.v, *bent, len(motion.outcome.notes)])

    for name, methods in _RUNS.items():
        for method in methods:
            options: dict[str, Any] = {"method": method}
            options |= {} if METHODS[method].adaptive else {"dt": 0.005}
            yield f"run {name} {method}", partial(run, name, **options)
    fixed = {"method": "dopri5", "output": 0.01}
    yield "run grid", lambda: run("double_pendulum", **fixed, max_step=0.003)
    yield "run unadapted", lambda: run("double_pendulum", method="dopri5", adaptive=False, dt=0.01, every=2)
    yield "run baumgarte", lambda: run("four_bar", method="rk4", dt=0.005, stabilisation="baumgarte")
    yield "run drifting", lambda: run("four_bar", method="rk4", dt=0.005, stabilisation="none")
    yield "run event", _event
    yield "run batch", _batch
    yield "run diagram", _diagram


def _event() -> Array:
    model = sf.compile(MODELS["double_pendulum"])
    events = {"crossing": sf.Event("q1", "falling", True)}
    motion = sf.simulate(model, [0.3, 0.2], [-1.0, 0.0], 2.0, events=events, method="dopri5")
    return _flat([motion.t, motion.q, motion.v])


def _batch() -> Array:
    model = sf.compile(MODELS["friction_arm"])
    q, v, _, u = _random(model, 6)
    motion = sf.simulate_batch(model, q, v, 0.05, u=u, method="rk4", dt=0.005, output=0.01, threads=2)
    return _flat([motion.q, motion.v])


def _diagram() -> Array:
    diagram = sf.Diagram("pushed")
    diagram.add_model("plant", MODELS["cart_pole"])
    push = PythonBlock(name="law", function=lambda t, _: {"force": [0.3 - t]}, outputs={"force": (1,)}, period=0.02)
    diagram.add(push)
    diagram.add(ForwardDynamics(name="plant", model="plant"), u="law.force")
    run = sf.Simulation(diagram).run(0.1, dt=0.005)
    return _flat([run.t, *(run[name] for name in run)])


def _analyses() -> Iterator[tuple[str, Callable[[], Any]]]:
    def arm() -> sf.Model:
        return sf.compile(MODELS["double_pendulum"])

    def wide() -> Array:
        """A batch that is evaluated by vectors."""
        model = sf.compile(MODELS["friction_arm"])
        q, v, _, u = _random(model, 700)
        return np.concatenate([_flat(model.forward_dynamics(q, v, u)), _flat(model.mass_matrix(q))])

    def loops() -> Array:
        model = sf.compile(MODELS["four_bar"])
        start = sf.assemble(model, [1.2, -1.2, 1.2], [1.0, 0.0, 0.0])
        q, v = start.q, start.v
        return _flat([q, v, *model.constrained_dynamics(q, v, np.zeros(model.nu)), *model.project(q + 0.01, v)])

    def vibrations() -> Array:
        model = sf.compile(MODELS["flexible_pendulum"])
        rest = sf.equilibrium(model)
        vibration = sf.modes(model, rest.q)
        return _flat([rest.q, vibration.frequencies, vibration.damping])

    yield "batch by vectors", wide
    yield "loops", loops
    yield "linearize", lambda: _flat(arm().linearize([0.1, 0.2], [0.3, 0.4], [0.5, 0.6]))
    yield "modes", vibrations
    yield "regressor", lambda: _flat(arm().regressor([0.1, 0.2], [0.3, 0.4], [0.5, 0.6]))
    yield "base parameters", lambda: _flat(sf.base_parameters(arm()).combine)
    yield "state space", lambda: _flat([sf.state_space(arm(), [0.0, 0.0]).A])
