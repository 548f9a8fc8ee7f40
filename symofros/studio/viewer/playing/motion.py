"""Motion: states over time that are to be shown, of a run or of a file."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array, numeric
from symofros.base.names import TIME, symbol_of
from symofros.errors import Problem, ShapeError, SymofrosError
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.results.csv_columns import read_csv, refuse_doubled
from symofros.simulation.results.npz import TooLargeError, read_npz
from symofros.simulation.results.trajectory import Trajectory

SUFFIXES = (".npz", ".csv", ".parquet")
# Half a gigabyte.
MAX_NUMBERS = 64_000_000
# Coordinate beyond which a motion has diverged, and component below which a quaternion has no direction: their squares
# are numbers.
_LARGEST, _SHORTEST = 1e100, 1e-100


@dataclass(frozen=True)
class PlayedMotion:
    """States over time.

    Attributes:
        model: Model whose configuration manifold the motion follows.
        t: Times, rising (n) [s].
        q: Configurations (n, nq).
        u: Inputs, for prescribed motions (n, nu).
        par: Run-time parameters (n, npar), which actions of events change.
    """

    model: Model
    t: Array
    q: Array
    u: Array
    par: Array

    @property
    def start(self) -> float:
        """First time [s]."""
        return float(self.t[0])

    @property
    def end(self) -> float:
        """Last time [s]."""
        return float(self.t[-1])

    def at(self, times: ArrayLike) -> tuple[Array, Array, Array]:
        """Coordinates (..., nq), inputs (..., nu) and parameters (..., npar) at times (...,).

        Coordinates are interpolated along the manifold; parameters are those of the last state by then.
        """
        times = np.asarray(times, dtype=np.float64)
        last = np.clip(np.searchsorted(self.t, times, side="right") - 1, 0, len(self.t) - 1)
        par = self.par[last]
        if len(self.t) == 1:
            return self.q[last], self.u[last], par
        i = np.minimum(last, len(self.t) - 2)
        gap = self.t[i + 1] - self.t[i]
        # Two states at one time stand before and after an event.
        share = np.clip((times - self.t[i]) / np.where(gap > 0.0, gap, 1.0), 0.0, 1.0)[..., None]
        q = self.model.integrate(self.q[i], share * self.model.difference(self.q[i], self.q[i + 1]))
        return q, self.u[i] + share * (self.u[i + 1] - self.u[i]), par


class States(NamedTuple):
    """States over time of a mechanism that is yet to be compiled: t (n), q (n, nq), u (n, nu).

    Its run-time parameters are par (npar), or those of each state (n, npar).
    """

    t: ArrayLike
    q: ArrayLike
    u: ArrayLike | None = None
    par: ArrayLike | None = None


Played = Trajectory | PlayedMotion | States | tuple[ArrayLike, ArrayLike]


def motion_of(model: Model, given: Played) -> PlayedMotion:
    """A run, or times (n) and configurations (n, nq), as a motion of a model.

    Raises:
        ShapeError: It does not fit the model.
    """
    if isinstance(given, PlayedMotion):
        return _checked(model, given.t, given.q, given.u, given.par, "motion")
    if isinstance(given, Trajectory):
        if given.model.names.q != model.names.q:
            _refuse(
                "trajectory",
                f"coordinates {_some(given.model.names.q)}",
                f"the model's are {_some(model.names.q)}",
                "show it with the system that it was simulated with",
            )
        par = given.par_over_time if given.changes else given.par
        return _checked(model, given.t, given.q, given.u, par, "trajectory")
    if isinstance(given, States):
        return _checked(model, *given, "motion")
    if not isinstance(given, tuple | list) or len(given) != 2:
        stated = f"{type(given).__name__} {given!r:.60}"
        _refuse("motion", stated, "a trajectory, or times (n) and coordinates (n, nq)", "for example (run.t, run.q)")
    t, q = given
    return _checked(model, t, q, None, None, "motion")


def read_motion(path: str | Path, model: Model) -> PlayedMotion:
    """A motion from a file that `Trajectory.save` wrote, or one like it.

    Args:
        path: .npz with t (n), q (n, nq) and, if it has them, u, par, par_over_time, names_q; .csv or .parquet with
            columns t and the coordinates' names and, where motions are prescribed, the inputs'.
        model: Model that moves.

    Raises:
        SymofrosError: There is no such file, or it can't be read.
        ShapeError: It does not fit the model.
    """
    file = Path(path)
    if file.suffix not in SUFFIXES:
        raise SymofrosError(
            f"trajectory: can't read '{file.name}'",
            file.suffix or "no suffix",
            f"one of {', '.join(SUFFIXES)}",
            "save it with Trajectory.save",
        )
    if not file.is_file():
        raise SymofrosError(
            f"trajectory: '{file}' does not exist",
            "no such file",
            "a trajectory is an existing file",
            "check the path; `symofros simulate MODEL T -o FILE` writes one",
        )
    readers = {".npz": _read_arrays, ".csv": _read_csv, ".parquet": _read_parquet}
    try:
        return readers[file.suffix](file, model)
    except ShapeError:
        raise
    except TooLargeError as error:
        what, rule = f"trajectory: '{file.name}' is too large", f"at most {MAX_NUMBERS} numbers are shown"
        raise SymofrosError(what, str(error)[:200], rule, "save fewer states") from None
    # NotImplementedError: a compression or an encoding that the reader of Parquet files does not know.
    except (OSError, ValueError, csv.Error, NotImplementedError, MemoryError) as error:
        fault = Problem(
            f"trajectory: '{file.name}' is not a {file.suffix} file",
            str(error)[:200],
            "a file of the form that Trajectory.save writes",
            "save it again",
        )
        raise SymofrosError(fault) from None


def _read_arrays(file: Path, model: Model) -> PlayedMotion:
    arrays = read_npz(file, MAX_NUMBERS, ("t", "q", "u", "par", "par_over_time", "names_q"))
    for name in ("t", "q"):
        if name not in arrays:
            _refuse(file.name, f"arrays {_some(tuple(arrays))}", "arrays t (n) and q (n, nq)", f"add {name}")
    names = tuple(arrays["names_q"].tolist()) if "names_q" in arrays else model.names.q
    if names != model.names.q:
        _refuse(
            file.name,
            f"coordinates {_some(names)}",
            f"the model's are {_some(model.names.q)}",
            "show it with the model that it was simulated with",
        )
    par = arrays.get("par_over_time", arrays.get("par"))
    return _checked(model, arrays["t"], arrays["q"], arrays.get("u"), par, file.name)


def _read_csv(file: Path, model: Model) -> PlayedMotion:
    return _from_columns(read_csv(file, MAX_NUMBERS), file, model)


def _read_parquet(file: Path, model: Model) -> PlayedMotion:
    try:
        parquet = import_module("pyarrow.parquet")
    except ImportError:
        raise SymofrosError.of_extra(
            "trajectory: Parquet needs pyarrow", "it is not installed", "pyarrow reads Parquet", "parquet", "use .npz"
        ) from None
    with parquet.ParquetFile(file) as stored:
        wanted = {TIME, *map(symbol_of, model.names.q), *model.names.u, *(f"u.{name}" for name in model.names.u)}
        columns = [name for name in stored.schema_arrow.names if name in wanted]
        refuse_doubled(columns)
        # A column of one value, repeated, takes a few bytes whatever its length.
        if stored.metadata.num_rows * len(columns) > MAX_NUMBERS:
            raise TooLargeError(f"{stored.metadata.num_rows} rows of {len(columns)} columns")
        table = stored.read(columns)
    return _from_columns({name: table[name].to_numpy() for name in table.column_names}, file, model)


def _from_columns(columns: Mapping[str, Array], file: Path, model: Model) -> PlayedMotion:
    missing = [name for name in (TIME, *map(symbol_of, model.names.q)) if name not in columns]
    if missing:
        _refuse(
            file.name,
            f"columns {_some(tuple(columns))}",
            f"a column for t and each of {_some(model.names.q)}",
            f"missing: {_some(missing)}; is it a motion of this model?",
        )
    n = len(columns["t"])
    u = np.tile(np.array(model.record.u_default), (n, 1))
    for i, name in enumerate(model.names.u):
        column = f"u.{name}" if f"u.{name}" in columns else name
        if column in columns and column not in model.names.q:
            u[:, i] = numeric(f"{file.name}: {column}", columns[column])
    q = np.empty((n, model.nq))
    for i, name in enumerate(model.names.q):
        q[:, i] = numeric(f"{file.name}: {name}", columns[symbol_of(name)])
    return _checked(model, columns[TIME], q, u, None, file.name)


def _checked(
    model: Model, t: ArrayLike, q: ArrayLike, u: ArrayLike | None, par: ArrayLike | None, what: str
) -> PlayedMotion:
    t, q = (numeric(f"{what}: {name}", model.by_name(name, values)) for name, values in (("t", t), ("q", q)))
    n = t.size
    u = np.tile(np.array(model.record.u_default), (n, 1)) if u is None else numeric(f"{what}: u", model.by_name("u", u))
    par = np.array(model.parameter_values) if par is None else numeric(f"{what}: par", model.by_name("par", par))
    for name, array, shape in (
        ("t", t, (n,)),
        ("q", q, (n, model.nq)),
        ("u", u, (n, model.nu)),
        ("par", par, (model.npar,) if par.ndim == 1 else (n, model.npar)),
    ):
        if array.shape != shape:
            _refuse(
                what,
                f"{name} {array.shape}",
                f"{name} has shape {shape}: nq is {model.nq}, nu {model.nu}, npar {model.npar}",
                "show it with the model that it was simulated with",
            )
    if not np.isfinite(t).all():
        found = f"time {int(np.argmin(np.isfinite(t)))} of {n} is missing or not finite"
        _refuse(what, found, "each state has its time", "leave out states without a time")
    # A run that diverged ends in states that can't be drawn.
    finite = np.isfinite(t) & np.isfinite(q).all(axis=1) & np.isfinite(u).all(axis=1) & _drawable(model, q)
    count = n if finite.all() else int(np.argmin(finite))
    if not count:
        _refuse(
            what,
            f"{n} states, the first not finite" if n else "no states",
            "one finite state at least",
            "look at how the run ended",
        )
    if np.any(np.diff(t[:count]) < 0.0):
        _refuse(what, "times that fall", "times rise from state to state", "sort the states by time")
    # Those of other simulators may have left unit length.
    par = np.broadcast_to(par, (n, model.npar))[:count]
    return PlayedMotion(model, t[:count], model.normalized(q[:count]), u[:count], par)


def _drawable(model: Model, q: Array) -> npt.NDArray[np.bool_]:
    """Whether each configuration (n, nq) can be drawn: of a motion's size, no quaternion of length zero."""
    drawable: npt.NDArray[np.bool_] = np.all(np.abs(q) <= _LARGEST, axis=1)
    for segment in model.record.segments:
        if segment.kind != "linear":
            first = segment.q + segment.translations
            drawable &= np.any(np.abs(q[:, first : first + 4]) > _SHORTEST, axis=1)
    return drawable


def finite(name: str, value: float) -> float:
    """A finite number.

    Raises:
        SymofrosError: It is none.
    """
    if not np.isfinite(value):
        raise SymofrosError(f"view: no such {name}", repr(value), f"{name} is a finite number", "give another")
    return float(value)


def positive(name: str, value: float) -> float:
    """A finite number above 0.

    Raises:
        SymofrosError: It is none.
    """
    if not (np.isfinite(value) and value > 0.0):
        raise SymofrosError(f"view: no such {name}", repr(value), f"{name} is a finite number above 0", "give another")
    return float(value)


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:8]) + (", …" if len(names) > 8 else "")


def _refuse(what: str, found: str, rule: str, remedy: str) -> NoReturn:
    raise ShapeError(f"{what}: does not fit the model", found, rule, remedy)
