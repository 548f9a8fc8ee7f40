"""How fast we mean to be, and how fast we are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .models import REVERSE, TIMED_MODELS, Labelled
from .record import Entry, Record


@dataclass(frozen=True)
class Target(Labelled):
    """A ratio of medians, the peer's to that of the generated C, that is to be reached.

    Attributes:
        model, function, peer: Race that the target is of.
        least: The ratio.
        how: Generated C state by state, or by vectors, column by column.
        family: Family of the peer's compiler; "" for its best.
    """

    model: str
    function: str
    peer: str
    least: float
    how: Literal["state by state", "batch by columns"] = "state by state"
    family: str = ""


@dataclass(frozen=True)
class Verdict:
    """A target and what was found.

    Attributes:
        target: The target.
        entry: Race that measured it; None where there is none.
        ratio: Measured ratio; 0 where it was not measured.
        by_rows: The ratio of vectors row by row, beside that of columns.
    """

    target: Target
    entry: Entry | None
    ratio: float
    by_rows: float | None = None

    @property
    def met(self) -> bool:
        """Whether it is reached."""
        return self.ratio >= self.target.least

    @property
    def statement(self) -> str:
        """Met or missed, and by how much."""
        if self.entry is None:
            return "not measured"
        off = self.ratio / self.target.least - 1.0
        return f"met, {off:.0%} above" if self.met else f"missed by {-off:.0%}"


def _of(model: str, function: str, **least: float) -> list[Target]:
    return [Target(model, function, peer, ratio) for peer, ratio in least.items()]


_DERIVATIVES = ("inverse_dynamics_derivatives", "forward_dynamics_derivatives")
TARGETS: tuple[Target, ...] = (
    *_of("panda", "dynamics", pinocchio=7.0, mujoco=6.0, casadi=1.5),
    Target("panda", "dynamics", "pinocchio", 10.0, family="gcc"),
    *_of("ur5", "dynamics", pinocchio=7.0, mujoco=6.0, casadi=1.6),
    *_of("talos", "dynamics", pinocchio=6.5, mujoco=3.5, casadi=1.5),
    *_of("mss", "dynamics", pinocchio=3.5, mujoco=2.6, casadi=1.5),
    *_of("chain52", "dynamics", pinocchio=7.0, mujoco=1.5, casadi=1.5),
    *_of("panda", "forward_dynamics", pinocchio=4.5, mujoco=3.7),
    *_of("talos", "forward_dynamics", pinocchio=6.0, mujoco=2.8),
    *(t for n in (22, 32, 52) for t in _of(f"chain{n}", "forward_dynamics", pinocchio=6.0)),
    *(t for model in ("panda", "ur5") for name in _DERIVATIVES for t in _of(model, name, pinocchio=6.0)),
    *(t for model in ("talos", "mss") for name in _DERIVATIVES for t in _of(model, name, pinocchio=4.0)),
    *(t for name in _DERIVATIVES for t in _of("chain52", name, pinocchio=3.0)),
    *(t for model in ("panda", "ur5") for t in _of(model, "inverse_dynamics_second_derivatives", pinocchio=3.0)),
    Target("panda", "dynamics", "pinocchio", 45.0, "batch by columns"),
    Target("panda", "dynamics", "mujoco", 36.0, "batch by columns"),
    Target("mss", "dynamics", "pinocchio", 20.0, "batch by columns"),
    Target("chain52", "dynamics", "pinocchio", 14.0, "batch by columns"),
    *(Target(arm, name, "pinocchio", 15.0, "batch by columns") for arm in ("panda", "ur5") for name in _DERIVATIVES),
)


def verdicts(record: Record) -> list[Verdict]:
    """Verdict on each target against the peer's fastest build, whose choice does not depend on our times."""
    judged = []
    for target in TARGETS:
        entry = record.best(target.model, target.function, target.peer, target.family)
        in_columns = target.how == "batch by columns"
        ratio = None if entry is None else entry.columns_ratio if in_columns else entry.ratio
        by_rows = entry.batch_ratio if entry is not None and in_columns else None
        judged.append(Verdict(target, entry if ratio is not None else None, ratio or 0.0, by_rows))
    return judged


# A vector-Jacobian product takes at most so many times what its function takes.
MAX_REVERSE = 4.0


@dataclass(frozen=True)
class ReverseCost(Labelled):
    """A vector-Jacobian product beside its function.

    Attributes:
        model, function: Model, and name of the product.
        nv: Degrees of freedom of the model.
        own: Median of the function, nanoseconds a state.
        product: Likewise of the product.
    """

    model: str
    function: str
    nv: int
    own: float
    product: float

    @property
    def ratio(self) -> float:
        """The product's time over the function's."""
        return self.product / self.own

    @property
    def met(self) -> bool:
        """Whether the ratio is at most MAX_REVERSE."""
        return self.ratio <= MAX_REVERSE


def reverse_costs(record: Record) -> list[ReverseCost]:
    """Each vector-Jacobian product that was timed together with its function."""
    pairs = ((model, name, function) for name, function in REVERSE.items() for model in TIMED_MODELS)
    timed = ((x, y) for model, *names in pairs for x, y in [[record.cost(model, n, "symofros") for n in names]])
    return [ReverseCost(x.model, x.function, x.nv, y.time, x.time) for x, y in timed if x is not None and y is not None]
