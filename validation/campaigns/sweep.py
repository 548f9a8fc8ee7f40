"""Points of a sweep -> a table: a column for each parameter, and one for each result."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt
import pyarrow as pa

import symofros as sf

from ..inputs.cases import Case
from ..mechanics.geometry import Array
from .design import points_of
from .plan import SweepPlan

DONE = "done"
# Rate of growth relative to |s| that is more than rounding of an undamped mode.
GROWTH = 1e-7


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
        placed("held", np.zeros(model.nv), names.v, dict.fromkeys(plan.held, 0.0))
        self.u = placed("inputs", np.zeros(model.nu), names.u, plan.inputs)
        self.par = np.array([model.parameters[name] for name in names.par])

    @property
    def columns(self) -> list[str]:
        """Names of the results."""
        if self.plan.quantity == "frequencies":
            return [f"frequency_{k + 1}" for k in range(self.plan.modes)]  # [rad/s]
        return [f"{kind}:{name}" for kind in "qv" for name in getattr(self.model.names, kind)]

    def table(self, batch: int, first: int, count: int) -> pa.Table:
        """The points first ... first + count - 1; results of those that fail are null, `notes` empty without any."""
        plan = self.plan
        points = points_of(plan.over, plan.design, plan.points, plan.seed, first, count)
        par, u = self._spread(points)
        refused = [self._refusal(values) for values in par]
        allowed = np.array([not words for words in refused])
        results, outcomes, notes = np.full((count, len(self.columns)), np.nan), refused, [""] * count
        if allowed.any():
            evaluated = self._frequencies if plan.quantity == "frequencies" else self._motions
            results[allowed], ends, remarks = evaluated(par[allowed], u[allowed])
            for row, outcome, remark in zip(np.flatnonzero(allowed).tolist(), ends, remarks, strict=True):
                outcomes[row], notes[row] = outcome, "\n".join(remark)
        columns = {
            "batch": pa.array([batch] * count, pa.int64()),
            "point": pa.array(range(first, first + count), pa.int64()),
        }
        columns |= {f"over:{name}": pa.array(points[:, k]) for k, name in enumerate(plan.over)}
        columns |= {name: pa.array(results[:, k], from_pandas=True) for k, name in enumerate(self.columns)}
        return pa.table(columns | {"outcome": pa.array(outcomes, pa.string()), "notes": pa.array(notes, pa.string())})

    def _refusal(self, par: Array) -> str:
        """Why the description does not allow parameters (npar), in a line; empty where it does."""
        try:
            self.model.checked_parameters(par)
        except sf.ParameterError as error:
            return "; ".join(map(str.strip, str(error).splitlines()[:2]))
        return ""

    def _spread(self, points: Array) -> tuple[Array, Array]:
        """Parameters (n, npar) and inputs (n, nu) of points."""
        par, u = np.tile(self.par, (len(points), 1)), np.tile(self.u, (len(points), 1))
        for k, name in enumerate(self.plan.over):
            if name in self.model.names.par:
                par[:, self.model.names.par.index(name)] = points[:, k]
            else:
                u[:, self.model.names.u.index(name)] = points[:, k]
        return par, u

    def _frequencies(self, par: Array, u: Array) -> tuple[Array, list[str], list[list[str]]]:
        """Lowest frequencies about the equilibrium near the start [rad/s] (points, modes); outcomes, notes."""
        count = self.plan.modes
        frequencies, outcomes, notes = np.full((len(par), count), np.nan), [], [list[str]() for _ in par]
        for row, (values, inputs) in enumerate(zip(par, u, strict=True)):
            try:
                rest = sf.equilibrium(self.model, self.q, self.v, inputs, held=self.plan.held, par=values)
                modes = sf.modes(self.model, rest.q, rest.v, inputs, par=values)
            except sf.EquilibriumError as error:
                outcomes.append(str(error).partition("\n")[0])
                continue
            lowest = modes.frequencies[:count]
            frequencies[row, : len(lowest)] = lowest
            outcomes.append(DONE)
            found = dict.fromkeys((*rest.notes, *modes.notes))
            notes[row] = [*unlike_oscillations(modes.eigenvalues[:count]), *found]
        return frequencies, outcomes, notes

    def _motions(self, par: Array, u: Array) -> tuple[Array, list[str], list[list[str]]]:
        """Final q and v of the motions (points, nq + nv), NaN for those that end early; outcomes, notes."""
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
        each = [runs.outcome(k) for k in range(len(par))]
        outcomes = [DONE if outcome.ok else str(outcome) for outcome in each]
        return np.where(runs.ok[:, None], ends, np.nan), outcomes, [list(outcome.notes) for outcome in each]


def unlike_oscillations(eigenvalues: npt.NDArray[np.complex128]) -> Iterator[str]:
    """Which of the frequencies |s| are none of a lasting or decaying oscillation, by eigenvalues s [1/s]."""
    for k, s in enumerate(eigenvalues.tolist()):
        if s != 0.0 and (s.imag == 0.0 or s.real > GROWTH * abs(s)):
            how = "without oscillation" if s.imag == 0.0 else "as it oscillates"
            yield f"frequency_{k + 1}: {'grows' if s.real > 0.0 else 'decays'} at {abs(s.real):.6g} 1/s {how}"


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
