"""The paper's motivating task in a simplified form: one arm takes a stabilisation point, the other moves a payload.

The left arm goes to the point, takes hold of it, which closes a loop while the simulation runs, and stiffens; then the
right arm moves its payload. The controller knows a rigid, open mechanism: PD on the joints, and inverse dynamics of
that.
"""

from __future__ import annotations

import symofros as sf
from symofros import blocks

from ..closed.two_arms import HOLD, PICK, PLACE, STOWED, two_arms
from ..rigid.station import spdm

# The arm takes its time: the sway that it leaves in the mount decays slowly, and a grip closes gaps of a millimetre.
REACHED, GRIPPED, LIFTED, PLACED, T_END = 16.0, 18.0, 19.0, 25.0, 30.0
# What each joint moves, alone, as the arms stand at the start [kg m^2]: trunk, left arm, right arm with its payload.
INERTIAS = (5500.0, 100.0, 540.0, 510.0, 300.0, 12.0, 5.0, 0.2, 200.0, 2500.0, 2200.0, 1360.0, 245.0, 185.0, 30.0)
FREQUENCY, DAMPING = 4.0, 0.8  # Of each joint under its PD [rad/s], and its share of critical damping.
KP = tuple(FREQUENCY**2 * inertia for inertia in INERTIAS)  # N m/rad
KD = tuple(2.0 * DAMPING * FREQUENCY * inertia for inertia in INERTIAS)  # N m s/rad
LOCKED = 10.0  # How much stiffer the arm that holds on becomes.


def controlled() -> sf.System:
    """What the controller knows: the two-armed manipulator on a rigid mount, with its payload."""
    system = spdm()
    payload = next(body for body in two_arms().bodies if body.name == "payload")
    return sf.System("controlled", (*system.bodies, payload), gravity=(0.0, 0.0, 0.0))


def working(grips: bool = True, period: float = 1e-3) -> sf.Diagram:
    """The diagram.

    Args:
        grips: Whether the left hand takes hold, or stays open at its point.
        period: Of the controller [s].
    """
    start = {f"spdm_left_q{i + 1}": angle for i, angle in enumerate(STOWED)}
    start |= {f"spdm_right_q{i + 1}": angle for i, angle in enumerate(PICK)}
    diagram = sf.Diagram("two_arms")
    diagram.add_model("plant", two_arms(), start)
    diagram.add_model("control", controlled(), start)
    points = [
        [0.0, *left, *right]
        for left, right in ((STOWED, PICK), (HOLD, PICK), (HOLD, PICK), (HOLD, PLACE), (HOLD, PLACE))
    ]
    diagram.add(blocks.JointTrajectory(name="path", points=points, times=[0.0, REACHED, LIFTED, PLACED, T_END]))
    diagram.add(
        blocks.InverseDynamics(name="feedforward", model="control", period=period), q="path.q", v="path.v", a="path.a"
    )
    for name, source in (("q", "plant.q"), ("v", "plant.v")):
        diagram.add(blocks.Pick(name=name, entries="actuated", model="plant", of=name), u=source)
    diagram.add(
        blocks.JointPD(name="pd", kp=KP, kd=KD, period=period), q_desired="path.q", v_desired="path.v", q="q", v="v"
    )
    diagram.add(
        blocks.Step(
            name="stiffness",
            time=GRIPPED,
            before=[1.0] * 15,
            period=period,
            after=[1.0] + [LOCKED if grips else 1.0] * 7 + [1.0] * 7,
        )
    )
    diagram.add(blocks.Product(name="held", period=period), u1="pd.effort", u2="stiffness")
    diagram.add(blocks.Sum(name="effort", period=period), u1="held", u2="feedforward.tau")
    diagram.add(blocks.Step(name="grip", time=GRIPPED, before=[0.0], after=[1.0 if grips else 0.0], period=period))
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant", engaged=True), u="effort", engaged="grip")
    diagram.add(blocks.Hold(name="felt", period=0.01), u="plant.lam")
    for name, frame in (("payload", "center"), ("hand", "spdm_left_link7.end")):
        diagram.add(blocks.ForwardKinematics(name=name, model="plant", frame=frame), q="plant.q", v="plant.v")
    return diagram
