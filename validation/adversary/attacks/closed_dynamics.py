"""Forward dynamics under constraints, in both forms, against the same equations solved with fifty digits."""

from __future__ import annotations

import math
from functools import cache
from typing import Any, Literal

import mpmath
import numpy as np
from hypothesis import strategies as st

import symofros as sf
from symofros.tools import evaluate_precisely

from ...mechanics.geometry import Array
from ..attack import Attack, Mechanism, Scene, Verdict, along, compared, decades, inertia, refused

DIGITS = 50
# Rounding errors in units of the bound by the condition of each component: six digits are left to the growth of errors
# in elimination; what drops a condition, or forgets a light body, loses all sixteen.
ROUNDINGS = 1e6 * float(np.finfo(float).eps)
# Of those roundings, the share that entries of G bear: each is a sum of arms of the mechanism's size, rounded to a
# hundred units of the last digit, and the arms may cancel: a wheel at its dead centre has 1e-17 L instead of 0.
ENTRIES = 1e-4
# Smallest over largest singular value of G, in units of the mechanism, above which no row repeats another.
INDEPENDENT = 1e-3
# A state within this deviation from its constraints, over L, counts as one that has drifted (constraints.md, (11a)).
# What is left there of a row that repeats others on them is of the order of the deviation: up to twice that much can't
# be distinguished from a condition of its own.
DRIFTED, LEFT = 2e-3, 2.0
Form = Literal["multipliers", "null_space"]
_FUNCTIONS = ("mass_matrix", "bias", "generalized_force", "constraint_jacobian", "constraint_bias")
_PARAMETERS = tuple(sf.Parameter(name, 1.0) for name in ("L", "m1", "m2", "m3", "J"))


def _bar(name: str, joint: sf.Joint, mass: str, more: str = "0") -> sf.RigidBody:
    j = f"{mass}*L^2/12 + {more}"
    mass_properties = inertia(mass, ("L/2", 0, 0), (j, j, j))
    return sf.RigidBody(name, joint, mass_properties, (sf.Frame("end", along("L")),))


def four_bar() -> sf.System:
    """Three bars of one length on a ground as long as they are; a flywheel turns with the crank."""
    axis = (0, -1, 0)
    bodies = (
        _bar("crank", sf.Joint("q1", "revolute", axis=axis), "m1", "J"),
        _bar("coupler", sf.Joint("q2", "revolute", "crank", "end", axis=axis), "m2"),
        _bar("rocker", sf.Joint("q3", "revolute", position=along("L"), axis=axis), "m3"),
    )
    loop = sf.Closure("loop", ("rocker", "end"), ("coupler", "end"), ("x", "z"))
    return sf.System("four_bar", bodies, _PARAMETERS, constraints=(loop,))


def held() -> sf.System:
    """A mass held along z, a light wheel held by a rod to a slider: rows of very different sizes."""
    rim = (sf.Frame("rim", along("L")),)
    bodies = (
        sf.RigidBody(
            "weight",
            sf.Joint("p", "planar", rotation=sf.Rotation.rpy(np.pi / 2, 0, 0)),
            inertia("m1", (0, 0, 0), ("J", "J", "J")),
        ),
        sf.RigidBody(
            "wheel", sf.Joint("q", "revolute", axis=(0, -1, 0)), inertia("m2", (0, 0, 0), ("J", "J", "J")), rim
        ),
        sf.RigidBody("slider", sf.Joint("x", "prismatic", axis=(1, 0, 0)), inertia("m3")),
    )
    ties = (
        sf.Closure("hold", ("world", None), ("weight", None), ("z",)),
        sf.Rod("rod", ("wheel", "rim"), ("slider", None), sf.formula("2*L")),
    )
    return sf.System("held", bodies, _PARAMETERS, constraints=ties)


def sleigh() -> sf.System:
    """A body on an edge, with a mass that slides across it."""
    pose = sf.Joint("pose", "planar")
    body = inertia("m1", ("L", 0, 0), ("J", "J", "J"))
    bodies = (
        sf.RigidBody("body", pose, body, (sf.Frame("edge", along("-L")),)),
        sf.RigidBody("mass", sf.Joint("s", "prismatic", "body", axis=(0, 1, 0)), inertia("m2")),
        sf.RigidBody("ballast", sf.Joint("r", "revolute", "mass"), inertia("m3", ("L", 0, 0), ("J", "J", "J"))),
    )
    return sf.System(
        "sleigh", bodies, _PARAMETERS, gravity=(0, -9.81, 0), constraints=(sf.KnifeEdge("edge", ("body", "edge")),)
    )


_SYSTEMS = {"four_bar": four_bar, "held": held, "sleigh": sleigh}
_angles = st.one_of(
    st.sampled_from([0.5, 0.0, np.pi / 2, np.pi]),
    st.builds(lambda a, e: a + e, st.sampled_from([0.0, np.pi / 2, np.pi]), decades(-9, -1)),
)
_scenes = st.fixed_dictionaries(
    {
        "mechanism": st.sampled_from(sorted(_SYSTEMS)),
        "form": st.sampled_from(["multipliers", "null_space"]),
        "L": decades(-6, 6),
        "m1": decades(-9, 9),
        "m2": decades(-9, 9),
        "m3": decades(-9, 9),
        # Over m2 L^2.
        "J": decades(-6, 3),
        "angles": st.lists(_angles, min_size=6, max_size=6),
        "speed": decades(-3, 3),
    }
)


@cache
def mechanism(name: str, form: Form) -> Mechanism:
    """One of them, in one form."""
    return Mechanism(_SYSTEMS[name](), sf.Options(("forward_dynamics",), constraints=form))


@cache
def _program(name: str) -> Any:
    return sf.program_of(_SYSTEMS[name](), _FUNCTIONS)


