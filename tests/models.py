"""The models that identities are tested on: random trees, and reference models with what trees do not have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.closed.spatial import delta_guess, stewart_guess
from reference_models.rigid.random_tree import KINDS, MORE_KINDS, random_tree
from symofros.simulation.stepping.methods import METHODS

TREES = {f"tree{seed}": seed for seed in range(8)}
TREES |= {f"parametrised{seed}": seed for seed in range(3)}
TREES |= {f"joints{seed}": 100 + seed for seed in range(8)}
# Every reference model of rigid bodies in tree topology.
REFERENCES = (
    "pendulum",
    "double_pendulum",
    "cart_pole",
    "rx90",
    "open_chain_5r",
    "space_arm",
    "chain7",
    "chain22",
    "torque_free_body",
    "heavy_top",
    "gyroscope",
    "puma560",
    "stanford_arm",
    "friction_arm",
    "joint_zoo",
    "car",
    "ssrms",
    "spdm",
    "mss",
    "random_tree1",
    "random_tree4",
    "random_tree70",
)
CASES = (*TREES, *REFERENCES)
# What every run takes of them: each kind of joint, branches, rotors, friction, numbers and parameters, one long chain.
SAMPLE = (
    "tree2",  # Branches; revolute, continuous, prismatic, ball.
    "parametrised1",  # Parameters; free joints below others, continuous, fixed.
    "joints2",  # Universal, screw, cylindrical in branches.
    "joints7",  # Planar and general ones.
    "double_pendulum",
    "space_arm",
    "chain7",
    "heavy_top",
    "gyroscope",
    "friction_arm",
    "joint_zoo",
)


def _with_motors(joint: sf.Joint, *others: sf.Rotor) -> sf.System:
    """A body on a joint with motors, another on it, and an arm that may carry both.

    Args:
        joint: Joint with motors.
        others: Rotors that a hinge drives; with them, the arm's joint has an armature.
    """
    solid = sf.Inertia(1.3, (0.1, -0.2, 0.3), (0.5, 0.6, 0.7, 0.01, -0.02, 0.03))
    shoulder = sf.Joint("shoulder", "revolute", axis=(0, 1, 0), armature=0.3 if others else 0.0)
    hinge = sf.Joint("hinge", "revolute", "driven", position=(0.2, 0.1, 0.3), axis=(0, 0, 1), rotors=others)
    bodies = (sf.RigidBody("arm", shoulder, solid), sf.RigidBody("driven", joint, solid))
    return sf.System("motors", (*bodies, sf.RigidBody("last", hinge, solid)))


# Motors that ball and free joints drive: M has their spin, and h does not turn it with the axes. One spins in a link
# that moves; the last two stand beside motors of other joints, whose spin h does turn.
MOTORS = {
    "free armature": _with_motors(sf.Joint("base", "free", armature=0.5)),
    "ball rotor": _with_motors(sf.Joint("base", "ball", rotors=(sf.Rotor(0.4, 3.0, (1.0, 0.0, 0.0)),))),
    "rotor in a link": _with_motors(
        sf.Joint("wrist", "ball", "arm", position=(0.3, 0.1, 0.2), rotors=(sf.Rotor(0.4, 3.0, (0.6, 0.0, 0.8), "arm"),))
    ),
    "free armature beside others": _with_motors(
        sf.Joint("base", "free", armature=0.5), sf.Rotor(0.2, 5.0, (0.6, 0.8, 0.0), "driven")
    ),
    "ball rotor beside others": _with_motors(
        sf.Joint("wrist", "ball", "arm", rotors=(sf.Rotor(0.4, 3.0, (0.6, 0.0, 0.8), "arm"),)),
        sf.Rotor(0.2, 5.0, (0.6, 0.8, 0.0), "last"),
    ),
}

# Mechanisms with constraints -> where to begin with closing their loops.
GUESSES = {
    "four_bar": [1.2, -1.2, 1.2],
    "slider_crank": [0.5, -0.7, 0.4],
    "parallelogram": [1.0, -1.0, 1.0, 1.0],
    "bricard": [0.0] * 5,
    "stewart": stewart_guess(),
    "delta": delta_guess(),
    "rolling_disc": [0, 0, 0.5, 0.5, 0.5, 0.5, 0.5],
    "sleigh": [0.1, 0.2, 0.3],
}


def sampled(cases: Sequence[Any], chosen: Sequence[Any] = SAMPLE) -> list[Any]:
    """The cases of a parametrisation: those that are chosen in every run, the others with --slow."""
    assert set(chosen) <= set(cases), "chosen from elsewhere"
    return [case if case in chosen else pytest.param(case, marks=pytest.mark.slow) for case in cases]


@cache
def system(case: str) -> sf.System:
    """A random tree by its name in TREES, or a reference model."""
    if case not in TREES:
        return MODELS[case]
    tree = random_tree(TREES[case], kinds=MORE_KINDS if case.startswith("joints") else KINDS)
    return parametrised(tree) if case.startswith("parametrised") else tree


def state_of(m: sf.Model, start: Any, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A random state, on the constraints near a start where one is given, and inputs: q, v, u."""
    rng = np.random.default_rng(seed)
    q, v = m.random_state(rng)
    if start is not None:
        at = sf.assemble(m, start, rng.normal(size=m.nv))
        q, v = at.q, at.v
    return q, v, rng.normal(size=m.nu)


@cache
def model(case: str, backend: str = "interpreter") -> sf.Model:
    """The model of a case; the interpreter is the default because identities don't need speed."""
    return sf.compile(system(case), sf.Options(backend=backend))


@cache
def compiled(name: str) -> sf.Model:
    """A reference model as C, once in a process: it does not change."""
    return sf.compile(MODELS[name])


def bounds(method: str, rtol: float, atol: float) -> dict[str, Any]:
    """Bounds of errors as options of an adaptive method; none of one of fixed steps, which refuses them."""
    return {"rtol": rtol, "atol": atol} if METHODS[method].adaptive else {}


def interpreted(system: sf.System) -> sf.Model:
    return sf.compile(system, sf.Options(backend="interpreter"))


def parametrised(system: sf.System) -> sf.System:
    """The same mechanism with masses, positions and moments as run-time parameters."""
    parameters: list[sf.Parameter] = []

    def named(value: object) -> str:
        parameters.append(sf.Parameter(f"p{len(parameters)}", float(value)))  # type: ignore[arg-type]
        return parameters[-1].name

    bodies = []
    for body in system.bodies:
        inertia = body.inertia
        if inertia is not None:
            mass, center = named(inertia.mass), tuple(map(named, inertia.center_of_mass))
            inertia = replace(inertia, mass=mass, center_of_mass=center, moments=tuple(map(named, inertia.moments)))
        joint = body.joint and replace(body.joint, position=tuple(map(named, body.joint.position)))
        bodies.append(replace(body, joint=joint, inertia=inertia))
    return replace(system, bodies=tuple(bodies), parameters=tuple(parameters))
