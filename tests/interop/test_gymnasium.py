"""Environments under Gymnasium's own checkers, and beside the equations."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.late import late

late("gymnasium", extra="gymnasium")


@pytest.fixture(scope="module")
def task() -> Any:
    return sf.interop.gymnasium.cart_pole()


def test_gymnasiums_checker_has_nothing_to_say(task: Any) -> None:
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # That observations have no bounds is so: a pole may turn as often as it likes.
        warnings.filterwarnings("ignore", message=".*(infinity|Box|spec|render).*")
        check_env(sf.interop.gymnasium.MechanismEnv(task), skip_render_check=True)


def test_many_move_as_one_does_to_the_last_bit(task: Any) -> None:
    envs = sf.interop.gymnasium.MechanismVectorEnv(task, 5)
    first, _ = envs.reset(seed=4)
    actions = np.linspace(-3.0, 3.0, 5).reshape(5, 1).astype(np.float32)
    many, rewards, *_ = envs.step(actions)
    for i in range(5):
        env = sf.interop.gymnasium.MechanismEnv(task)
        env.reset(seed=0)
        env._q, env._v = first[i : i + 1, :2], first[i : i + 1, 2:]
        np.testing.assert_array_equal(env.step(actions[i])[0], many[i])
    np.testing.assert_array_equal(rewards, np.ones(5))


def test_a_linear_regulator_keeps_the_pole_up_and_no_force_lets_it_fall(task: Any) -> None:
    A, B = task.model.linearize(np.zeros(2), np.zeros(2), np.zeros(1))
    from scipy.linalg import solve_continuous_are

    gain = B.T @ solve_continuous_are(A, B, np.diag([1.0, 10.0, 1.0, 1.0]), np.eye(1))
    envs = sf.interop.gymnasium.MechanismVectorEnv(task, 16, max_steps=150)
    for factor, stays in ((1.0, True), (0.0, False)):
        state, _ = envs.reset(seed=1)
        fallen = np.zeros(16, dtype=bool)
        for _ in range(149):
            state, _, failed, cut, _ = envs.step(np.clip(-factor * state @ gain.T, -10, 10))
            assert not cut.any()
            fallen |= failed
        assert fallen.any() != stays


def test_an_ended_episode_begins_anew_at_the_next_step(task: Any) -> None:
    envs = sf.interop.gymnasium.MechanismVectorEnv(task, 2, max_steps=3)
    envs.reset(seed=2)
    zero = np.zeros((2, 1))
    cuts = [envs.step(zero)[3].tolist() for _ in range(4)]
    assert cuts == [[False] * 2, [False] * 2, [True] * 2, [False] * 2]
    state, rewards, *_ = envs.step(zero)
    assert np.abs(state).max() < 0.2 and rewards.tolist() == [1.0, 1.0]


def test_bounds_of_another_size_are_refused(task: Any) -> None:
    with pytest.raises(sf.SymofrosError, match="one an input"):
        sf.interop.gymnasium.Task(task.model, np.ones(3), task.start, task.reward, task.fails)
