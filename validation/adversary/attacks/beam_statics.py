"""Cantilevers of any size and load at rest: one beam with its stated error against the exact elastica."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ...accuracy.statics.estimate import CRITICAL, Loads, elastica_tip
from ..attack import Attack, Mechanism, Scene, Verdict, compared, decades, refused, undecided

# Factor within which the stated error is right (section 6 of docs/theory/beams.md: two), with a margin; error from
# which a result carries a note; floor of what five polynomials and the collocation leave.
FACTOR, NOTED, FLOOR = 3.0, 0.01, 2e-3
NAMES = ("L", "EI", "P", "F", "w")


def beam(name: str, root: sf.Joint, length: str, count: int, tip: bool) -> sf.Beam:
    """A beam of bending stiffness EI under the loads of the cantilever."""
    spread = sf.BeamLoad((0.0, sf.formula("w", "load"), 0.0), axes="world")
    end = sf.BeamLoad((sf.formula("-P", "load"), sf.formula("F", "load"), 0.0), at=1.0, axes="world")
    loads = (end, spread) if tip else (spread,)
    rho, EI = sf.formula("rho"), sf.formula("EI")
    return sf.Beam(name, root, sf.formula(length), rho, EI_z=EI, bend_y=count, family="legendre", loads=loads)


@cache
def cantilever() -> Mechanism:
    """One beam along x."""
    parameters = tuple(sf.Parameter(name, 1.0) for name in (*NAMES, "rho"))
    one = beam("beam", sf.Joint("root", "fixed"), "L", 5, tip=True)
    return Mechanism(sf.System("cantilever", (one,), parameters, gravity=(0, 0, 0)))


_scenes = st.fixed_dictionaries(
    {
        "L": decades(-4, 4),
        "EI": decades(-6, 9),
        # Over EI/L^2, P over the critical load.
        "P": st.one_of(st.just(0.0), st.floats(-5.0, 1.5).map(lambda x: round(x, 3))),
        "F": st.one_of(st.just(0.0), st.builds(lambda m, e: m * 10.0**e, st.integers(1, 9), st.integers(-6, 1))),
        "w": st.one_of(st.just(0.0), st.builds(lambda m, e: m * 10.0**e, st.integers(1, 9), st.integers(-6, 1))),
    }
)


def values_of(scene: Scene) -> dict[str, float]:
    """Parameters of the scene."""
    L, EI = scene["L"], scene["EI"]
    force = EI / L**2
    return {
        "L": L,
        "EI": EI,
        "P": scene["P"] * CRITICAL * force,
        "F": scene["F"] * force,
        "w": scene["w"] * force / L,
        "rho": 1.0,
    }


def judge(scene: Scene) -> Verdict:
    """The tip and its stated error."""
    one = cantilever()
    par = one.par(**values_of(scene))
    rest = sf.equilibrium(one.model, par=par)
    p, _ = one.model.frame_pose("tip", rest.q, par=par)
    (bending,) = rest.bendings
    try:
        exact = elastica_tip(Loads(scene["P"] * CRITICAL, scene["F"], scene["w"])) - (1.0, 0.0)
    except ArithmeticError as failure:
        return undecided(failure)
    moved = p[:2] / scene["L"] - (1.0, 0.0)
    size = float(np.linalg.norm(exact))
    if size < 1e-12 and scene["P"] > 1.0:
        return refused(rest.notes) if rest.notes else compared("columns past their critical load", 1.0, 0.0, "rest")
    error = float(np.linalg.norm(moved - exact)) / size if size > 0.0 else float(np.linalg.norm(moved))
    stated = max(bending.error, NOTED)
    claim = f"a rest with a stated error of {bending.error:.3g}"
    return compared("error of the tip", error, FACTOR * stated + FLOOR, claim)


ATTACK = Attack(
    "beam_statics",
    "an equilibrium errs by no more than three times the error that it states",
    "the elastica by collocation",
    _scenes,
    lambda scene: cantilever().at(**values_of(scene)),
    judge,
)
