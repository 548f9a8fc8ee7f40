"""Runge-Kutta and Rosenbrock methods as data: (docs/theory/simulation.md, section 2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.calls import NativeMemory
from symofros.simulation.stepping import dop853


@dataclass(frozen=True, eq=False)
class Tableau:
    """A one-step method of several stages.

    Attributes:
        order: Order of the solution that is kept.
        stages: Computed at each step.
        a: Stage weights (m, m), strictly lower; the rows beyond `stages` serve dense output only.
        b: Weights of the step (m).
        c: Nodes (m).
        last: The stage at the end of the step, whose slope the next step starts with; 0: none.
        errors: Weights of the error estimates, (0 to 2, stages).
        error_order: Order of the embedded solution.
        dense: Coefficient of x^(j+1) for each stage (m, degree); degree 0: a cubic through ends and slopes.
        gamma: Diagonal coefficient of a Rosenbrock method, whose a, b and errors weigh the solutions of the stages'
            systems.
        coupling: Weights of earlier solutions in a stage's right side, over h (stages, stages).
        d: Weights of the derivative by time (stages).
    """

    order: int
    stages: int
    a: Array
    b: Array
    c: Array
    last: int
    errors: Array
    error_order: int
    dense: Array
    gamma: float = 0.0
    coupling: Array = field(default_factory=lambda: np.zeros(0))
    d: Array = field(default_factory=lambda: np.zeros(0))


@cache
def native_tableau(tableau: Tableau) -> tuple[Any, NativeMemory]:
    """A method's coefficients as a sym_tableau, which all runs share, and the memory that it points into."""
    memory = NativeMemory()
    struct = memory.ffi.new("sym_tableau *")
    struct.stages, struct.dense_stages, struct.fsal_stage = tableau.stages, len(tableau.b), tableau.last
    struct.estimate_order, struct.n_estimates = tableau.error_order, len(tableau.errors)
    struct.dense_degree, struct.gamma = tableau.dense.shape[1], tableau.gamma
    absent = np.zeros(tableau.stages)
    e, e2, *_ = [*tableau.errors, absent, absent]
    arrays = {"a": tableau.a, "b": tableau.b, "c": tableau.c, "e": e, "e2": e2, "dense": tableau.dense}
    for name, values in (arrays | {"coupling": tableau.coupling, "d": tableau.d}).items():
        setattr(struct, name, memory.doubles(values))
    return struct, memory


def _numbers(text: str) -> Array:
    return np.array([float(Fraction(item)) for item in text.split()])


def _lower(rows: list[str]) -> Array:
    a = np.zeros((len(rows) + 1, len(rows) + 1))
    for i, row in enumerate(rows, 1):
        a[i, :i] = _numbers(row)
    return a


def _plain(order: int, rows: list[str], b: str) -> Tableau:
    a = _lower(rows)
    return Tableau(order, len(a), a, _numbers(b), a.sum(axis=1), 0, np.zeros((0, len(a))), 0, np.zeros((len(a), 0)))


def _dormand_prince() -> Tableau:
    """Dormand and Prince 1980; dense output by Shampine 1986, of order 4."""
    a = _lower(
        [
            "1/5",
            "3/40 9/40",
            "44/45 -56/15 32/9",
            "19372/6561 -25360/2187 64448/6561 -212/729",
            "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
            "35/384 0 500/1113 125/192 -2187/6784 11/84",
        ]
    )
    fourth = _numbers("5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40")
    dense = np.array(
        [
            _numbers(row)
            for row in (
                "1 -8048581381/2820520608 8663915743/2820520608 -12715105075/11282082432",
                "0 0 0 0",
                "0 131558114200/32700410799 -68118460800/10900136933 87487479700/32700410799",
                "0 -1754552775/470086768 14199869525/1410260304 -10690763975/1880347072",
                "0 127303824393/49829197408 -318862633887/49829197408 701980252875/199316789632",
                "0 -282668133/205662961 2019193451/616988883 -1453857185/822651844",
                "0 40617522/29380423 -110615467/29380423 69997945/29380423",
            )
        ]
    )
    return Tableau(5, 7, a, a[6].copy(), a.sum(axis=1), 6, (a[6] - fourth)[np.newaxis], 4, dense)


def _dop853() -> Tableau:
    """Hairer, Norsett, Wanner: order 8 with estimates of order 5 and 3; dense output of order 7."""
    m, used = len(dop853.NODES), 13
    a, d = np.zeros((m, m)), np.zeros((4, m))
    for i, j, value in dop853.STAGES:
        a[i, j] = value
    for i, j, value in dop853.DENSE:
        d[i, j] = value
    errors = np.array([dop853.ERROR5, dop853.ERROR3])
    b = a[12].copy()
    return Tableau(8, used, a, b, np.array(dop853.NODES), 12, errors, 7, _nested(b, d))


def _nested(b: Array, d: Array) -> Array:
    """Dense output x (F0 + (1-x) (F1 + x (F2 + (1-x) (F3 + ...)))) as powers of x, a row a stage.

    F0 = h sum b k, F1 = h k_0 - F0, F2 = 2 F0 - h (k_12 + k_0), F3 to F6 = h d k.
    """
    m = len(b)
    first, end = np.eye(m)[0], np.eye(m)[12]
    terms = [b, first - b, 2 * b - (end + first), *d]
    total = np.zeros((m, 8))  # Coefficients of 1, x, ..., x^7, built from the inside out.
    for i, term in reversed(list(enumerate(terms))):
        total[:, 0] += term
        shifted = np.hstack([np.zeros((m, 1)), total[:, :-1]])
        total = shifted if i % 2 == 0 else total - shifted
    return total[:, 1:]


def _linear_euler() -> Tableau:
    """Implicit Euler with one Newton step: order 1, damps stiff modes."""
    one = np.ones(1)
    return Tableau(
        1, 1, np.zeros((1, 1)), one, np.zeros(1), 0, np.zeros((0, 1)), 0, np.zeros((1, 0)), 1.0, np.zeros((1, 1)), one
    )


def _rodas() -> Tableau:
    """RODAS of Hairer and Wanner (II, IV.10): six stages, order 4(3), stiffly accurate and L-stable."""
    fifth = "1.221224509226641 6.019134481288629 12.53708332932087 -0.6878860361058950"
    a = _lower(
        [
            "1.544",
            "0.9466785280815826 0.2557011698983284",
            "3.314825187068521 2.896124015972201 0.9986419139977817",
            fifth,
            fifth + " 1",
        ]
    )
    coupling = _lower(
        [
            "-5.6688",
            "-2.430093356833875 -0.2063599157091915",
            "-0.1073529058151375 -9.594562251023355 -20.47028614809616",
            "7.496443313967647 -10.24680431464352 -33.99990352819905 11.70890893206160",
            "8.083246795921522 -7.981132988064893 -31.52159432874371 16.31930543123136 -6.058818238834054",
        ]
    )
    b = np.concatenate([a[5, :5], [1.0]])
    nodes, d = _numbers("0 0.386 0.21 0.63 1 1"), _numbers("0.25 -0.1043 0.1035 -0.0362 0 0")
    return Tableau(4, 6, a, b, nodes, 0, np.eye(6)[5:], 3, np.zeros((6, 0)), 0.25, coupling, d)


EXPLICIT_EULER = _plain(1, [], "1")
RK4 = _plain(4, ["1/2", "0 1/2", "0 0 1"], "1/6 1/3 1/3 1/6")
DORMAND_PRINCE = _dormand_prince()
DOP853 = _dop853()
LINEAR_EULER = _linear_euler()
RODAS = _rodas()
