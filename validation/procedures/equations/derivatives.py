"""What every model is asked, a user's own too: derivatives, transposed products and C, by what they are derivatives of.

The functions that are differentiated are compared with engines. Central differences of fourth order with a step of
1e-3 leave some 1e-13 of a smooth function, of one that is solved for cond(M) times a rounding, over the step. Programs
are interpreted: that C is what the interpreter evaluates shows elsewhere, and C of derivatives takes long to compile.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

import symofros as sf

from ...comparison.errors import Comparison, Status, raised
from ...comparison.participants import EPS
from ...contract.conventions import Chart
from ...contract.interface import NotOffered, States
from ...contract.quantities import ROUNDING, SMALL, SOLVE
from ...contract.raised import Raised, attempted
from ...mechanics.assembly import Assembly
from ...mechanics.geometry import Array
from .. import ENGINE
from ..scene import DIFFERENCE, Cell, Manifold, Scene
from . import analyses, identities

# Accelerations of light ends change faster than other functions: what fourth order leaves of them.
SOLVED = 1e-6
# Functions of engines' plug-ins -> the output of ours that is the same, and the function that has it.
BY_ENGINES = {
    "inverse_dynamics_dq": ("inverse_dynamics_derivatives", 0, ROUNDING),
    "inverse_dynamics_dv": ("inverse_dynamics_derivatives", 1, ROUNDING),
    "forward_dynamics_dq": ("forward_dynamics_derivatives", 0, SOLVE),
    "forward_dynamics_dv": ("forward_dynamics_derivatives", 1, SOLVE),
}
# States at which engines are asked, the last of the check's: each has a fast or a special one among the first.
ASKED = 5
# One of the last so many states is taken for differences.
AMONG = 20
# Parameters, by which is differentiated, too, whose work is that of one speed.
PARAMETERS = 4
# Work of a speed of a beam or rod, whose derivatives are of long polynomials, in speeds of rigid joints.
ELASTIC = 3


class Differentiating(Protocol):
    """An engine that may have derivatives of its own, under the names of the matrix's functions."""

    @property
    def name(self) -> str:
        """Name of the engine as tables show it."""

    @property
    def chart(self) -> Chart:
        """Map between its coordinates and ours."""

    @property
    def accuracy(self) -> Mapping[str, float]:
        """Tolerances of what it documents as approximate."""

    def asked(self, function: str, states: States) -> Array:
        """A function at N states, in its own coordinates and speeds (N, ...)."""


@dataclass(frozen=True)
class Question:
    """One row of every model.

    Attributes:
        name: Name of the row.
        cells: What is compared; the worst counts.
        most: Speeds of the largest model that is asked; larger ones take long, and are asked by `check --full`.
        solved: Whether M is solved with, so that differences lose cond(M) roundings.
    """

    name: str
    cells: Callable[[Scene], Iterator[Cell]]
    most: int
    solved: bool = False


QUESTIONS = (
    Question("derivatives of inverse dynamics", analyses.differentiated, 12, True),
    Question("derivatives of forward dynamics, and of frames", analyses.linearised, 8, True),
    Question("transposed products", identities.transposed, 10, True),
    Question("Coriolis matrix", identities.velocity_terms, 20),
)


@dataclass(frozen=True)
class Asked:
    """A model that is asked.

    Attributes:
        label: Name of the model in tables.
        system: Description.
        assembly: The same as numbers.
        states: States that keep constraints, with forces.
        condition: Factor by which solving for v' amplifies rounding.
        full: Whether large models are asked, too.
    """

    label: str
    system: sf.System
    assembly: Assembly
    states: States
    condition: float
    full: bool

    def left_out(self, most: int) -> str:
        """Why a question is not asked; "" where it is."""
        size = len(self.system.parameters) // PARAMETERS + sum(
            (mover.v.stop - mover.v.start) * (ELASTIC if mover.kind in ("elastic", "section") else 1)
            for mover in self.assembly.movers
        )
        if size <= most or self.full:
            return ""
        what = f"speeds, those of beams counted {ELASTIC} times, and one for {PARAMETERS} parameters"
        return f"{size} {what}; beyond {most} `check --full` asks"


