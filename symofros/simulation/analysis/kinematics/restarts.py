"""Further starts of inverse kinematics, for targets that the steps from the guess do not reach.

Drawn with a fixed seed: the same for the same model and guess. Those of one round lie farther and farther from the
guess, the last one anywhere within the limits.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from symofros.base.arrays import Array
from symofros.base.measures import ROTATION, TRANSLATION
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.assembly import Indices
from symofros.simulation.analysis.kinematics.nearest_posture import coordinate_limits
from symofros.simulation.analysis.kinematics.targets import Task

# Starts of one round, of whose solutions the nearest to the guess counts.
ROUND = 8
_TURN = 2.0 * np.pi


def default_start(model: Model) -> Array:
    """The neutral configuration (nq), coordinates that it has beyond their limits in the middle of these."""
    q = np.array(model.neutral())
    for i, _, low, high in coordinate_limits(model):
        if not low <= q[i] <= high:
            q[i] = 0.5 * (low + high) if np.isfinite([low, high]).all() else min(max(q[i], low), high)
    return q


def drawn_starts(task: Task, guess: Array, free: Indices, most: int) -> Iterator[list[Array]]:
    """Rounds of starts (nq).

    Angles are drawn within half a turn of the guess, other coordinates within their limits, or as far from the guess as
    the targets are from their frames where they have none; rotations uniformly. Elastic coordinates and those that are
    not free stay.

    Args:
        task: Targets and constraints.
        guess: Configuration (nq) within its limits.
        free: Speeds that may be used.
        most: Number of starts.
    """
    model, random = task.model, np.random.default_rng(0)
    reach = float(np.abs(task.position_errors(guess)).max(initial=0.0))
    low, high, turning = _windows(model, guess, free, reach)
    for first in range(0, most, ROUND):
        steps = random.uniform(low, high, (ROUND, model.nv))
        for speeds in turning:
            axes, angles = random.standard_normal((ROUND, 3)), random.uniform(0.0, np.pi, (ROUND, 1))
            steps[:, speeds] = axes / np.linalg.norm(axes, axis=-1, keepdims=True) * angles
        shares = (np.arange(ROUND) + 1.0) / ROUND
        yield [model.integrate(guess, share * step) for share, step in zip(shares[: most - first], steps, strict=False)]


def used_speeds(task: Task, guess: Array, free: Indices) -> Indices:
    """The free speeds that the targets depend on, by themselves or through loops."""
    random = np.random.default_rng(0)
    postures = [guess, *(task.model.integrate(guess, random.uniform(-0.5, 0.5, task.model.nv)) for _ in range(2))]
    depends = np.any([task.jacobian(q) != 0.0 for q in postures], axis=0)
    rows = np.arange(len(depends)) < task.wishes
    while True:
        used = depends[rows].any(axis=0)
        connected = rows | depends[:, used].any(axis=1)
        if np.array_equal(connected, rows):
            return np.asarray(free[used[free]], dtype=np.intp)
        rows = connected


def _windows(model: Model, guess: Array, free: Indices, reach: float) -> tuple[Array, Array, list[slice]]:
    """Least and largest steps (nv) of coordinates whose rates are the speeds, and the speeds of whole rotations."""
    low, high, movable = np.zeros(model.nv), np.zeros(model.nv), set(free.tolist())
    kinds = model.record.measures.speed
    for i, k, lower, upper in coordinate_limits(model):
        if k not in movable or kinds[k] not in (ROTATION, TRANSLATION):
            continue
        far = np.pi if kinds[k] == ROTATION else (reach if np.isinf(upper - lower) else np.inf)
        low[k], high[k] = _window(lower - guess[i], upper - guess[i], far)
    turning = []
    for segment in model.record.segments:
        speeds = slice(segment.v + segment.translations, segment.v + segment.speeds)
        if segment.kind != "linear" and movable.issuperset(range(speeds.start, speeds.stop)):
            turning.append(speeds)
    return low, high, turning


def _window(lower: float, upper: float, far: float) -> tuple[float, float]:
    """The part of an interval about 0 within `far`, moved to keep its length where a limit is nearer."""
    low, high = max(lower, -far), min(upper, far)
    return max(lower, min(low, high - 2.0 * far)), min(upper, max(high, low + 2.0 * far))


def nearest_turns(task: Task, q: Array, guess: Array) -> Array:
    """The same posture (nq) with its angles turned by whole turns towards the guess, within their limits."""
    turned = np.array(q)
    for i, _, low, high in coordinate_limits(task.model):
        if task.model.record.periodic[i]:
            near = q[i] - _TURN * np.round((q[i] - guess[i]) / _TURN)
            turned[i] = near if low <= near <= high else q[i]
    if np.array_equal(turned, q):
        return q
    # Conditions on coordinates, as those of gears, tell one turn from another.
    same = np.abs(task.error(turned)).max(initial=0.0) <= max(2.0 * np.abs(task.error(q)).max(initial=0.0), 1e-12)
    return turned if same else q
