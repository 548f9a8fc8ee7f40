"""Two arms at work on a station: the paper's task (its introduction) in a simplified form.

The two-armed manipulator hangs on the tip of the large arm, which gives way: six springs stand for it. One arm may hold
a stabilisation point, which closes a loop; the other carries a payload. Structure: the paper. Values are ours; the
springs give the large arm's slowest motion of some 4 s.
"""

from __future__ import annotations

from math import cos, pi, sin

import symofros as sf

from ..rigid.station import AXES, SPDM, UNIT, two_arm_bodies

# Joint angles of the left arm as it holds the point [rad], q1 to q7; of the right one before and after its move.
HOLD = (0.1, 0.2, 0.9, -1.5, 0.3, 0.1, 0.2)
STOWED = (0.0, 0.0, 0.5, -1.9, 0.6, 0.0, 0.0)
PICK = (0.0, -0.2, 0.8, -1.6, 0.4, 0.0, 0.0)
PLACE = (0.3, 0.5, 0.3, -0.7, 0.2, 0.2, 0.4)
_STIFFNESS, _DAMPING = (4000.0, 3.0e4), (120.0, 900.0)  # Along and about each axis [N/m, N m/rad; N s/m, N m s/rad].
Row = tuple[float, float, float]
Matrix = tuple[Row, Row, Row]


def two_arms() -> sf.System:
    """Six springs, a rolling trunk, two arms of seven joints, a payload; a closure that holds the left hand."""
    bodies = [*mount(), *two_arm_bodies("mount", None)]
    payload = sf.RigidBody(
        "payload",
        sf.Joint("grip", "fixed", "spdm_right_link7", "end"),
        sf.Inertia(200.0, (0.4, 0.0, 0.0), (30.0, 35.0, 35.0)),
        (sf.Frame("center", (0.4, 0.0, 0.0)),),
    )
    p, R = hand(HOLD)
    ground = sf.RigidBody("station", None, frames=(sf.Frame("point", p, sf.Rotation.matrix(R)),))
    hold = sf.Closure(
        "stabilisation", ("station", "point"), ("spdm_left_link7", "end"), ("x", "y", "z"), ("x", "y", "z")
    )
    return sf.System("two_arms", (ground, *bodies, payload), gravity=(0.0, 0.0, 0.0), constraints=(hold,))


def two_arms_guess(names: tuple[str, ...]) -> list[float]:
    """Coordinates at which the left hand is at its point and the right arm is about to pick."""
    arms = {"left": HOLD, "right": PICK}
    return [
        arms[name.split("_")[1]][int(name[-1]) - 1] if name[:5] == "spdm_" and name[-2] == "q" else 0.0
        for name in names
    ]


def mount() -> list[sf.RigidBody]:
    """Three sliding and three turning joints with springs; all mass in the last body."""
    bodies: list[sf.RigidBody] = []
    parent = "station"
    for k, kind in enumerate(("prismatic", "revolute")):
        for axis in "xyz":
            name = f"{'give' if kind == 'prismatic' else 'sway'}_{axis}"
            elements = (sf.Spring(_STIFFNESS[k]), sf.Damper(_DAMPING[k]))
            joint = sf.Joint(name, kind, parent, axis=UNIT[axis], elements=elements)  # type: ignore[arg-type]
            last = name == "sway_z"
            parent = "mount" if last else f"{name}_carrier"
            inertia = sf.Inertia(600.0, (0.0, 0.0, 0.0), (120.0, 120.0, 120.0)) if last else None
            bodies.append(sf.RigidBody(parent, joint, inertia) if inertia else sf.RigidBody(parent, joint))
    return bodies


def hand(angles: tuple[float, ...], side: float = 1.0) -> tuple[Row, Matrix]:
    """Position and rotation of a hand in the world, the springs at rest and the trunk unturned.

    Args:
        angles: Of the seven joints.
        side: 1.0 left, -1.0 right.
    """
    p: Row = (0.6, 0.5 * side, 0.0)
    R = _about("z", side * pi / 2.0)
    for angle, axis, (length, _) in zip(angles, AXES, SPDM, strict=True):
        R = _product(R, _about(axis, angle))
        p = (p[0] + R[0][0] * length, p[1] + R[1][0] * length, p[2] + R[2][0] * length)
    return p, R


def _about(axis: str, angle: float) -> Matrix:
    c, s = cos(angle), sin(angle)
    if axis == "x":
        return ((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c))
    if axis == "y":
        return ((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c))
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def _product(A: Matrix, B: Matrix) -> Matrix:
    def row(i: int) -> Row:
        x, y, z = (sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3))
        return x, y, z

    return row(0), row(1), row(2)
