"""Nonlinear model predictive control: CasADi plans the swing-up of the cart and pole anew at every sample.

The pole hangs down and is to stand up at the origin, within limits of force and travel. Ipopt has the exact Hessian of
the dynamics. Needs the extra `casadi`.
"""

import casadi as ca
import numpy as np
from symofros.reference_models import MODELS

import symofros as sf

model = sf.compile(MODELS["cart_pole"])  # x: the cart [m], q: the pole's angle, 0 upright [rad], F: the force [N]
dynamics = sf.interop.casadi.Dynamics(MODELS["cart_pole"])
N, DT, FORCE, TRAVEL = 40, 0.05, 15.0, 2.0


def rate(x, F):
    """The state's rate."""
    return ca.vertcat(x[2:], dynamics.forward_dynamics(x[:2], x[2:], F))


x, F = ca.MX.sym("x", 4), ca.MX.sym("F")
step = ca.Function("step", [x, F], [x + DT * rate(x + DT / 2 * rate(x, F), F)])  # the midpoint rule

opti = ca.Opti()
X, U, beyond, now = opti.variable(4, N + 1), opti.variable(1, N), opti.variable(1, N), opti.parameter(4)
opti.subject_to(X[:, 1:] == step.map(N)(X[:, :-1], U))
opti.subject_to(X[:, 0] == now)
opti.subject_to(opti.bounded(-FORCE, U, FORCE))
# What the limit of travel is exceeded by has its price: from every state there is a plan.
opti.subject_to([X[0, 1:] <= TRAVEL + beyond, X[0, 1:] >= -TRAVEL - beyond, beyond >= 0])
tilt = 1 - ca.cos(X[1, 1:])
cost = 40 * tilt + 4 * X[0, 1:] ** 2 + 0.5 * ca.sum1(X[2:, 1:] ** 2)
opti.minimize(ca.sum2(cost) + 20 * cost[-1] + 0.01 * ca.sumsqr(U) + 1e4 * ca.sum2(beyond))
opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes", "max_iter": 200})
opti.set_initial(X[1, :], np.linspace(np.pi, 0.0, N + 1))

x, forces, steps, far = np.array([0.0, np.pi, 0.0, 0.0]), [], [], 0.0
for _ in range(70):
    opti.set_value(now, x)
    plan = opti.solve()
    steps.append(plan.stats()["iter_count"])
    forces.append(float(plan.value(U[0])))
    for variable in (X, U, beyond):  # The next sample starts from this plan, one step on.
        values = np.atleast_2d(plan.value(variable))
        opti.set_initial(variable, np.hstack([values[:, 1:], values[:, -1:]]))
    run = sf.simulate(model, x[:2], x[2:], t_end=DT, dt=DT / 10, u=np.array(forces[-1:]))
    x, far = np.concatenate([run.q[-1], run.v[-1]]), max(far, np.abs(run["x"]).max())

print(f"Ipopt's steps: {steps[0]} at the first sample, then {np.mean(steps[1:]):.1f} on average")
print(f"largest force {np.abs(forces).max():.1f} N, farthest {far:.2f} m")
print(f"after {len(steps) * DT:.1f} s: cart at {abs(x[0]):.3f} m, pole tilted by {abs(np.sin(x[1])):.3f} rad")
