"""A first arm: describe two links, compile them, ask for the dynamics, move them for two seconds."""

import numpy as np

import symofros as sf

rod = sf.Inertia(mass="m", center_of_mass=("L/2", 0, 0), moments=(0, "m*L^2/12", "m*L^2/12"))
arm = sf.System(
    "arm",
    bodies=[
        sf.RigidBody(
            "upper", sf.Joint("q1", "revolute", axis=(0, 1, 0), actuated=True), rod, [sf.Frame("elbow", ("L", 0, 0))]
        ),
        sf.RigidBody(
            "lower",
            sf.Joint("q2", "revolute", "upper", "elbow", axis=(0, 1, 0), actuated=True),
            rod,
            [sf.Frame("tip", ("L", 0, 0))],
        ),
    ],
    parameters=[sf.Parameter("m", 1.5, "kg"), sf.Parameter("L", 0.8, "m")],
)
model = sf.compile(arm)

q, v, u = np.array([0.3, -0.5]), np.zeros(2), np.zeros(2)
M, h, Q = model.dynamics(q, v, u)
print("mass matrix M(q) [kg m^2]\n", M)
print("efforts that hold the arm still [N m]", model.inverse_dynamics(q, v, np.zeros(2)))
print("the same with a lower mass", model.with_parameters(m=0.5).inverse_dynamics(q, v, np.zeros(2)))

run = sf.simulate(model, q, t_end=2.0, u={"q1": "-20*q1 - 4*dq1", "q2": "-20*q2 - 2*dq2"})
print("outcome:", run.outcome)
print("tip after 2 s [m]", run.frames["tip"][0][-1])
