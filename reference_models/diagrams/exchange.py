"""The paper's task under control: the left hand takes hold, the right one exchanges a part.

Commands come from a clock, as in a rehearsed task. The controller knows the rigid manipulator on a mount that does not
give way, and which hand holds what: inverse dynamics along the path, and PD whose gains follow what a joint carries.
"""

from __future__ import annotations

from collections.abc import Mapping

import symofros as sf
from symofros import blocks

from ..closed.exchange import RACK, STOWAGE, WORKSITE, exchange
from ..closed.two_arms import HOLD, STOWED
from ..rigid.station import spdm
from .two_arms import DAMPING, FREQUENCY, INERTIAS, LOCKED

T_END = 58.0
# Seconds at which both arms are at angles: of the left arm, and of the right one.
PATH = (
    (0.0, STOWED, WORKSITE),
    (16.0, HOLD, WORKSITE),
    (20.0, HOLD, WORKSITE),
    (28.0, HOLD, STOWAGE),
    (32.0, HOLD, STOWAGE),
    (38.0, HOLD, RACK),
    (42.0, HOLD, RACK),
    (50.0, HOLD, WORKSITE),
    (54.0, HOLD, WORKSITE),
    (58.0, HOLD, STOWAGE),
)
# Event -> its instant [s], and what holds from then on, 1, or no longer, 0.
COMMANDS: Mapping[str, tuple[float, Mapping[str, int]]] = {
    "stabilise": (18.0, {"stabilised": 1}),
    "grasp_worn": (19.0, {"worn_in_hand": 1}),
    "unlock_worn": (19.5, {"worn_at_worksite": 0}),
    "stow_worn": (31.0, {"worn_at_stowage": 1}),
    "release_worn": (31.5, {"worn_in_hand": 0}),
    "grasp_spare": (41.0, {"spare_in_hand": 1}),
    "unlock_spare": (41.5, {"spare_at_rack": 0}),
    "lock_spare": (53.0, {"spare_at_worksite": 1}),
    "release_spare": (53.5, {"spare_in_hand": 0}),
}


def events() -> dict[str, sf.Event]:
    """The commands as events of the mechanism."""
    return {
        name: sf.Event(f"t - {t}", action={f"{constraint}_on": on for constraint, on in held.items()})
        for name, (t, held) in COMMANDS.items()
    }


def exchanging(period: float = 1e-3) -> sf.Diagram:
    """The diagram.

    Args:
        period: Of the controller [s].
    """
    start = {f"spdm_left_q{i + 1}": angle for i, angle in enumerate(STOWED)}
    start |= {f"spdm_right_q{i + 1}": angle for i, angle in enumerate(WORKSITE)}
    free = (*INERTIAS[:8], *INERTIAS[1:8])  # The right arm without a part is as the left one.
    diagram = sf.Diagram("exchange")
    diagram.add_model("plant", exchange(), start)
    diagram.add_model("control", spdm(), start)
    points, times = [[0.0, *left, *right] for _, left, right in PATH], [t for t, _, _ in PATH]
    diagram.add(blocks.JointTrajectory(name="path", points=points, times=times))
    diagram.add(
        blocks.InverseDynamics(name="feedforward", model="control", period=period), q="path.q", v="path.v", a="path.a"
    )
    for name in ("q", "v"):
        diagram.add(blocks.Pick(name=name, entries="actuated", model="plant", of=name), u=f"plant.{name}")
    kp, kd = [FREQUENCY**2 * one for one in free], [2.0 * DAMPING * FREQUENCY * one for one in free]
    diagram.add(
        blocks.JointPD(name="pd", kp=kp, kd=kd, period=period), q_desired="path.q", v_desired="path.v", q="q", v="v"
    )
    diagram.add(_gains(free))
    diagram.add(blocks.Product(name="scaled", period=period), u1="pd.effort", u2="gains.y")
    diagram.add(blocks.Sum(name="effort", period=period), u1="scaled", u2="feedforward.tau")
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant", events=events()), u="effort")
    frames = {"worn": "worn_handle", "spare": "spare_handle", "hand": "spdm_right_link7.end"}
    for name, frame in frames.items():
        diagram.add(blocks.ForwardKinematics(name=name, model="plant", frame=frame), q="plant.q", v="plant.v")
    return diagram


def _gains(free: tuple[float, ...]) -> blocks.Sequence:
    """How much stiffer each joint is held: the arm that has taken hold, and the one that carries a part."""
    after = 0.2  # [s] behind the grasp; with the release at once.
    stiff = [1.0, *(7 * [LOCKED]), *(7 * [1.0])]
    loaded = [s * with_part / alone for s, with_part, alone in zip(stiff, INERTIAS, free, strict=True)]
    at = {name: t for name, (t, _) in COMMANDS.items()}
    steps = [
        (0.0, 15 * [1.0]),
        (at["stabilise"] + after, stiff),
        (at["grasp_worn"] + after, loaded),
        (at["release_worn"], stiff),
        (at["grasp_spare"] + after, loaded),
        (at["release_spare"], stiff),
    ]
    return blocks.Sequence(name="gains", t=[t for t, _ in steps], values=[values for _, values in steps], kind="hold")