def _values(scene: Scene) -> dict[str, float]:
    sizes = {name: float(scene[name]) for name in ("L", "m1", "m2", "m3")}
    return sizes | {"J": scene["J"] * scene["m2"] * scene["L"] ** 2}


def state(scene: Scene, model: sf.Model) -> tuple[Array, Array]:
    """Q and v; loops need not be closed for the equations of accelerations to hold."""
    lengths = _sizes(model, scene)
    q = lengths * np.array(scene["angles"][: model.nq])
    signs = np.where(np.arange(model.nv) % 2, -0.7, 1.0)
    return q, scene["speed"] * lengths * signs


_LENGTHS = ("p.x", "p.y", "pose.x", "pose.y", "s", "x")


def _sizes(model: sf.Model, scene: Scene) -> Array:
    """Size of each coordinate."""
    return np.array([scene["L"] if name in _LENGTHS else 1.0 for name in model.names.q])


def judge(scene: Scene) -> Verdict:
    """Accelerations of one form against the solution with many digits, by a componentwise bound."""
    one, values = mechanism(scene["mechanism"], scene["form"]), _values(scene)
    model, par = one.model, one.par(**values)
    q, v = state(scene, model)
    a, _, rank = model.constrained_dynamics(q, v, np.zeros(model.nu), par=par)
    if int(rank) < 0:
        return refused("the state has no acceleration: rank -1")
    program = _program(scene["mechanism"])
    inputs: dict[str, Any] = {"q": q, "v": v, "u": np.zeros(model.nu), "par": par, "t": [0.0]}
    numbers = {f.name: evaluate_precisely(program, f, inputs, DIGITS)[0] for f in program.functions}
    nv, nc = model.nv, model.nc
    with mpmath.workdps(DIGITS):
        M, G = _matrix(numbers["mass_matrix"], nv), _matrix(numbers["constraint_jacobian"], nv)
        b = [Q - h for Q, h in zip(numbers["generalized_force"], numbers["bias"], strict=True)]
        b += numbers["constraint_bias"]
        independent = _independence(_doubles(G), _sizes(model, scene), scene["L"])
        if int(rank) < nc:
            claim = f"rank {int(rank)} of {nc} conditions"
            gap = float(np.abs(model.constraint(q, par=par)).max()) / scene["L"]
            allowed = max(INDEPENDENT, LEFT * gap) if gap < DRIFTED else INDEPENDENT
            verdict = compared("independence of a condition that is dropped", independent, allowed, claim)
            return refused(claim) if verdict.sound else verdict
        K = mpmath.matrix(nv + nc, nv + nc)
        for i in range(nv):
            for j in range(nv):
                K[i, j] = M[i, j]
            for j in range(nc):
                K[i, nv + j], K[nv + j, i] = -G[j, i], G[j, i]
        try:
            inverse, free = K**-1, M**-1
        except ZeroDivisionError:
            return refused("the equations have no unique solution")
        exact = inverse * mpmath.matrix(b)
        # Terms of each row, as large as cancellation may have left them unseen.
        root = [mpmath.sqrt(M[i, i]) for i in range(nv)]
        arms = [ENTRIES * (1.0 if name in _LENGTHS else scene["L"]) for name in model.names.v]
        # Gravity, turned into a direction that it does not act along, leaves rounding there.
        weight = 9.81 * math.sqrt(scene["m1"] + scene["m2"] + scene["m3"])
        momentum = sum(r * abs(x) for r, x in zip(root, map(mpmath.mpf, map(float, v)), strict=True))
        terms = [
            root[i] * sum(root[j] * abs(exact[j]) for j in range(nv))
            + abs(b[i])
            + sum((abs(G[k, i]) + arms[i]) * abs(exact[nv + k]) for k in range(nc))
            + root[i] * (momentum * scene["speed"] + weight)
            for i in range(nv)
        ]
        terms += [
            sum((abs(G[k, j]) + arms[j]) * abs(exact[j]) for j in range(nv))
            + abs(b[nv + k])
            + sum(abs(G[k, j] * v[j]) for j in range(nv)) * scene["speed"]
            for k in range(nc)
        ]
        bound = [sum(abs(inverse[i, j]) * terms[j] for j in range(nv + nc)) for i in range(nv)]
        if scene["form"] == "multipliers":  # It corrects the accelerations of the tree, which bound its rounding.
            bound = [bound[i] + sum(abs(free[i, j]) * terms[j] for j in range(nv)) for i in range(nv)]
        shares = [float(abs(exact[i] - a[i]) / bound[i]) if bound[i] else 0.0 for i in range(nv)]
    claim = f"{scene['form']}: rank {int(rank)} of {nc}"
    return compared("error of an acceleration over its condition", max(shares), ROUNDINGS, claim)


def _matrix(entries: list[Any], columns: int) -> Any:
    return mpmath.matrix([entries[i : i + columns] for i in range(0, len(entries), columns)])


def _doubles(G: Any) -> Array:
    return np.array([[float(G[i, j]) for j in range(G.cols)] for i in range(G.rows)])


def _independence(G: Array, columns: Array, L: float) -> float:
    """Smallest over largest singular value of G in units of the mechanism: all conditions here are lengths."""
    values = np.linalg.svd(G * columns / L, compute_uv=False)
    return float(values[-1] / values[0]) if values[0] > 0.0 else 0.0


ATTACK = Attack(
    "closed_dynamics",
    "accelerations under constraints are backward stable in both forms, and no condition is dropped that is one",
    "the same equations, evaluated and solved with fifty digits",
    _scenes,
    lambda scene: mechanism(scene["mechanism"], "multipliers").at(**_values(scene)),
    judge,
)
