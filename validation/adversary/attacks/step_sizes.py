"""Fixed steps from fine to coarse: masses on springs against the matrix exponential, pendulums against finer runs."""

from __future__ import annotations

from functools import cache

import numpy as np
import scipy.linalg
from hypothesis import strategies as st

import symofros as sf

from ..attack import Attack, Mechanism, Scene, Verdict, along, compared, decades, inertia, refused
from ..motion import UNNOTED, against_finer, claimed_good

_METHODS = ("rk4", "euler", "semi_implicit_euler", "implicit_euler", "generalized_alpha", "dopri5", "rodas4")


@cache
def masses() -> Mechanism:
    """Two masses in a row, each on a spring and a damper."""

    def element(k: str, c: str) -> tuple[sf.Spring, sf.Damper]:
        return sf.Spring(sf.formula(k)), sf.Damper(sf.formula(c))

    along = (1, 0, 0)
    bodies = (
        sf.RigidBody("a", sf.Joint("x", "prismatic", axis=along, elements=element("k1", "c1")), inertia("m1")),
        sf.RigidBody("b", sf.Joint("y", "prismatic", "a", axis=along, elements=element("k2", "c2")), inertia("m2")),
    )
    names = ("m1", "m2", "k1", "k2", "c1", "c2")
    return Mechanism(sf.System("masses", bodies, tuple(sf.Parameter(n, 1.0) for n in names), gravity=(0, 0, 0)))


@cache
def pendulum() -> Mechanism:
    """Two bars that hang, the second of another size and mass."""

    def bar(name: str, joint: sf.Joint, length: str, mass: str) -> sf.RigidBody:
        j = f"{mass}*{length}^2/12"
        mass_properties = inertia(mass, (f"{length}/2", 0, 0), (f"{j}/100", j, j))
        return sf.RigidBody(name, joint, mass_properties, (sf.Frame("end", along(length)),))

    axis = (0, -1, 0)
    bodies = (
        bar("upper", sf.Joint("q1", "revolute", axis=axis), "l1", "m1"),
        bar("lower", sf.Joint("q2", "revolute", "upper", "end", axis=axis), "l2", "m2"),
    )
    names = ("l1", "l2", "m1", "m2")
    return Mechanism(sf.System("pendulum", bodies, tuple(sf.Parameter(n, 1.0) for n in names)))


_scenes = st.fixed_dictionaries(
    {
        "mechanism": st.sampled_from(["masses", "pendulum"]),
        "method": st.sampled_from(_METHODS),
        # Step over the slower unit of time.
        "step": st.sampled_from([0.001, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0]),
        "steps": st.sampled_from([10, 3, 30, 100]),
        # Second over first.
        "mass": decades(-6, 4),
        "size": decades(-4, 4),
        "damping": st.sampled_from([0.0, 0.1, 2.0, 100.0]),
        # Of the whole, which nothing should depend on.
        "scale": decades(-6, 6),
        "start": st.sampled_from([[1.0, 0.0], [0.0, 1.0], [1.0, -0.5], [0.1, 3.0]]),
        "speed": st.sampled_from([[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]]),
    }
)


def _values(scene: Scene) -> dict[str, float]:
    scale, mass, size = scene["scale"], scene["mass"], scene["size"]
    if scene["mechanism"] == "pendulum":
        return {"l1": scale, "l2": size * scale, "m1": 1.0, "m2": mass}
    return {
        "m1": scale,
        "m2": mass * scale,
        "k1": scale,
        "k2": size * scale,
        "c1": scene["damping"] * scale,
        "c2": scene["damping"] * scale * float(np.sqrt(mass * size)),
    }


def _mechanism(scene: Scene) -> Mechanism:
    return masses() if scene["mechanism"] == "masses" else pendulum()


def judge(scene: Scene) -> Verdict:
    """A run of fixed steps."""
    one, values = _mechanism(scene), _values(scene)
    model, par = one.model, one.par(**values)
    unit = 1.0 if scene["mechanism"] == "masses" else float(np.sqrt(scene["scale"] / 9.81))
    dt = scene["step"] * unit
    q, v, t_end = np.array(scene["start"]), np.array(scene["speed"]) / unit, dt * scene["steps"]
    run = sf.simulate(model, q, v, t_end, par=par, method=scene["method"], dt=dt, adaptive=False)
    if not claimed_good(run):
        return refused(run.outcome)
    if scene["mechanism"] == "pendulum":
        return against_finer(model, run, par, 1.0)
    m1, m2, k1, k2, c1, c2 = (values[name] for name in one.names)
    M, K, C = np.array([[m1 + m2, m2], [m2, m2]]), np.diag([k1, k2]), np.diag([c1, c2])
    inverse = np.array([[1.0 / m1, -1.0 / m1], [-1.0 / m1, 1.0 / m1 + 1.0 / m2]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ K, -inverse @ C]])
    times = np.linspace(0.0, t_end, 9)
    exact = [scipy.linalg.expm(A * t) @ np.concatenate([q, v]) for t in times]
    # The energy's norm, of springs and speeds together.
    weight = scipy.linalg.block_diag(K, M)
    largest = max(float(x @ weight @ x) for x in exact)
    error = np.concatenate([run.q[-1], run.v[-1]]) - exact[-1]
    share = float(np.sqrt(error @ weight @ error / largest))
    return compared("error of the last state", share, UNNOTED, f"'{run.outcome}', without a note")


ATTACK = Attack(
    "step_sizes",
    "a run of fixed steps without a note errs by less than three tenths",
    "the matrix exponential of linear motions; the eighth-order method at 1e-10 of others",
    _scenes,
    lambda scene: _mechanism(scene).at(**_values(scene)),
    judge,
)
