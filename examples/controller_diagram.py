"""A diagram: a trajectory, a computed-torque controller at 1 kHz and the arm, compiled into one C program."""

import numpy as np

import symofros as sf
import symofros.blocks as blocks

link = sf.Inertia(mass=1.5, center_of_mass=(0.4, 0, 0), moments=(0.001, 0.08, 0.08))
arm = sf.System(
    "arm",
    bodies=[
        sf.RigidBody(
            "upper", sf.Joint("q1", "revolute", axis=(0, 1, 0), actuated=True), link, [sf.Frame("end", (0.8, 0, 0))]
        ),
        sf.RigidBody(
            "lower",
            sf.Joint("q2", "revolute", "upper", "end", axis=(0, 1, 0), actuated=True),
            link,
            [sf.Frame("tip", (0.8, 0, 0))],
        ),
    ],
)

d = sf.Diagram("reach")
d.add_model("arm", arm, start={"q1": 0.2})
d.add(blocks.JointTrajectory(name="goal", points=[[0.2, 0], [0.8, -1.0]], times=[0, 1], law="quintic", unit="rad"))
d.add(
    blocks.ComputedTorque(name="control", model="arm", kp=400.0, kd=40.0, period=1e-3),
    q_desired="goal.q",
    v_desired="goal.v",
    a_desired="goal.a",
    q="plant.q",
    v="plant.v",
)
d.add(blocks.ForwardDynamics(name="plant", model="arm"), u="control.tau")
d.add(blocks.ForwardKinematics(name="tip", model="arm", frame="tip"), q="plant.q", v="plant.v", a="plant.a")

run = sf.Simulation(d).run(1.5, dt=1e-3, record=0.01)
print("outcome:", run.outcome)
print(f"largest tracking error {np.abs(run['plant.q'] - run['goal.q']).max():.1e} rad")
print("largest effort [N m]", np.abs(run["control.tau"]).max(axis=0).round(2))
print("tip at the end [m]", run["tip.p"][-1].round(4))
