"""The planar flexible robot under control: modes and steps of ours against elements and steps of Exudyn's."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import symofros as sf

from ... import references
from ...adapters.exudyn.planar import Cable
from ...adapters.exudyn.steps import Solver
from ...adapters.exudyn.timed_systems import planar
from ...mechanics.geometry import Array
from ..contestants.exudyn import ExudynModel
from ..contestants.symofros import SymofrosModel
from ..problem import BenchmarkProblem, Contestant, Prepared, Target

END, OUTPUT = 2.0, 0.02
TIMES = np.arange(round(END / OUTPUT) + 1, dtype=np.float64) * OUTPUT
# Joint -> angle at the start, angle asked for [rad], stiffness [N m/rad] and damping [N m s/rad] of the control.
CONTROL = {"q1": (0.0, 0.3, 10.0, 4.0), "q2": (0.8, 0.5, 4.0, 1.0), "q3": (-0.5, -0.2, 0.5, 0.1)}
START = {name: row[0] for name, row in CONTROL.items()}
# The tool in the frame of the last joint: flange, then tool.
TOOL = (0.12, 0.0)
TOLERANCE = 1e-6
# E A of the strips, from the sections the model states: 200 GPa on 50 mm x 2.5 mm and on 40 mm x 2 mm [N].
EA = {"link1": 2.5e7, "link2": 1.6e7}
# Relative tolerances of adaptive methods.
RTOLS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
FINE, FINE_STEP = 12, 2.5e-4


def system(count: int, **changed: Any) -> sf.System:
    """The robot with so many functions a strip, and control in place of friction, which engines have each its own."""
    stated = references.MODELS["planar_robot"]
    return replace(stated, bodies=tuple(_body(body, count, changed) for body in stated.bodies))


def _body(body: sf.Body, count: int, changed: dict[str, Any]) -> sf.Body:
    if isinstance(body, sf.Beam):
        given: dict[str, Any] = {"bend_y": count, "family": "spline"} | changed
        return replace(body, **given)
    if body.joint is None or body.joint.name not in CONTROL:
        return body
    _, rest, stiffness, damping = CONTROL[body.joint.name]
    return replace(body, joint=replace(body.joint, elements=(sf.Spring(stiffness, rest), sf.Damper(damping))))


def rod_robot(count: int, stretch: int = 0) -> sf.System:
    """The robot with geometrically exact rods for strips, of so many functions of curvature and of stretch."""
    rods = [
        replace(body, stretch=stretch, EA=EA[body.name]) if stretch and isinstance(body, sf.Beam) else body
        for body in system(count, theory="strain", family="legendre", retain="first_order").bodies
    ]
    return replace(system(count), bodies=tuple(rods))


def exudyn(elements: int) -> ExudynModel:
    """Exudyn's model, whose strips stretch as steel does."""
    cables = {name: Cable(elements, stiffness) for name, stiffness in EA.items()}
    label = f"{elements} element{'s' * (elements > 1)} a strip"
    return ExudynModel(label, planar(system(3), START, cables, TOOL), END, OUTPUT, lambda r: far(r.values[:, :2]))


def path(m: sf.Model, **settings: Any) -> Array:
    """The tool of one of our models (n, 2) [m]."""
    run = sf.simulate(m, first(m), t_end=END, output=TIMES, **settings)
    return np.asarray(run.frames["tool"][0][:, :2])


def first(m: sf.Model) -> Array:
    """The configuration at the start, strips straight."""
    return np.array([START.get(name, 0.0) for name in m.names.q])


@cache
def reference() -> Array:
    """Exudyn's tool (n, 2) of a fine mesh, extrapolated from two steps."""
    solver = Solver(full=False, tolerance=TOLERANCE)
    fine, coarse = (exudyn(FINE).system.run(solver, step, END, OUTPUT) for step in (FINE_STEP / 2, FINE_STEP))
    return np.asarray((4.0 * fine.values[:, :2] - coarse.values[:, :2]) / 3.0)


@cache
def size() -> float:
    """Distance by which flexibility displaces the tool from that of the rigid robot [m]."""
    rigid = path(sf.compile(system(0)), method="dop853", rtol=1e-9)
    return float(np.linalg.norm(rigid - reference(), axis=1).max())


def far(tool: Array) -> float:
    """Largest distance over the run, as a share of what flexibility does."""
    return float(np.linalg.norm(tool - reference(), axis=1).max()) / size()


def judged_model(label: str, m: sf.Model) -> SymofrosModel:
    """A model of ours, to be judged by its tool."""
    given = {"q0": first(m), "t_end": END, "output": TIMES}
    return SymofrosModel(label, m, given, lambda run: far(run.frames["tool"][0][:, :2]))


def splines(count: int) -> str:
    """A count for people."""
    return f"{count} spline{'s' * (count > 1)}"


def prepare(quick: bool) -> Prepared:
    """Contestants, with the agreement of two independent references and the floors of second-order beams."""
    first_order = (
        judged_model("4 splines", sf.compile(system(4))).measured(method="rodas4", rtol=1e-8, atol=1e-10).error
    )
    rod = far(path(sf.compile(rod_robot(6, 2)), method="rodas4", rtol=1e-9, atol=1e-11))
    all_terms = far(path(sf.compile(system(4, retain="all")), method="rodas4", rtol=1e-8, atol=1e-10))
    contestants = [*_splines(quick), *([] if quick else _richer()), *_by_exudyn(quick)]
    origin = (
        f"Exudyn, {FINE} ANCFCable2D elements a strip, extrapolated from steps of {1e3 * FINE_STEP:g} and "
        f"{500 * FINE_STEP:g} ms; and, sharing no code with it, our robot with rods of 6 functions of curvature and "
        "2 of stretch for strips by rodas4 at 1e-9"
    )
    return Prepared(tuple(contestants), rod, origin, {"first order": first_order, "all terms": all_terms})


