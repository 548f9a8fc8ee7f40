"""Gymnasium: the cart-pole, and the flexible robot that reaches for a point; both pass Gymnasium's own checker.

Many environments are stepped together in C by `sf.simulate_batch`. Needs the extra `gymnasium`.
"""

import warnings

import numpy as np
from gymnasium.utils.env_checker import check_env
from symofros.reference_models import MODELS

import symofros as sf

gym = sf.interop.gymnasium
model = sf.compile(MODELS["planar_robot"])
motors = [model.names.q.index(name) for name in ("q1", "q2", "q3")]
there = np.array([0.6, -0.5, 0.4])  # angles of the motors at the goal [rad]
goal = model.frame_pose("tool", np.insert(np.zeros(model.nq - 3), [0, 4, 7], there))[0]


def start(rng, n):
    """Arm nearly stretched, links straight, at rest."""
    q = np.zeros((n, model.nq))
    q[:, motors] = rng.uniform(-0.2, 0.2, (n, 3))
    return q, np.zeros((n, model.nv))


def reward(q, v, u):
    """Near the goal, and slowly."""
    return -np.linalg.norm(model.frame_pose("tool", q)[0] - goal, axis=1) - 0.01 * (v[:, motors] ** 2).sum(axis=1)


def fails(q, v):
    """Links bent, or joints turning, beyond what the robot stands."""
    return np.abs(v[:, motors]).max(axis=1) > 20.0


# Coulomb friction that sticks decays within 0.1 ms (reference_models/square.yaml), and asks for as short steps.
reach = gym.Task(model, np.array([30.0, 15.0, 5.0]), start, reward, fails, dt=0.01, substeps=40)
for name, task in (("cart-pole", gym.cart_pole()), ("flexible robot", reach)):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Observations have no bounds, as a pole may turn as often as it likes; environments without a registry's spec.
        warnings.filterwarnings("ignore", message=".*(infinity|Box|spec|render).*")
        check_env(gym.MechanismEnv(task), skip_render_check=True)
    print(f"{name}: check_env has nothing to say")

envs = gym.MechanismVectorEnv(reach, num_envs=16)
state, _ = envs.reset(seed=0)
totals = np.zeros(16)
for _ in range(300):
    q, v = state[:, motors], state[:, model.nq :][:, motors]
    state, rewards, failed, cut, _ = envs.step([40.0, 12.0, 1.5] * (there - q) - [16.0, 2.5, 0.1] * v)
    totals += rewards
away = np.linalg.norm(model.frame_pose("tool", state[:, : model.nq])[0] - goal, axis=1)
print(f"16 robots under joint control, 3 s: rewards {totals.mean():.1f}, tools at most {1e3 * away.max():.0f} mm away")
