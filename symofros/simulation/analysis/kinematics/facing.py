"""Whether closures are closed the right way round: conditions on rotations vanish half a turn away, too.

docs/theory/constraints.md, (5a). Whatever takes a posture from outside asks here; a motion by steps can't reach the
opposite posture, as its conditions are regular up to a right angle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import normalized, quaternion_matrix
from symofros.errors import AssemblyError
from symofros.runtime.model import ArrayLike, Model


class Facing(NamedTuple):
    """How a closure faces at each of several postures.

    Attributes:
        closure: Its name.
        cosines: Cosine of the largest angle between axes that are to be parallel (...).
    """

    closure: str
    cosines: Array


def facings(model: Model, q: ArrayLike, u: ArrayLike | None = None, par: ArrayLike | None = None) -> list[Facing]:
    """Facing of each closure with axes that must be parallel (docs/theory/constraints.md, (5a)).

    Args:
        model: Model with constraints.
        q: Configurations (..., nq).
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
    """
    faced = []
    for closure in model.record.closures:
        if not closure.parallel:
            continue
        R_A, R_B = (
            np.eye(3) if frame is None else model.frame_pose(frame, q, u=u, par=par)[1]
            for frame in (closure.first, closure.second)
        )
        switch = next((item for item in model.record.switches if item.name == closure.name), None)
        if switch is not None and switch.rotation:
            held = np.asarray(model.parameter_values if par is None else model.checked_parameters(par))
            R_B = R_B @ quaternion_matrix(normalized(held[..., list(switch.rotation)]))
        cosines = (R_A * R_B).sum(axis=-2)[..., list(closure.parallel)].min(axis=-1)  # a_k . b_k, the axes are columns.
        if switch is not None:  # One that is released has rows of zeros, and faces anywhere.
            rows = [i for i, owner in enumerate(model.record.constraint_owners) if owner == closure.name]
            G = model.constraint_jacobian(q, u=u, par=par)[..., rows, :]
            cosines = np.where(G.any(axis=(-2, -1)), cosines, 1.0)
        faced.append(Facing(closure.name, cosines))
    return faced


def refuse_opposite(model: Model, q: ArrayLike, u: ArrayLike | None = None, par: ArrayLike | None = None) -> None:
    """Refuse postures with a closure that is closed the wrong way round.

    Raises:
        AssemblyError: Names the closure and the angle.
    """
    for closure, cosines in facings(model, q, u, par):
        worst = float(cosines.min(initial=1.0))
        if worst < 0.0:
            angle = np.degrees(np.arccos(max(worst, -1.0)))
            raise AssemblyError(
                f"model '{model.record.name}': closure '{closure}' is closed the wrong way round",
                f"axes that are to be parallel are {angle:.0f} degrees apart",
                "conditions on rotations hold up to a right angle from the closed posture",
                "start from a guess on the right side",
            )