def _splines(quick: bool) -> list[Contestant]:
    """Our models with splines, with the terms of each order."""
    contestants: list[Contestant] = []
    rtols = (1e-3, 1e-5) if quick else RTOLS
    retained = {"": "first_order", ", all terms": "all"}
    for label, retain in retained.items():
        for count in (2,) if quick else (1, 2, 3):
            one = judged_model(f"{splines(count)}{label}", sf.compile(system(count, retain=retain)))
            contestants += one.by("rodas4", rtols) + one.by("generalized_alpha", (0.02, 0.01, 5e-3, 2e-3, 1e-3))
            contestants += [] if quick else one.by("rk4", (2e-3, 1e-3, 5e-4, 2e-4))
            if count == 2 and not quick:
                contestants += one.by("dop853", rtols[1:4]) + one.by("dopri5", rtols[1:4]) + one.by("cvode", rtols)
                contestants += one.by("implicit_euler", (5e-3, 1e-3, 2e-4))
                contestants += one.by("semi_implicit_euler", (2e-3, 1e-3, 5e-4, 2e-4, 1e-4))
    return contestants


def _richer() -> list[Contestant]:
    """Our models with other functions, with rods, and rigid."""
    contestants: list[Contestant] = []
    changes: dict[str, dict[str, Any]] = {
        "2 splines, zeroth order": {"retain": "zeroth_order"},
        "3 modes": {"bend_y": 3, "family": "clamped_free"},
        "2 Hermite": {"family": "hermite"},
    }
    for label, change in changes.items():
        one = judged_model(label, sf.compile(system(2, **change)))
        contestants += one.by("rodas4", RTOLS[:4]) + one.by("generalized_alpha", (0.02, 0.01, 5e-3))
    for count, stretch in ((2, 0), (3, 0), (4, 0), (4, 1), (5, 2)):
        label = f"rods of {count}{f' + {stretch}' * (stretch > 0)} strains"
        one = judged_model(label, sf.compile(rod_robot(count, stretch)))
        contestants += one.by("rodas4", RTOLS) + one.by("generalized_alpha", (0.02, 0.01, 5e-3, 2e-3, 1e-3))
        contestants += [] if stretch else one.by("dop853", RTOLS[1:4]) + one.by("dopri5", RTOLS[1:4])
    return contestants + judged_model("rigid strips", sf.compile(system(0))).by("rk4", (0.02, 0.01))


def _by_exudyn(quick: bool) -> list[Contestant]:
    """Exudyn's elements and solvers."""
    contestants: list[Contestant] = []
    for elements in (1, 2) if quick else (1, 2, 3, 4):
        steps = (0.01, 2e-3) if quick else (0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4)
        contestants += exudyn(elements).by(Solver(tolerance=TOLERANCE), steps)
        if not quick:
            contestants += exudyn(elements).by(Solver(tolerance=TOLERANCE, full=False), steps)
            contestants += exudyn(elements).by(Solver(tolerance=TOLERANCE, full=False, sparse=True), steps[1:5])
            contestants += exudyn(elements).by(Solver(tolerance=TOLERANCE, radius=0.6), steps[:4])
    if not quick:
        for elements in (4, 6):  # For errors of 1e-4 and 1e-5.
            solver = Solver(tolerance=TOLERANCE, full=False, sparse=True)
            contestants += exudyn(elements).by(solver, (5e-4, 2.5e-4, 1.25e-4, 6.25e-5))
        contestants += exudyn(1).by(Solver("TrapezoidalIndex2", tolerance=TOLERANCE), (5e-3, 1e-3))
        contestants += exudyn(1).by(Solver("RK44"), (1e-4,))
    return contestants


PROBLEM = BenchmarkProblem(
    "Planar flexible robot under control",
    "The paper's robot, three motors with harmonic drives, an elastic first joint and two steel strips, from rest to "
    "another posture by a spring and a damper on each motor; 2 s. Every side records its tool each 20 ms.",
    "distance of the tool, largest over the run, as a share of what flexibility does to it",
    "error of the tool / effect of flexibility  [1]",
    "Exudyn: ANCFCable2D with the stretch of steel, 1 to 6 elements a strip, rigid bodies in three coordinates; "
    "generalised alpha with spectral radii 0.6 and 0.9, full and modified Newton iterations, dense and sparse; "
    "trapezoidal rule of index 2; steps from 0.06 to 20 ms. Its explicit solvers refuse joints.",
    prepare,
    (
        Target("Exudyn", 1e-2, 30.0),
        Target("Exudyn", 2e-3, 30.0),
        Target("Exudyn", 1e-3, 20.0),
        Target("Exudyn", 1e-4, 20.0),
        Target("Exudyn", 1e-5, 20.0),
    ),
    5e-6,
    ("SYMOFROS paper, section 7; parameters of reference_models/flexible/planar_robot.yaml; control of this study",),
    percent=True,
)
