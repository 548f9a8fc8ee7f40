"""The paper's example (section 8): the planar flexible robot traces a square under a controller of its rigid twin.

From the paper: where the motors begin (-0.1, 0.1, 0 rad), the corner (0.3, 0.3) m, sides of 0.6 m, Coulomb friction of
its table 3, and the diagram: inverse kinematics -> PD, friction compensation and inverse dynamics of the rigid model ->
forward dynamics of the flexible one. It prints neither gains nor times; those here are ours. It does not say on which
side of the corner the square lies, either: away from the base the robot reaches all of it.
"""

from __future__ import annotations

import symofros as sf
from reference_models import MODELS
from symofros import blocks

START = {"q1": -0.1, "q2": 0.1, "q3": 0.0}
CORNER, SIDE = (0.3, 0.3), 0.6
APPROACH, ALONG = 3.0, 2.0  # Seconds of the way to the corner, and of a side.
T_END = APPROACH + 4 * ALONG + 1.0
KP, KD = (600.0, 250.0, 40.0), (60.0, 20.0, 2.0)  # N m/rad, N m s/rad.


def square(
    functions: int | None = None, period: float = 1e-3, robot: sf.System | None = None, compensated: float = 1.0
) -> sf.Diagram:
    """The diagram of the paper's figure 8.

    Args:
        functions: Shape functions of the plant's links; None: as described; 0: a rigid plant.
        period: Of the controller [s].
        robot: In place of the reference model.
        compensated: How much of the friction the controller compensates.
    """
    system = robot or MODELS["planar_robot"]
    diagram = sf.Diagram("square")
    diagram.add_model("plant", system, START, functions=functions)
    diagram.add_model("control", system, START, functions=0)
    diagram.add(blocks.Square(name="path", corner=CORNER, first=(SIDE, 0.0), second=(0.0, -SIDE), model="control",
                              frame="tool", approach=APPROACH, side=ALONG))  # fmt: skip
    diagram.add(blocks.InverseKinematics(name="ik", model="control", frame="tool", rows=("x", "y"), period=period),
                p="path.p", v="path.v", a="path.a")  # fmt: skip
    diagram.add(blocks.InverseDynamics(name="feedforward", model="control", with_friction=False, period=period),
                q="ik.q", v="ik.v", a="ik.a")  # fmt: skip
    diagram.add(blocks.FrictionCompensation(name="friction", model="control", factor=compensated, period=period),
                q="ik.q", v="ik.v")  # fmt: skip
    for name, source, model in (("q_desired", "ik.q", "control"), ("v_desired", "ik.v", "control"),
                                ("tau", "feedforward.tau", "control"), ("against", "friction.effort", "control"),
                                ("q", "plant.q", "plant"), ("v", "plant.v", "plant")):  # fmt: skip
        of = "q" if name.startswith("q") else "v"
        diagram.add(blocks.Pick(name=name, entries="actuated", model=model, of=of), u=source)
    diagram.add(blocks.JointPD(name="pd", kp=KP, kd=KD, period=period),
                q_desired="q_desired", v_desired="v_desired", q="q", v="v")  # fmt: skip
    diagram.add(blocks.Sum(name="effort", signs="+++", period=period), u1="pd.effort", u2="tau", u3="against")
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant"), u="effort")
    diagram.add(
        blocks.ForwardKinematics(name="tip", model="plant", frame="tool"), q="plant.q", v="plant.v", a="plant.a"
    )
    return diagram
