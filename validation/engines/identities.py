"""What an engine's answers owe to each other: no truth and no second engine is asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .interface import Array, State
from .matrix import Judged

# Products of several answers lose some digits more than each.
TOLERANCE = 1e-9

Sides = tuple[Array, Array]
Values = Mapping[str, Array]


@dataclass(frozen=True)
class Identity:
    """An equation between functions at one state.

    Attributes:
        needs: Names of the functions.
        sides: Their values and the state -> both sides of the equation.
    """

    needs: tuple[str, ...]
    sides: Callable[[Values, State], Sides]


IDENTITIES: dict[str, Identity] = {
    "M a + h = inverse dynamics": Identity(
        ("mass_matrix", "bias", "inverse_dynamics"),
        lambda f, s: (f["mass_matrix"] @ s.a + f["bias"], f["inverse_dynamics"]),
    ),
    "M forward dynamics + h = tau": Identity(
        ("mass_matrix", "bias", "forward_dynamics"),
        lambda f, s: (f["mass_matrix"] @ f["forward_dynamics"] + f["bias"], s.tau),
    ),
    "M M^-1 = 1": Identity(
        ("mass_matrix", "mass_matrix_inverse"),
        lambda f, s: (f["mass_matrix"] @ f["mass_matrix_inverse"], np.eye(len(s.v))),
    ),
    "v M v / 2 = T": Identity(
        ("mass_matrix", "kinetic_energy"), lambda f, s: (s.v @ f["mass_matrix"] @ s.v / 2.0, f["kinetic_energy"])
    ),
    "C v + g = h": Identity(
        ("coriolis_forces", "gravity", "bias"), lambda f, s: (f["coriolis_forces"] + f["gravity"], f["bias"])
    ),
    "J v = velocities": Identity(
        ("link_jacobians", "link_velocities"), lambda f, s: (f["link_jacobians"] @ s.v, f["link_velocities"])
    ),
    "J a + J' v = accelerations": Identity(
        ("link_jacobians", "link_jacobian_rates", "link_accelerations"),
        lambda f, s: (f["link_jacobians"] @ s.a + f["link_jacobian_rates"] @ s.v, f["link_accelerations"]),
    ),
    "A v = momentum": Identity(
        ("centroidal_matrix", "centroidal_momentum"),
        lambda f, s: (f["centroidal_matrix"] @ s.v, f["centroidal_momentum"]),
    ),
    "A a + A' v = rate of momentum": Identity(
        ("centroidal_matrix", "centroidal_matrix_rate", "centroidal_momentum_rate"),
        lambda f, s: (
            f["centroidal_matrix"] @ s.a + f["centroidal_matrix_rate"] @ s.v,
            f["centroidal_momentum_rate"],
        ),
    ),
    "M a + h = tau + J^T f": Identity(
        ("mass_matrix", "bias", "constraint_jacobian", "constrained_acceleration", "constraint_forces"),
        lambda f, s: (
            f["mass_matrix"] @ f["constrained_acceleration"] + f["bias"],
            s.tau + f["constraint_jacobian"].T @ f["constraint_forces"],
        ),
    ),
    "J a + J' v = 0": Identity(
        ("constraint_jacobian", "constraint_velocity_products", "constrained_acceleration"),
        # Both parts may be small beside what the constraints hold back.
        lambda f, s: (
            (f["constraint_jacobian"] @ f["constrained_acceleration"] + f["constraint_velocity_products"])
            / np.max(np.abs(f["constraint_jacobian"]) @ np.abs(f["constrained_acceleration"])),
            np.zeros(len(f["constraint_velocity_products"])),
        ),
    ),
    "derivative of difference = that of integrate, inverted": Identity(
        ("integrate_dv", "difference_dq2"), lambda f, s: (f["integrate_dv"] @ f["difference_dq2"], np.eye(len(s.v)))
    ),
}


@dataclass(frozen=True)
class Held:
    """An identity on one tree.

    Attributes:
        engine: Name of the engine.
        model: Name of the tree.
        identity: Key of IDENTITIES.
        error: Difference of both sides, as part of the largest entry.
        ok: Whether it holds.
    """

    engine: str
    model: str
    identity: str
    error: float
    ok: bool


def held(cells: Sequence[Judged]) -> Iterator[Held]:
    """The identities of which an engine answered all that is in them."""
    answers: dict[tuple[str, str], dict[str, Judged]] = {}
    for one in cells:
        value = one.answer.value
        if isinstance(value, np.ndarray) and one.want is not None and value.size == one.want.value.size:
            answers.setdefault((one.cell.engine, one.cell.model), {})[one.cell.function] = one
    for (engine, model), known in answers.items():
        for name, identity in IDENTITIES.items():
            if set(identity.needs) <= set(known):
                state = known[identity.needs[0]].answer.state
                assert state is not None
                values = {need: _shaped(known[need]) for need in identity.needs}
                left, right = identity.sides(values, state)
                scale = float(np.max(np.abs(right), initial=0.0)) or 1.0
                error = float(np.max(np.abs(left - right), initial=0.0)) / scale
                documented = max((_documented(known[need]) for need in identity.needs), default=0.0)
                yield Held(engine, model, name, error, error <= max(TOLERANCE, documented))


def _documented(one: Judged) -> float:
    """What an engine says that an answer may be off by, as part of the largest entry."""
    return one.cell.tolerance if one.want is not None and one.want.approximate else 0.0


def _shaped(one: Judged) -> Array:
    """An answer in the shape of its truth."""
    value = np.asarray(one.answer.value)
    return value.reshape(one.want.value.shape) if one.want is not None and one.want.value.size == value.size else value
