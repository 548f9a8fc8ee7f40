"""Truth of displacements: where speeds lead in unit time, what leads from one configuration to another, derivatives."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from functools import partial

from ..interface import Joint
from .arithmetic import Exact, eye, solve
from .charts import CHARTS, Chart
from .dynamics import Point, Truth

# Of the table: what speeds of order one take for some 23 digits.
ROWS = 11


def integrated(truth: Truth, q: Exact, v: Exact, rows: int = ROWS) -> Exact:
    """Where q' = N(q) v leads with constant v in unit time, in parts in which v leads by an order of one."""
    end = q + truth.kinematics.rates(q) @ v
    # Joints move by themselves, and derivatives move one at a time.
    for joint, slot in truth.kinematics.moving():
        chart = CHARTS[slot.chart]
        if not chart.is_flat:
            own, speeds = q[list(slot.q)], v[list(slot.v)]
            parts = max(1, int(max(map(abs, speeds))))
            end[list(slot.q)] = truth.once(
                ("integrated", rows, slot.q, *own, *speeds),
                partial(_extrapolated, partial(_rate, chart, joint, speeds / parts), own, rows, parts),
            )
    return end


def _rate(chart: Chart, joint: Joint, v: Exact, q: Exact) -> Exact:
    """Rates of a joint's coordinates."""
    return chart.rates(joint, q) @ v


def _extrapolated(rate: Callable[[Exact], Exact], start: Exact, rows: int, parts: int) -> Exact:
    """Where q' = rate(q) leads in as many units of time: Gragg's midpoint rule, extrapolated for each."""
    for _ in range(parts):
        start = _unit(rate, start, rows)
    return start


def _unit(rate: Callable[[Exact], Exact], start: Exact, rows: int) -> Exact:
    """Where q' = rate(q) leads in unit time."""
    table: list[Exact] = []
    for row in range(rows):
        n = 2 * (row + 1)
        before, point = start, start + rate(start) / n
        for _ in range(n - 1):
            before, point = point, before + 2 * rate(point) / n
        last = (before + point + rate(point) / n) / 2
        line = [last]
        for k in range(row):
            ratio = Decimal((row + 1) ** 2) / Decimal((row - k) ** 2)
            line.append(line[k] + (line[k] - table[k]) / (ratio - 1))
        table = line
    return table[-1]


def to_tangent(truth: Truth, q: Exact, columns: Exact) -> Exact:
    """Speeds (nv, n) whose rates are nearest to columns (nq, n)."""
    N = truth.kinematics.rates(q)
    return solve(N.T @ N, N.T @ columns)


def integrated_dq(truth: Truth, s: Point) -> Exact:
    """Derivatives (nv, nv) of integrate by its configuration, in tangents at both."""

    def compute() -> Exact:
        columns = truth.kinematics.tangent(lambda q: integrated(truth, q, s.v2), s.q)
        return to_tangent(truth, integrated(truth, s.q, s.v2), columns)

    return truth.once(("integrated_dq", *s.q, *s.v2), compute)


def integrated_dv(truth: Truth, s: Point) -> Exact:
    """Derivatives (nv, nv) of integrate by its speeds, in the tangent at the result."""

    def compute() -> Exact:
        columns = truth.along_speeds(lambda v: integrated(truth, s.q, v), s.v2)
        return to_tangent(truth, integrated(truth, s.q, s.v2), columns)

    return truth.once(("integrated_dv", *s.q, *s.v2), compute)


def difference_dq(truth: Truth, s: Point) -> Exact:
    """Derivatives (nv, nv) of the difference of q and where v2 leads by q, the other configuration kept."""
    return -solve(integrated_dv(truth, s), integrated_dq(truth, s))


def difference_dq2(truth: Truth, s: Point) -> Exact:
    """Derivatives (nv, nv) of the difference of q and where v2 leads by the latter."""
    return solve(integrated_dv(truth, s), eye(truth.nv))
