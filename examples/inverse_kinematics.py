"""Inverse kinematics: six joints put the hand of a Puma 560 where it is wanted, and follow a line with it."""

import numpy as np
from symofros.reference_models import MODELS

import symofros as sf

model = sf.compile(MODELS["puma560"], sf.Options(functions=["frame_pose", "frame_jacobian"]))
frame = model.names.frames[-1]
rest = np.array([0.3, 0.6, -0.4, 0.2, 0.5, 0.1])
p, R = model.frame_pose(frame, rest)
print(f"frame '{frame}' at rest [m]", p)

wanted = sf.Target(position=p + [0.05, -0.1, 0.08], rotation=R)
reached = sf.inverse_kinematics(model, {frame: wanted}, rest)
print("joints [rad]", reached.q)
print(f"error {reached.error:.1e} after {reached.iterations} steps, converged: {reached.converged}")

q, worst = rest, 0.0
for part in np.linspace(0.0, 1.0, 21):
    target = sf.Target(position=p + part * np.array([0.05, -0.1, 0.08]), rotation=R)
    step = sf.inverse_kinematics(model, {frame: target}, q)
    q, worst = step.q, max(worst, step.error)
print(f"along a line in 20 steps: worst error {worst:.1e}; smallest singular value of the Jacobian", end=" ")
print(f"{np.linalg.svd(model.frame_jacobian(frame, q), compute_uv=False)[-1]:.3f}")
