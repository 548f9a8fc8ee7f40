"""Trajectory optimisation: efforts that lead the flexible robot's tool around the paper's square, by CasADi and Ipopt.

The tool keeps to the square's sides while the links, of spring steel, bend; Ipopt has the exact Hessians of the robot's
dynamics and of its tool's position. Needs the extra `casadi`.
"""

from dataclasses import replace

import casadi as ca
import numpy as np
from symofros.reference_models import MODELS

import symofros as sf

# One shape function a link; without the motors' friction, which controllers compensate by a block of its own.
bodies = [replace(b, bend_y=1) if isinstance(b, sf.Beam) else b for b in MODELS["planar_robot"].bodies]
motors = ["q1", "q2", "q3"]
bodies = [replace(b, joint=replace(b.joint, elements=())) if b.joint.name in motors else b for b in bodies]
robot = MODELS["planar_robot"].with_bodies(*bodies)
model = sf.compile(robot)
dynamics = sf.interop.casadi.Dynamics(robot, frames=["tool"])
driven = [model.names.v.index(name) for name in motors]
elastic = [name for name in model.names.v if name not in motors]

N, T = 16, 0.8  # Intervals a side, seconds a side.
corners = 0.3 * np.array([[1, 1, 0], [3, 1, 0], [3, -1, 0], [1, -1, 0], [1, 1, 0]])
h, s = T / N, np.linspace(0.0, 1.0, N + 1)[1:]
ease = s**3 * (10 - 15 * s + 6 * s**2)
path = np.vstack([corners[0], *(a + np.outer(ease, b - a) for a, b in zip(corners, corners[1:], strict=False))])
guess = [np.zeros(model.nq)]
guess[0][driven] = 1.5, -1.5, -0.5
for p in path:  # of the robot with stiff links
    guess.append(sf.inverse_kinematics(model, {"tool": sf.Target(position=p)}, guess[-1], held=elastic).q)

q, v, a, u = (ca.MX.sym(name, n) for name, n in (("q", model.nq), ("v", model.nv), ("a", model.nv), ("u", model.nu)))
effort = np.eye(model.nv)[:, driven] @ u
residual = ca.Function("residual", [q, v, a, u], [dynamics.inverse_dynamics(q, v, a) - effort])
tool = ca.Function("tool", [q], [dynamics.frame_position("tool", q)[:2]])
opti, K = ca.Opti(), 4 * N
Q, V, U = opti.variable(model.nq, K + 1), opti.variable(model.nv, K + 1), opti.variable(model.nu, K)
A, middle = (V[:, 1:] - V[:, :-1]) / h, (V[:, 1:] + V[:, :-1]) / 2  # the implicit midpoint rule
opti.subject_to(Q[:, 1:] == Q[:, :-1] + h * middle)
opti.subject_to(residual.map(K)((Q[:, 1:] + Q[:, :-1]) / 2, middle, A, U) == 0)
opti.subject_to(ca.vec(tool.map(K + 1)(Q)) == path[:, :2].ravel())
opti.subject_to(V[:, [0, K]] == 0)
opti.minimize(ca.sumsqr(U) * h + 1e-2 * ca.sumsqr(U[:, 1:] - U[:, :-1]) / h + 1e-3 * ca.sumsqr(A) * h)
opti.set_initial(Q, np.transpose(guess[1:]))
opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
plan = opti.solve()
print(f"{opti.nx} variables, {plan.stats()['iter_count']} steps of Ipopt")

x, off, between = (plan.value(Q)[:, 0], plan.value(V)[:, 0]), 0.0, np.arange(K * 8) / 8
wanted = [np.array([np.interp(between, np.arange(K + 1), row) for row in plan.value(X)[driven]]).T for X in (Q, V)]
for k in range(K * 8):  # On the model in C: the planned efforts, and at joints a controller that keeps to the plan.
    correction = [400.0, 100.0, 10.0] * (wanted[0][k] - x[0][driven]) + [40.0, 8.0, 0.5] * (wanted[1][k] - x[1][driven])
    run = sf.simulate(model, *x, t_end=h / 8, dt=h / 80, u=plan.value(U)[:, k // 8] + correction)
    x = run.q[-1], run.v[-1]
    off = max(off, np.abs(run.frames["tool"][0][-1] - path[k // 8 + 1]).max() if k % 8 == 7 else 0.0)
print(f"simulated: tool at most {1e3 * off:.1f} mm from its path, planned effort {np.abs(plan.value(U)).max():.1f} N m")
