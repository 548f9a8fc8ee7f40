"""Gymnasium: environments that a model steps, one at a time or many in C.

    env = sf.interop.gymnasium.MechanismEnv(sf.interop.gymnasium.cart_pole())
    envs = sf.interop.gymnasium.MechanismVectorEnv(sf.interop.gymnasium.cart_pole(), num_envs=1024)

A Task states what is rewarded and where an episode ends; steps are those of `sf.simulate_batch`, inputs held.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import symofros.interop.rules as rules
from symofros.compiler import compile_system
from symofros.description.joints.joint import Joint
from symofros.description.system import Inertia, Input, RigidBody, System
from symofros.description.values import as_value
from symofros.errors import Problem
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import Model
from symofros.simulation.simulate_batch import simulate_batch

gymnasium = rules.framework("gymnasium", "gymnasium")
_Env: Any = gymnasium.Env
_VectorEnv: Any = gymnasium.vector.VectorEnv


@dataclass(frozen=True)
class Task:
    """What an agent does with a model.

    Attributes:
        model: Compiled model; its inputs u are the actions.
        largest: Largest magnitude of each input (nu) [N or N m].
        start: First states from a generator and their number n: q (n, nq), v (n, nv).
        reward: Rewards (n) of states after a step and of the inputs before it: q (n, nq), v (n, nv), u (n, nu).
        fails: Which states (n) end an episode.
        dt: Time between actions [s].
        substeps: Steps of rk4 in that time.
    """

    model: Model
    largest: Array
    start: Callable[[np.random.Generator, int], tuple[Array, Array]]
    reward: Callable[[Array, Array, Array], Array]
    fails: Callable[[Array, Array], np.ndarray[Any, np.dtype[np.bool_]]]
    dt: float = 0.02
    substeps: int = 4

    def __post_init__(self) -> None:
        """Check the sizes."""
        rules.check_model(self.model)
        if np.shape(self.largest) != (self.model.nu,):
            raise rules.InteropError(
                Problem(
                    "task: wrong number of bounds", str(np.shape(self.largest)), f"({self.model.nu},)", "one an input"
                )
            )

    def advance(self, q: Array, v: Array, u: Array) -> tuple[Array, Array, Array, np.ndarray[Any, Any]]:
        """States after one action.

        Args:
            q: Configurations (n, nq).
            v: Speeds (n, nv).
            u: Inputs (n, nu).

        Returns:
            q, v, rewards (n), and which states (n) end their episodes; motions that end before the step does are among
            them, at their last good state.
        """
        run = simulate_batch(self.model, q, v, self.dt, u=u, dt=self.dt / self.substeps)
        return (
            run.q_last,
            run.v_last,
            self.reward(run.q_last, run.v_last, u),
            self.fails(run.q_last, run.v_last) | ~run.ok,
        )

    @property
    def action_space(self) -> Any:
        """Inputs, in single precision as agents have them."""
        largest = np.asarray(self.largest, dtype=np.float32)
        return gymnasium.spaces.Box(-largest, largest, dtype=np.float32)

    @property
    def observation_space(self) -> Any:
        """Coordinates, then speeds."""
        return gymnasium.spaces.Box(-np.inf, np.inf, (self.model.nq + self.model.nv,), np.float64)


class MechanismEnv(_Env):  # type: ignore[misc]
    """One mechanism.

    Args:
        task: What is asked of the agent.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, task: Task) -> None:
        self.task = task
        self.action_space, self.observation_space = task.action_space, task.observation_space
        self._q, self._v = np.zeros((1, task.model.nq)), np.zeros((1, task.model.nv))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """A first state (nq + nv)."""
        super().reset(seed=seed)
        self._q, self._v = self.task.start(self.np_random, 1)
        return self._observation(), {}

    def step(self, action: Any) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """The state (nq + nv) after an action, its reward, whether the episode has failed."""
        u = _bounded(self.task, np.asarray(action, dtype=np.float64).reshape(1, -1))
        self._q, self._v, reward, failed = self.task.advance(self._q, self._v, u)
        return self._observation(), float(reward[0]), bool(failed[0]), False, {}

    def _observation(self) -> Array:
        return np.concatenate([self._q[0], self._v[0]])


