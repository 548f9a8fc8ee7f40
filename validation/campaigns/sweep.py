"""Points of a sweep -> a table: a column for each parameter, and one for each result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pyarrow as pa

import symofros as sf

from ..inputs.cases import Case
from ..mechanics.geometry import Array
from .design import points_of
from .plan import SweepPlan

DONE = "done"


class Sweeper:
    """One model, ready to be evaluated at points of a plan.

    Args:
        plan: Plan to evaluate.
        case: The model.

    Raises:
        SymofrosError: The model can't be made.
        UnknownNameError: The plan names what it does not have.
        OSError: The file of the model can't be read.
    """

    def __init__(self, plan: SweepPlan, case: Case) -> None:
        self.plan = plan
        self.model = model = sf.compile(case.load().system)
        names = model.names
        for name in plan.over:
            if (name in names.par) == (name in names.u):
                kind = "both a parameter and an input" if name in names.u else "no parameter and no input"
                listed = ", ".join((*names.par, *names.u)) or "there are none"
                raise sf.UnknownNameError(
                    f"over.{name}: '{name}' is {kind} of '{case.label}'; to choose from: {listed}"
                )
        self.q = placed("start.q", model.neutral(), names.q, plan.start.get("q", {}))
        self.v = placed("start.v", np.zeros(model.nv), names.v, plan.start.get("v", {}))
        self.u = placed("inputs", np.zeros(model.nu), names.u, plan.inputs)
        self.par = np.array([model.parameters[name] for name in names.par])

    @property
    def columns(self) -> list[str]:
        """Names of the results."""
        if self.plan.quantity == "frequencies":
            return [f"frequency_{k + 1}" for k in range(self.plan.modes)]  # [rad/s]
        return [f"{kind}:{name}" for kind in "qv" for name in getattr(self.model.names, kind)]

    def table(self, batch: int, first: int, count: int) -> pa.Table:
        """The points first ... first + count - 1; results of those that fail are null."""
        plan = self.plan
        points = points_of(plan.over, plan.design, plan.points, plan.seed, first, count)
        par, u = self._spread(points)
        results, outcomes = (self._frequencies if plan.quantity == "frequencies" else self._motions)(par, u)
        columns = {
            "batch": pa.array([batch] * count, pa.int64()),
            "point": pa.array(range(first, first + count), pa.int64()),
        }
        columns |= {f"over:{name}": pa.array(points[:, k]) for k, name in enumerate(plan.over)}
        columns |= {name: pa.array(results[:, k], from_pandas=True) for k, name in enumerate(self.columns)}
        return pa.table(columns | {"outcome": pa.array(outcomes, pa.string())})

    def _spread(self, points: Array) -> tuple[Array, Array]:
        """Parameters (n, npar) and inputs (n, nu) of points."""
        par, u = np.tile(self.par, (len(points), 1)), np.tile(self.u, (len(points), 1))
        for k, name in enumerate(self.plan.over):
            if name in self.model.names.par:
                par[:, self.model.names.par.index(name)] = points[:, k]
            else:
                u[:, self.model.names.u.index(name)] = points[:, k]
        return par, u

    def _frequencies(self, par: Array, u: Array) -> tuple[Array, list[str]]:
        """Lowest frequencies about the equilibrium near the start [rad/s] (points, modes), ascending, and outcomes."""
        frequencies, outcomes = np.full((len(par), self.plan.modes), np.nan), []
        for row, (values, inputs) in enumerate(zip(par, u, strict=True)):
            try:
                rest = sf.equilibrium(self.model, self.q, self.v, inputs, held=self.plan.held, par=values)
                lowest = sf.modes(self.model, rest.q, rest.v, inputs, par=values).frequencies[: self.plan.modes]
            except sf.EquilibriumError as error:
                outcomes.append(str(error).partition("\n")[0])
                continue
            frequencies[row, : len(lowest)] = lowest
            outcomes.append(DONE)
        return frequencies, outcomes

    def _motions(self, par: Array, u: Array) -> tuple[Array, list[str]]:
        """Final q and v of the motions (points, nq + nv), NaN for those that end early, and outcomes."""
        motion = self.plan.motion
        assert motion is not None  # A plan of end states has one.
        shape = (len(par), 1)
        runs = sf.simulate_batch(
            self.model,
            np.tile(self.q, shape),
            np.tile(self.v, shape),
            motion.t_end,
            u=u,
            method=motion.method,
            dt=motion.dt,
            par=par,
        )
        ends = np.concatenate([runs.q[:, -1], runs.v[:, -1]], axis=1)
        outcomes = [DONE if ok else str(runs.outcome(k)) for k, ok in enumerate(runs.ok)]
        return np.where(runs.ok[:, None], ends, np.nan), outcomes


def placed(where: str, values: Array, names: Sequence[str], given: Mapping[str, float]) -> Array:
    """A copy of the values with the named ones replaced.

    Raises:
        UnknownNameError: A name is none of them.
    """
    placed = np.array(values, float)
    for name, value in given.items():
        if name not in names:
            raise sf.UnknownNameError(f"{where}: no '{name}'; there are {', '.join(names) or 'none'}")
        placed[names.index(name)] = value
    return placed
