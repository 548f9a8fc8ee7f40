"""Runs of all methods in C that was compiled with sanitizers: a program of its own, which they end at the first fault.

The sanitizers must be in the process before Python's own memory is: LD_PRELOAD names them (test_sanitizers.py). The
program prints the ends of its runs, for comparison with runs of plain C.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import symofros as sf
from symofros.runtime.calls import binding
from symofros.simulation.stepping.methods import METHODS
from tests.simulation.grasping import PLAN, grabbing

MODELS = Path(__file__).parents[2] / "reference_models"
FIXED = ("euler", "semi_implicit_euler", "rk4", "implicit_euler", "generalized_alpha", "variational")
ADAPTIVE = ("dopri5", "dop853", "rodas4")


def models() -> dict[str, sf.System]:
    """A pendulum with an input, a loop, a condition on speeds, a free body, a beam."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=("F",))
    swing = sf.Joint("q", "revolute", "cart", axis=(0, 1, 0))
    bob = sf.RigidBody("bob", swing, sf.Inertia(1.0, (0, 0, -0.5), (0.1, 0.1, 0.1)))
    tumbling = sf.Inertia(1.0, (0.1, 0, 0), (0.3, 0.2, 0.1))
    beam = sf.Joint("turn", "revolute", axis=(0, 0, 1))
    return {
        "cart": sf.System("cart", [sf.RigidBody("cart", joint, sf.Inertia(2.0)), bob], inputs=[sf.Input("F")]),
        "four_bar": sf.load(MODELS / "closed" / "four_bar.yaml"),
        "sleigh": sf.load(MODELS / "closed" / "sleigh.yaml"),
        "free": sf.System("free", [sf.RigidBody("body", sf.Joint("f", "free"), tumbling)]),
        "beam": sf.System("beam", [sf.Beam("arm", beam, 1.0, 1.0, EI_z=10.0, bend_y=2)], gravity=(0, -9.81, 0)),
    }


def start(m: sf.Model, name: str) -> tuple[np.ndarray, np.ndarray]:
    q, v = m.neutral(), np.linspace(0.5, 1.0, m.nv)
    if not m.nc:
        return q, v
    closed = sf.assemble(m, [1.2, -1.2, 1.2] if name == "four_bar" else q, v)
    return closed.q, closed.v


def runs(options: sf.Options) -> Iterator[tuple[str, np.ndarray]]:
    """Ends of the runs (nq + nv), by model and method; refused combinations are left out."""
    for name, system in models().items():
        m = sf.compile(system, options)
        q, v = start(m, name)
        u = {"F": sf.Signal([0.0, 0.01, 0.02], [1.0, -1.0, 2.0], "hold")} if name == "cart" else None
        crossing = {"passed": sf.Event(f"{m.names.q[0]} - {float(q[0]) + 0.004!r}")}
        for method in (*FIXED, *ADAPTIVE):
            more = {"rtol": 1e-6} if METHODS[method].adaptive else {"dt": 2e-3}
            try:
                run = sf.simulate(m, q, v, 0.03, u=u, method=method, events=crossing, output=0.01, **more)
            except sf.SymofrosError:
                continue
            yield f"{name} {method}", np.concatenate([run.q[-1], run.v[-1]])
        many = np.tile(q, (20, 1)), np.tile(v, (20, 1)) * np.linspace(0.9, 1.0, 20)[:, None]
        for method in ("rk4", "dopri5"):
            batch = sf.simulate_batch(m, *many, 0.02, u=u, method=method, dt=2e-3, threads=2)
            yield f"{name} batch {method}", np.concatenate([batch.q[-1, -1], batch.v[-1, -1]])


def acting(options: sf.Options) -> Iterator[tuple[str, np.ndarray]]:
    """Ends of runs, of a batch, and of motions stepped by hand, whose events grasp, release, set, and strike."""
    m = sf.compile(grabbing("moment"), options)
    q, v = m.neutral(), np.linspace(0.5, 1.0, m.nv)
    many = np.tile(q, (70, 1)), np.tile(v, (70, 1)) * np.linspace(0.9, 1.0, 70)[:, None]
    events = PLAN | {"often": sf.Event("sin(3000*t)"), "light": sf.Event("t - 0.03", action={"m": "m/2"})}
    for method in ("rk4", "generalized_alpha", "dopri5"):
        run = sf.simulate(m, q, v, 0.05, method=method, events=events, dt=2e-3)
        yield f"grasp {method}", np.concatenate([run.q[-1], run.v[-1]])
    for method in ("rk4", "dopri5"):
        batch = sf.simulate_batch(m, *many, 0.05, method=method, events=events, dt=2e-3, threads=2)
        yield f"grasp batch {method}", np.concatenate([batch.q[-1, -1], batch.v[-1, -1]])
    stepper, steppers = sf.Stepper(m, events=events, dt=2e-3), sf.Steppers(m, 70, events=events, dt=2e-3, threads=2)
    stepper.reset(q, v)
    steppers.reset(*many)
    for _ in range(25):
        stepper.step()
        steppers.step()
        stepper.restore(stepper.save())
        steppers.restore(steppers.save())
    yield "grasp hand rk4", np.concatenate([stepper.q, stepper.v])
    yield "grasp hands rk4", np.concatenate([steppers.q[-1], steppers.v[-1]])


if __name__ == "__main__":
    flags = tuple(sys.argv[1:])
    binding._FLAGS = (*binding._FLAGS, *flags)
    sanitized = sf.Options(flags=("-O1", "-g", "-fno-math-errno", *flags))
    for label, end in (*runs(sanitized), *acting(sanitized)):
        print(label.replace(" ", ":"), *map(repr, end.tolist()), flush=True)