class MechanismVectorEnv(_VectorEnv):  # type: ignore[misc]
    """Many mechanisms, stepped together in C; one that ended begins anew at its next step.

    Args:
        task: What is asked of the agent.
        num_envs: Number of mechanisms.
        max_steps: Number of steps after which an episode is cut off.
    """

    def __init__(self, task: Task, num_envs: int, max_steps: int = 500) -> None:
        self.task, self.num_envs, self._max_steps = task, num_envs, max_steps
        self.single_action_space, self.single_observation_space = task.action_space, task.observation_space
        batch_space = gymnasium.vector.utils.batch_space
        self.action_space = batch_space(task.action_space, num_envs)
        self.observation_space = batch_space(task.observation_space, num_envs)
        self.metadata = {"render_modes": [], "autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP}
        self._q, self._v = np.zeros((num_envs, task.model.nq)), np.zeros((num_envs, task.model.nv))
        self._steps, self._ended = np.zeros(num_envs, dtype=np.int64), np.zeros(num_envs, dtype=bool)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """First states (num_envs, nq + nv)."""
        super().reset(seed=seed)
        self._q, self._v = self.task.start(self.np_random, self.num_envs)
        self._steps[:], self._ended[:] = 0, False
        return self._observations(), {}

    def step(self, actions: Any) -> tuple[Array, Array, Any, Any, dict[str, Any]]:
        """States (num_envs, nq + nv), rewards, failures and cut-offs (num_envs)."""
        u = _bounded(self.task, np.asarray(actions, dtype=np.float64))
        q, v, rewards, failed = self.task.advance(self._q, self._v, u)
        again = self._ended
        if again.any():
            q[again], v[again] = self.task.start(self.np_random, int(again.sum()))
            rewards, failed = np.where(again, 0.0, rewards), failed & ~again
        self._q, self._v = q, v
        self._steps = np.where(again, 0, self._steps + 1)
        cut = (self._steps >= self._max_steps) & ~failed
        self._ended = failed | cut
        return self._observations(), rewards, failed, cut, {}

    def _observations(self) -> Array:
        return np.concatenate([self._q, self._v], axis=1)


def _bounded(task: Task, u: Array) -> Array:
    """Inputs within their bounds."""
    return np.clip(u, -np.asarray(task.largest), np.asarray(task.largest))


def cart_pole(largest: float = 10.0) -> Task:
    """A pole on a cart, to be held upright: Barto, Sutton and Anderson (1983), with a continuous force.

    Args:
        largest: Largest force on the cart [N].
    """
    cart = Joint("x", "prismatic", axis=(1, 0, 0), effort=(as_value("F"),))
    pole = Joint("theta", "continuous", "cart", axis=(0, 1, 0))
    bodies = (
        RigidBody("cart", cart, Inertia(1.0)),
        # A uniform rod of one metre; it stands at theta = 0.
        RigidBody("pole", pole, Inertia(0.1, (0, 0, 0.5), (0.1 / 12, 0.1 / 12, 0))),
    )
    model = compile_system(System("cart_pole", bodies, inputs=(Input("F", "N"),), gravity=(0, 0, -9.8)))

    def start(rng: np.random.Generator, n: int) -> tuple[Array, Array]:
        return rng.uniform(-0.05, 0.05, (n, 2)), rng.uniform(-0.05, 0.05, (n, 2))

    def fails(q: Array, v: Array) -> np.ndarray[Any, np.dtype[np.bool_]]:
        return np.asarray((np.abs(q[:, 0]) > 2.4) | (np.abs(q[:, 1]) > np.radians(12.0)))

    return Task(model, np.array([largest]), start, lambda q, v, u: np.ones(len(q)), fails)