def judge_derivatives(asked: Asked, engines: Sequence[Differentiating]) -> Iterator[Comparison]:
    """A row a question, and one for each engine that differentiates; what is not asked says why.

    Args:
        asked: Model.
        engines: Engines that may have derivatives.
    """
    few = asked.states[-AMONG:]
    # Friction turns fast where a speed is small, faster than differences follow.
    slowest = np.abs(few.v).min(axis=1, initial=np.inf)
    one = few[int(np.argmax(slowest)) :][:1]
    model = sf.compile(asked.system, sf.Options(backend="interpreter"))
    q, v, u = one.q[0], one.v[0], one.u[0]
    scene = Scene(model, asked.system, Manifold.of(asked.assembly), q, v, lambda *_: u, u, backend="interpreter")
    for question in QUESTIONS:
        reason = asked.left_out(question.most)
        if question.cells is identities.velocity_terms and asked.assembly.driven_joints:
            reason = "prescribed motions: h has speeds that are not among v"
        if question.cells is analyses.linearised and _repeats(scene):
            reason = "conditions repeat each other, so that accelerations have no derivative"
        if reason:
            yield Comparison(asked.label, ENGINE, question.name, "unsupported", note=reason)
            continue
        widened = SOLVED + EPS * asked.condition / DIFFERENCE if question.solved else 0.0
        row = attempted(_worst, asked.label, question, scene, widened)
        yield raised(asked.label, ENGINE, question.name, row) if isinstance(row, Raised) else row
    # Engines know no forces by formula, whose derivatives are among ours.
    if not np.any(asked.states.passive) and not asked.system.constraints:
        for engine in engines:
            yield from _by_engine(asked, model, engine)


def _repeats(scene: Scene) -> bool:
    """Whether some conditions follow from others where they hold, which they do nowhere else."""
    if not scene.model.nc:
        return False
    G = scene.model.constraint_jacobian(scene.q, u=scene.u)
    return bool(np.linalg.matrix_rank(G) < len(G))


def _by_engine(asked: Asked, model: sf.Model, engine: Differentiating) -> Iterator[Comparison]:
    """Derivatives that an engine has of its own, where its coordinates are ours."""
    at = asked.states[-ASKED:]
    for function, (name, output, tolerance) in BY_ENGINES.items():
        question = next(one for one in QUESTIONS if name.partition("_")[0] in one.name)
        if engine.chart.turns or asked.left_out(question.most):
            continue
        theirs = attempted(_derivative, engine, function, at)
        if theirs is None:
            continue
        if isinstance(theirs, Raised):
            yield raised(asked.label, engine.name, function, theirs)
            continue
        given = (at.q, at.v, at.a) if name.startswith("inverse") else (at.q, at.v, at.u)
        both = [np.asarray(x) for x in getattr(model, name)(*given)]
        # One of the two may vanish, and what the engine then has is rounding.
        least = SMALL * max(float(np.abs(x).max(initial=0.0)) for x in both) or 1.0
        sizes = np.maximum(np.abs(theirs).max(axis=(1, 2)), least)
        error = float((np.abs(both[output] - theirs).max(axis=(1, 2)) / sizes).max())
        solved = EPS * asked.condition if tolerance == SOLVE else 0.0
        # What is granted to differences is a rounding over their step; of what is solved for, cond(M) roundings.
        granted = engine.accuracy.get(function, 0.0) * max(1.0, solved / ROUNDING)
        tolerance = max(tolerance, solved, granted)
        status: Status = "agree" if error <= tolerance else "disagree"
        finite = error if np.isfinite(error) else None
        yield Comparison(asked.label, engine.name, function, status, len(at), finite, tolerance)


def _derivative(engine: Differentiating, function: str, at: States) -> Array | None:
    """An engine's values of a function (N, nv, nv), turned into our order of speeds; None where it has none."""
    try:
        values = engine.asked(function, at)
    except NotOffered:
        return None
    return engine.chart.mass_matrix(at.q, values)


def _worst(label: str, question: Question, scene: Scene, widened: float) -> Comparison:
    """The cell that is nearest to its tolerance, or farthest beyond."""
    cells = [replace(cell, tolerance=cell.tolerance + widened) for cell in question.cells(scene)]
    worst = max(cells, key=lambda cell: cell.error / cell.tolerance)
    status: Status = "agree" if worst.error <= worst.tolerance else "disagree"
    finite = worst.error if np.isfinite(worst.error) else None
    note = "" if worst.error == 0.0 else f"largest in {worst.name}"
    return Comparison(label, ENGINE, question.name, status, 1, finite, worst.tolerance, note=note)
