"""What is timed: models from two to fifty-two degrees of freedom, and functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import symofros as sf

from .. import references
from ..inputs.cases import standard_set
from ..references import reference_module

if TYPE_CHECKING:
    from reference_models.closed.four_bars import n_four_bar, turned
    from reference_models.rigid.chain import chain
else:
    _four_bars = reference_module("closed.four_bars")
    n_four_bar, turned = _four_bars.n_four_bar, _four_bars.turned
    chain = reference_module("rigid.chain").chain

# Function of the generated code -> its name in tables.
FUNCTIONS = {
    "mass_matrix": "M",
    "bias": "h",
    "dynamics": "M + h",
    "forward_dynamics": "forward dynamics",
    "inverse_dynamics": "inverse dynamics",
    "frame_jacobian": "frame Jacobian",
    "inverse_dynamics_derivatives": "derivatives of inverse dynamics",
    "forward_dynamics_derivatives": "derivatives of forward dynamics",
    "inverse_dynamics_second_derivatives": "second derivatives of inverse dynamics",
    "inverse_dynamics_vjp": "reverse mode of inverse dynamics",
    "forward_dynamics_vjp": "reverse mode of forward dynamics",
    "step": "one step of RK4",
}
# Control of `panda7`, of each joint [N m/rad, N m s/rad, rad]: what RK4 with a millisecond holds at the wrist, whose
# inertia is the smallest.
STIFFNESS, DAMPING, TARGET = 20.0, 1.0, 0.4


# Vector-Jacobian products, which no engine has: their time stands beside that of the function itself.
REVERSE = {name: name.removesuffix("_vjp") for name in FUNCTIONS if name.endswith("_vjp")}
_SECOND = "inverse_dynamics_second_derivatives"
# The code of second derivatives grows with the cube of the joints: of arms alone.
_FIRST_ORDER = tuple(name for name in FUNCTIONS if name != _SECOND)
_ALL = tuple(FUNCTIONS)


class Labelled:
    """What is of one function of one model, with their names in tables."""

    model: str
    function: str

    @property
    def title(self) -> str:
        """Name of the model."""
        return TIMED_MODELS[self.model].title

    @property
    def task(self) -> str:
        """Name of the function."""
        return FUNCTIONS[self.function]


# Of chains: what exponents are fitted to. CasADi's C of the longest takes a minute a function to compile.
_GROWTH = ("dynamics", "forward_dynamics")
CHAINS = (2, 4, 7, 13, 22, 32, 52)
# Windows of rows of four-bars: 2 n + 1 joints and 2 n conditions.
ROWS = (5, 10, 20, 40, 80, 160, 320)


@dataclass(frozen=True)
class TimedModel:
    """A model that is timed.

    Attributes:
        title: Name in tables.
        make: Makes the description.
        functions: Functions that are timed.
        closed: Of many loops at once, which hardly close from anywhere: a posture, beside which states are taken.
    """

    title: str
    make: Callable[[], sf.System]
    functions: tuple[str, ...] = _FIRST_ORDER
    closed: Mapping[str, float] | None = None

    def load(self) -> sf.System:
        """Load its description without elements of joints (friction, springs), which engines model differently."""
        system = self.make()
        bodies = [
            body if body.joint is None else replace(body, joint=replace(body.joint, elements=()))
            for body in system.bodies
        ]
        return replace(system, bodies=tuple(bodies))


def _robot(label: str) -> sf.System:
    return next(case for case in standard_set() if case.label == label).load().system


def _locked(body: sf.Body) -> sf.Body:
    joint = body.joint
    if joint is None or "finger" not in joint.name:
        return body
    return replace(body, joint=replace(joint, kind="fixed", actuated=False))


def panda7() -> sf.System:
    """The seven joints of Panda, its fingers locked."""
    panda = _robot("panda")
    return replace(panda, name="panda7", bodies=tuple(map(_locked, panda.bodies)))


def arm(joints: int) -> sf.System:
    """Slender rods in a vertical plane, a metre and a kilogram each."""
    rod = sf.Inertia(1.0, (0.5, 0.0, 0.0), (1e-3, 1 / 12, 1 / 12))
    bodies = [
        sf.RigidBody(
            f"rod{k}",
            sf.Joint(
                f"q{k}",
                "revolute",
                f"rod{k - 1}" if k > 1 else "world",
                axis=(0, 1, 0),
                position=(1.0 if k > 1 else 0.0, 0, 0),
                actuated=True,
            ),
            rod,
        )
        for k in range(1, joints + 1)
    ]
    return sf.System(f"planar{joints}R", tuple(bodies))


def _reference(name: str) -> sf.System:
    return references.MODELS[name]


TIMED_MODELS: dict[str, TimedModel] = {
    "planar2R": TimedModel("planar 2R", partial(arm, 2), _ALL),
    "planar3R": TimedModel("planar 3R", partial(arm, 3), _ALL),
    "ur5": TimedModel("UR5", partial(_robot, "ur5"), _ALL),
    "panda": TimedModel("Panda, 7 joints", panda7, _ALL),
    "mss": TimedModel("MSS", partial(_reference, "mss")),
    "talos": TimedModel("Talos", partial(_robot, "talos")),
    "four_bar": TimedModel("four-bar, closed", partial(_reference, "four_bar"), ("forward_dynamics",)),
    **{
        f"four_bars{n}": TimedModel(f"{n} four-bars", partial(n_four_bar, n), ("forward_dynamics",), turned(n, 1.0))
        for n in ROWS
    },
    **{f"chain{n}": TimedModel(f"chain of {n}", partial(chain, n, symbolic=False), _GROWTH) for n in CHAINS[:-1]},
    f"chain{CHAINS[-1]}": TimedModel(
        f"chain of {CHAINS[-1]}",
        partial(chain, CHAINS[-1], symbolic=False),
        tuple(name for name in _FIRST_ORDER if name not in ("mass_matrix", "bias")),
    ),
}
