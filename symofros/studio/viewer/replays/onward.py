"""What lets a replay simulate on: the model as WebAssembly in a page of its own, and states to begin at."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description import System
from symofros.errors import SymofrosError
from symofros.exports.exporting import export
from symofros.simulation.results.trajectory import Trajectory
from symofros.simulation.stepping.methods import METHODS

# How a simulation steps: as of `export`.
Stepping = Mapping[str, Any]
_STEPPING = ("method", "dt", "rtol", "atol", "beam_limit")


def onward(system: System, run: object, t: Array, q: Array, stepping: Stepping) -> dict[str, Any]:
    """Data with which the page of a replay continues the simulation.

    Args:
        system: System that moved.
        run: Its trajectory.
        t: Times of the pictures (n) [s].
        q: Coordinates in the pictures (n, nq).
        stepping: Any of `method`, `dt`, `rtol`, `atol`, `beam_limit`, as of `export`; the method is the run's unless
            stated, where a package has it.

    Returns:
        The page as text; coordinates, speeds and inputs of each picture, doubles in base64; parameters.

    Raises:
        SymofrosError: The motion has no speeds, events set its parameters, or the stepping is none.
        CompileError: The package ziglang is missing, or refused.
    """
    if not isinstance(run, Trajectory):
        raise SymofrosError(
            "record: the page can't simulate on",
            f"a motion of {type(run).__name__}",
            "a state has speeds, too: those of a Trajectory of sf.simulate",
            "leave simulate out, or record a trajectory",
        )
    if run.changes:
        found, rule = "parameters that events set", "the page has one set of parameters, and no events"
        raise SymofrosError(
            "record: the page can't simulate on", found, rule, "leave simulate out: the replay has them"
        )
    unknown = sorted(set(stepping) - set(_STEPPING))
    if unknown:
        raise SymofrosError("record: simulate", ", ".join(unknown), f"any of {', '.join(_STEPPING)}", "leave it out")
    method = METHODS.get(run.statistics.method)
    own = {} if method is None or method.family.multistep else {"method": run.statistics.method}
    ends = {name: None for name, event in system.events.items() if event.terminal}  # The page goes on there.
    with tempfile.TemporaryDirectory() as folder:
        export(system, "wasm", Path(folder) / "page", events=ends, **{**own, **stepping})
        page = (Path(folder) / "page" / "index.html").read_text(encoding="utf-8")
    states = {"q": q, "v": _at(t, run.t, run.v), "u": _at(t, run.t, run.u)}
    doubles = {name: np.ascontiguousarray(values, dtype="<f8").tobytes() for name, values in states.items()}
    return {
        "page": page,
        "par": [float(x) for x in run.par],
        **{name: base64.b64encode(raw).decode() for name, raw in doubles.items()},
    }


def _at(t: Array, known: Array, values: Array) -> Array:
    """Columns (n, k) at times t, interpolated linearly from those at known times."""
    columns = [np.interp(t, known, column) for column in values.T]
    return np.stack(columns, axis=1) if columns else np.zeros((len(t), 0))
