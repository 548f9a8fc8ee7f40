"""Whether the inputs that prescribe a motion belong to one motion: each speed is the rate of its position.

docs/theory/simulation.md, section 1. The equations of motion take position, speed and acceleration of a prescribed
joint as they are given. A speed that is not the rate of its position makes a motion that no mechanism has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import (
    conjugate,
    normalized,
    quaternion_exp,
    quaternion_log,
    quaternion_product,
    rotate,
)
from symofros.errors import Problem, SymofrosError
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord
from symofros.simulation.inputs import InputPlan

# Largest difference between a rate and what its integral changes by, as a share of the larger of them: of formulas,
# which differences resolve to some 1e-6; of samples, whose chords miss a tenth of a sine with eight samples a period.
OF_FORMULAS, OF_SAMPLES = 1e-3, 0.2
# Instants at which formulas are looked at; half the way between the two values of a difference, as a share of the run,
# and the longer one that a contradiction must stand; its least share of the time, whose rounding is a 1e-4 of it.
_INSTANTS, _HALF, _LONGER, _OF_TIME = 16, 1e-7, 1e-5, 4e-12
# Intervals between samples that are looked at, evenly chosen of all.
_INTERVALS = 400
# Parts of a run in which formulas are asked for jumps; share of what the position changes by from which one counts; how
# many are followed, what of a jump is left where it is, and how near that is, as a share of the part.
_PARTS, _JUMP, _FOLLOWED, _LEFT, _BESIDE = 128, 1e-4, 4, 0.5, 1e-9


class Rated(NamedTuple):
    """An input that is the rate of others.

    Attributes:
        position: Indices of what it is a rate of: one number, the four of a quaternion, or the seven of a free joint.
        rate: Indices of the rate: one number, or three of an angular velocity or a velocity in body axes.
    """

    position: tuple[int, ...]
    rate: tuple[int, ...]

    @property
    def follows(self) -> bool:
        """Whether the rate follows from a formula of the position."""
        return len(self.position) == 1

    def names(self, u_names: Sequence[str], axis: int) -> tuple[str, str]:
        """The position and the rate of an axis by name, of a quaternion its first number."""
        return u_names[self.position[axis if len(self.position) == 7 else 0]], u_names[self.rate[axis]]

    def mean(self, before: Array, after: Array, span: float) -> Array:
        """The mean rate between two values of all inputs."""
        p, q = before[list(self.position)], after[list(self.position)]
        if len(self.position) == 1:
            return np.asarray((q - p) / span, dtype=np.float64)
        turns = p[-4:], q[-4:]
        if not (np.linalg.norm(turns[0]) > 0.0 and np.linalg.norm(turns[1]) > 0.0):
            return np.full(3, np.nan)  # No rotation, which the run says.
        back, ahead = conjugate(normalized(turns[0])), normalized(turns[1])
        turned = quaternion_log(quaternion_product(back, ahead))
        if len(self.position) == 4:
            return np.asarray(turned / span, dtype=np.float64)
        half = quaternion_product(conjugate(quaternion_exp(0.5 * turned)), back)  # From the world to the middle.
        return np.asarray(rotate(half, (q[:3] - p[:3]) / span), dtype=np.float64)


class Contradiction(NamedTuple):
    """Where a rate and what it is a rate of differ.

    Attributes:
        position: Name of an input.
        rate: Name of that which should be its rate.
        t: Time [s].
        stated: The rate that is given there.
        found: The rate of the position there.
        follows: Whether the rate follows from a formula of the position.
    """

    position: str
    rate: str
    t: float
    stated: float
    found: float
    follows: bool

    @property
    def problem(self) -> Problem:
        """In words."""
        remedy = (
            f"give '{self.position}' as a formula of t alone, whose rates follow ('0.3*t' for a speed of 0.3), or "
            "rates that belong to it"
            if self.follows
            else f"give '{self.rate}' and the other speeds of this joint, in its own axes: of ball and free joints "
            "they do not follow from positions"
        )
        return Problem(
            f"inputs '{self.position}' and '{self.rate}' prescribe no one motion",
            f"at t = {self.t:.4g} s '{self.rate}' is {self.stated:.4g}, and '{self.position}' changes at "
            f"{self.found:.4g}",
            f"'{self.rate}' is the rate of '{self.position}', and the joint is where '{self.position}' says",
            remedy,
        )


class Jump(NamedTuple):
    """Where a prescribed position or speed jumps.

    Attributes:
        name: Name of the input.
        t: Time [s].
        size: What it changes by.
    """

    name: str
    t: float
    size: float

    @property
    def problem(self) -> Problem:
        """In words."""
        return Problem(
            f"input '{self.name}' prescribes a motion that jumps",
            f"at t = {self.t:.6g} s '{self.name}' changes by {self.size:.4g} within an instant",
            "prescribed positions and speeds are continuous: a jump takes an impulse, which moves what is free, and no "
            "step has one",
            "round the corner, as by a ramp (1 - cos(pi*t/T))/2 that begins and ends at rest; or end the run there and "
            "begin another one from the speeds after the impulse",
        )


def rated_inputs(record: ModelRecord) -> list[Rated]:
    """The inputs that are rates of others: of each prescribed joint."""
    names, first = record.u_names, len(record.u_names) - record.driven
    at = {name: i for i, name in enumerate(names) if i >= first}
    found = [Rated((at[name],), (at[f"d{name}"],)) for name in at if f"d{name}" in at]
    for i in record.quaternion_inputs:
        owner = names[i].rpartition(".")[0]
        turn = tuple(range(i, i + 4))
        place, velocity, spin = (
            tuple(at[name] for x in "xyz" if (name := f"{owner}.{kind}{x}") in at) for kind in ("p", "v", "w")
        )
        found += [Rated(turn, spin)] if len(spin) == 3 else []
        found += [Rated((*place, *turn), velocity)] if len(place) == len(velocity) == 3 else []
    return found


def contradiction(
    model: Model, plan: InputPlan, inputs_at: Callable[[float], Array], span: tuple[float, float]
) -> Contradiction | Jump | None:
    """The first prescribed motion whose inputs contradict each other; of functions in Python nothing is known before.

    Args:
        model: Model with prescribed joints.
        plan: Its inputs, by how they are evaluated.
        inputs_at: All inputs (nu) at a time.
        span: Start and end of the run [s].
    """
    if not model.record.driven or plan.callback is not None or not span[1] > span[0]:
        return None
    times = {index: t for index, t, _, _ in plan.signals}
    for rated in rated_inputs(model.record):
        sampled = [times[i] for i in (*rated.position, *rated.rate) if i in times]
        if sampled:
            found = _compared(model, rated, inputs_at, _between_samples(sampled, span), OF_SAMPLES)
        else:
            # Terms that nearly cancel round by more than the position tells: over longer intervals that is less.
            found = _compared(model, rated, inputs_at, _around_instants(span, _HALF), OF_FORMULAS)
            found = found and _compared(model, rated, inputs_at, _around_instants(span, _LONGER), OF_FORMULAS)
        if found is not None:
            return found
    return _jump(model, plan, inputs_at, span)


def refuse_contradiction(found: Contradiction | Jump | None) -> None:
    """Refuse a motion whose inputs contradict each other.

    Raises:
        SymofrosError: It does.
    """
    if found is not None:
        raise SymofrosError(found.problem)


def recorded_notes(record: ModelRecord, t: Array, u: Array) -> tuple[str, ...]:
    """A remark on recorded inputs (n, nu) that prescribe no one motion; nothing was known of them before the run."""
    if not record.driven or len(t) < 3:
        return ()
    for rated in rated_inputs(record):
        chosen = _evenly(np.arange(len(t) - 1.0)).astype(int)
        means = np.array([rated.mean(u[k], u[k + 1], t[k + 1] - t[k]) for k in chosen if t[k + 1] > t[k]])
        stated = np.array([0.5 * (u[k] + u[k + 1])[list(rated.rate)] for k in chosen if t[k + 1] > t[k]])
        scale = _largest(means, stated)
        # Records may be far apart: only what differs nearly everywhere is no chord's fault.
        if len(means) and np.median(np.abs(means - stated).max(axis=1)) > OF_SAMPLES * scale > 0.0:
            position, rate = rated.names(record.u_names, int(np.argmax(np.abs(means - stated).max(axis=0))))
            return (
                f"inputs '{position}' and '{rate}' prescribe no one motion: '{rate}' is not the rate of '{position}'",
            )
    return ()


def _jump(model: Model, plan: InputPlan, inputs_at: Callable[[float], Array], span: tuple[float, float]) -> Jump | None:
    """The first jump of a position or speed that a formula prescribes: its change is no integral of its rate (3f)."""
    sampled = {index for index, *_ in plan.signals}
    pairs = [
        [rated.position[0], rated.rate[0]]
        for rated in rated_inputs(model.record)
        if len(rated.position) == 1 and rated.position[0] in plan.formulas and rated.rate[0] not in sampled
    ]
    if not pairs:
        return None
    times = np.linspace(*span, 2 * _PARTS + 1)
    values = np.array([inputs_at(t) for t in times.tolist()])  # Rows are copied: inputs share their memory.
    jumps = list[Jump]()
    for pair in pairs:
        p, s = values[:, pair].T
        if not (np.isfinite(p).all() and np.isfinite(s).all()):  # Which the run says.
            continue
        missed = np.abs(np.diff(p[::2]) - (times[2] - times[0]) / 6.0 * (s[:-1:2] + 4.0 * s[1::2] + s[2::2]))
        counts = _JUMP * float(np.abs(p - p[0]).max())
        for k in np.argsort(-missed, kind="stable")[:_FOLLOWED]:
            if missed[k] > counts > 0.0:
                t, size = _followed(inputs_at, pair, float(times[2 * k]), float(times[2 * k + 2]))
                if abs(size) > max(_LEFT * missed[k], counts):
                    jumps.append(Jump(model.names.u[pair[0]], t, size))
    return min(jumps, key=lambda jump: jump.t, default=None)


def _followed(inputs_at: Callable[[float], Array], pair: Sequence[int], a: float, b: float) -> tuple[float, float]:
    """Where in an interval a value leaves the integral of its rate most, by halving, and by how much it changes there.

    Args:
        inputs_at: All inputs at a time.
        pair: Indices of the value and of its rate.
        a: Start [s].
        b: End [s].
    """
    beside = max(_BESIDE * (b - a), 8.0 * float(np.spacing(max(abs(a), abs(b)))))
    (p_a, s_a), (p_b, s_b) = inputs_at(a)[pair], inputs_at(b)[pair]
    while b - a > beside:
        m = 0.5 * (a + b)
        p_m, s_m = inputs_at(m)[pair]
        before = abs(p_m - p_a - 0.5 * (m - a) * (s_a + s_m))
        if not before <= abs(p_b - p_m - 0.5 * (b - m) * (s_m + s_b)):
            b, p_b, s_b = m, p_m, s_m
        else:
            a, p_a, s_a = m, p_m, s_m
    return 0.5 * (a + b), float(inputs_at(b + beside)[pair[0]] - inputs_at(a - beside)[pair[0]])


def _compared(
    model: Model,
    rated: Rated,
    inputs_at: Callable[[float], Array],
    intervals: Sequence[tuple[float, float]],
    tolerance: float,
) -> Contradiction | None:
    """Largest difference of the mean rate over an interval from the rate in its middle; None within the tolerance."""
    middles = [0.5 * (a + b) for a, b in intervals]
    # Inputs share their memory.
    ends = [(inputs_at(a).copy(), inputs_at(b).copy()) for a, b in intervals]
    means = np.array([rated.mean(*values, b - a) for values, (a, b) in zip(ends, intervals, strict=True)])
    stated = np.array([inputs_at(t).copy()[list(rated.rate)] for t in middles])
    rounding = np.array(
        [
            np.abs(p[list(rated.position)]).max() * 1e-14 / (b - a)
            for (p, _), (a, b) in zip(ends, intervals, strict=True)
        ]
    )
    scale = _largest(means, stated)
    differ = np.nan_to_num(np.abs(means - stated) - rounding[:, None])
    if not differ.max(initial=0.0) > tolerance * scale:
        return None
    k, axis = (int(i) for i in np.unravel_index(int(np.argmax(differ)), differ.shape))
    found = float(stated[k, axis]), float(means[k, axis])
    return Contradiction(*rated.names(model.names.u, axis), middles[k], *found, rated.follows)


def _largest(means: Array, stated: Array) -> float:
    """The largest rate of all that are numbers."""
    return max(float(np.nanmax(np.abs(means), initial=0.0)), float(np.abs(stated).max(initial=0.0)))


def _around_instants(span: tuple[float, float], share: float) -> list[tuple[float, float]]:
    """Intervals around instants that are drawn, the same for the same run; half of one: a share of the run."""
    begin, end = span
    half = max(share * (end - begin), _OF_TIME * max(abs(begin), abs(end)))
    instants = begin + half + (end - begin - 2.0 * half) * np.random.default_rng(0).random(_INSTANTS)
    return [(float(t - half), float(t + half)) for t in instants]


def _between_samples(sampled: Sequence[Array], span: tuple[float, float]) -> list[tuple[float, float]]:
    """Intervals between neighbouring samples within the run, and before and after them."""
    begin, end = span
    times = np.unique(np.concatenate([[begin, end], *sampled]))
    times = times[(times >= begin) & (times <= end)]
    pairs = np.array([times[:-1], times[1:]]).T
    pairs = pairs[np.diff(pairs)[:, 0] > 1e-12 * max(abs(begin), abs(end))]
    return [(float(a), float(b)) for a, b in _evenly(pairs)]


def _evenly(rows: Array) -> Array:
    """Evenly spaced rows, at most _INTERVALS, the first and last included."""
    if len(rows) <= _INTERVALS:
        return rows
    return np.asarray(rows[np.linspace(0, len(rows) - 1, _INTERVALS).astype(int)])
