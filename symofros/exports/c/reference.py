"""Reference points of a self-test: every function at random states, by the interpreter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import normalized
from symofros.exports.material import Check
from symofros.runtime import manifold
from symofros.runtime.calls import Kernel
from symofros.runtime.record import ModelRecord

POINTS = 2
_SEED = 20261121
# Newton's iteration is a matter of where it starts: near the constraints both ways take the same steps.
_NEAR = 1e-3


def checks(
    record: ModelRecord, kernels: Mapping[tuple[str, str], Kernel], order: Sequence[tuple[str, str]], closed: Array
) -> tuple[Check, ...]:
    """Inputs and outputs of each function at each point.

    Args:
        record: Names, sizes, defaults.
        kernels: Interpreted.
        order: Order of the functions.
        closed: A configuration on the constraints (nq), near which `project` starts.
    """
    rng = np.random.default_rng(_SEED)
    points = [_point(record, rng) for _ in range(POINTS)]
    par = np.array(record.par_default, dtype=np.float64).reshape(1, -1)
    rows = []
    for key in order:
        kernel = kernels[key]
        pre = kernel.prepare(par)
        for point in points:
            given = dict(point)
            if key[0] == "project":
                move = _NEAR * rng.standard_normal(len(record.v_names))
                given["q"] = manifold.integrate(record.segments, closed, move)
                given["u"] = np.array(record.u_default, dtype=np.float64)  # Which prescribe where that is closed.
            for name, size in kernel.signature.inputs:
                if name not in given:  # Cotangents, directions: any numbers.
                    given[name] = rng.standard_normal(size)
            inputs = [np.ascontiguousarray(given[name].reshape(1, -1)) for name, _ in kernel.signature.inputs]
            outputs = kernel.run(1, pre, inputs)
            rows.append(Check(_flat(inputs), _flat(outputs)))
    return tuple(rows)


def _flat(arrays: Sequence[Array]) -> tuple[float, ...]:
    return tuple(float(x) for array in arrays for x in np.asarray(array).ravel())


def _point(record: ModelRecord, rng: np.random.Generator) -> dict[str, Array]:
    q, v = manifold.random_state(record, rng)
    nv, nc = len(record.v_names), record.nc
    u = rng.standard_normal(len(record.u_default))
    for first in record.quaternion_inputs:
        u[first : first + 4] = normalized(u[first : first + 4])
    return {
        "q": q,
        "v": v,
        "a": rng.standard_normal(nv),
        "u": u,
        "lam": rng.standard_normal(nc),
        "gains": rng.uniform(0.0, 5.0, 2 * nc),
        "t": np.array([0.25]),
    }
