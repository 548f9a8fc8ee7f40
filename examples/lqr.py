"""A linear-quadratic regulator from the exact linearisation, held against the nonlinear cart and pole.

Needs SciPy, for the Riccati equation.
"""

import numpy as np
from scipy.linalg import solve_continuous_are
from symofros.reference_models import MODELS

import symofros as sf

model = sf.compile(MODELS["cart_pole"])
upright = np.zeros(2)
A, B = model.linearize(upright, np.zeros(2), np.zeros(1))  # differentiated on the graph, no finite differences
print("poles of the open loop [1/s]", np.round(np.linalg.eigvals(A), 3))

state_weights, input_weight = np.diag([1.0, 10.0, 1.0, 1.0]), np.array([[0.1]])
X = solve_continuous_are(A, B, state_weights, input_weight)
K = np.linalg.solve(input_weight, B.T @ X)[0]
print("gains K of F = -K (x, q, x', q')", np.round(K, 3))
print("poles of the closed loop [1/s]", np.round(np.linalg.eigvals(A - B @ K[None]), 3))

law = "-(" + " + ".join(f"{k!r}*{name}" for k, name in zip(K.tolist(), ("x", "q", "dx", "dq"), strict=True)) + ")"
for tilt in (0.1, 0.3, 0.5):
    run = sf.simulate(model, {"q": tilt}, t_end=8.0, u={"F": law})
    far = np.abs(run["x"]).max()
    print(f"tilted by {tilt} rad: cart moves {far:.2f} m, after 8 s the tilt is {run['q'][-1]:.1e} rad")
