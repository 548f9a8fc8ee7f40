"""Environments under Gymnasium's own checkers, and beside the equations."""

from __future__ import annotations

import pickle
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.late import late

late("gymnasium", extra="gymnasium")


@pytest.fixture(scope="module")
def task() -> Any:
    return sf.interop.gymnasium.cart_pole()


def test_gymnasium_checker_reports_nothing(task: Any) -> None:
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # That observations have no bounds is so: a pole may turn as often as it likes.
        warnings.filterwarnings("ignore", message=".*(infinity|Box|spec|render).*")
        check_env(sf.interop.gymnasium.MechanismEnv(task), skip_render_check=True)


def test_steps_before_a_reset_are_refused_as_gymnasium_does(task: Any) -> None:
    """An environment without a first state does not start at the neutral one; one of many that had no reset neither."""
    from gymnasium.error import ResetNeeded

    env = sf.interop.gymnasium.MechanismEnv(task)
    with pytest.raises(ResetNeeded, match="no episode has begun"):
        env.step([0.0])
    env.reset(seed=0)
    env.step([0.0])
    many = sf.interop.gymnasium.MechanismVectorEnv(task, 3)
    with pytest.raises(ResetNeeded, match="3 of 3 environments have had none"):
        many.step(np.zeros((3, 1)))
    many.reset(seed=0, options={"reset_mask": np.array([True, False, True])})
    with pytest.raises(ResetNeeded, match="1 of 3 environments have had none"):
        many.step(np.zeros((3, 1)))
    many.reset(options={"reset_mask": np.array([False, True, False])})
    many.step(np.zeros((3, 1)))


def test_a_cart_pole_fails_on_either_side(task: Any) -> None:
    """Beyond 2.4 m, or 12 degrees."""
    q = np.array([[0.0, 0.0], [2.39, 0.2], [-2.39, -0.2], [2.41, 0.0], [-2.41, 0.0], [0.0, 0.22], [0.0, -0.22]])
    assert task.fails(q, 0.0 * q).tolist() == [False] * 3 + [True] * 4


def test_vector_environments_equal_single_ones_bitwise(task: Any) -> None:
    envs = sf.interop.gymnasium.MechanismVectorEnv(task, 5)
    first, _ = envs.reset(seed=4)
    actions = np.linspace(-3.0, 3.0, 5).reshape(5, 1).astype(np.float32)
    many, rewards, *_ = envs.step(actions)
    for i in range(5):
        env = sf.interop.gymnasium.MechanismEnv(task)
        env.reset(seed=0)
        env.stepper.reset(first[i, :2], first[i, 2:])
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


def with_masses(task: Any, **more: Any) -> Any:
    """The task on a model whose pole's mass is drawn anew in each episode."""
    system = sf.System(
        "pole",
        (
            sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=("F",)), sf.Inertia(1.0)),
            sf.RigidBody("pole", sf.Joint("p", "continuous", "cart", axis=(0, 1, 0)), sf.Inertia("m", (0, 0, 0.5))),
        ),
        parameters=(sf.Parameter("m", 0.1),),
        inputs=(sf.Input("F"),),
        **more,
    )
    model = sf.compile(system)
    return sf.interop.gymnasium.Task(
        model, np.ones(1), task.start, task.reward, task.fails, parameters=lambda rng, n: rng.uniform(0.1, 2.0, (n, 1))
    )


@pytest.mark.parametrize(("seed", "masses"), [(7, False), ([5, None, 3], True)])
def test_vector_environments_match_gymnasiums_own(task: Any, seed: Any, masses: bool) -> None:
    """Gymnasium's own vector environment of single ones gives the same, seed by seed, episode after episode."""
    from gymnasium.vector import SyncVectorEnv
    from gymnasium.wrappers import TimeLimit

    made = with_masses(task) if masses else task
    ours = sf.interop.gymnasium.MechanismVectorEnv(made, 3, max_steps=5)
    theirs = SyncVectorEnv([lambda: TimeLimit(sf.interop.gymnasium.MechanismEnv(made), 5)] * 3)
    for envs in (ours, theirs):
        envs.reset(seed=[11, 12, 13])
    np.testing.assert_array_equal(ours.reset(seed=seed)[0], theirs.reset(seed=seed)[0])
    rng = np.random.default_rng(0)
    for _ in range(14):
        action = rng.uniform(-1.0, 1.0, (3, 1)).astype(np.float32)
        for mine, other in zip(ours.step(action)[:4], theirs.step(action)[:4], strict=True):
            np.testing.assert_array_equal(mine, other)
    if masses:
        np.testing.assert_array_equal(ours.par, [env.unwrapped.par for env in theirs.envs])
        assert len(np.unique(ours.par)) == 3


@pytest.mark.parametrize("drawn", [True, False])
def test_episode_parameters_affect_the_motion(task: Any, drawn: bool) -> None:
    """By the option or by drawing, for one and for many: the states are those of simulate_batch with them."""
    made = with_masses(task) if drawn else replace(with_masses(task), parameters=None)
    envs, env = sf.interop.gymnasium.MechanismVectorEnv(made, 2), sf.interop.gymnasium.MechanismEnv(made)
    first = envs.reset(seed=1, options={"par": {"m": [5.0, 0.1]}})[0]
    np.testing.assert_array_equal(envs.par, [[5.0], [0.1]])
    state = envs.step(np.ones((2, 1)))[0]
    q, v = first[:, :2], first[:, 2:]
    run = sf.simulate_batch(made.model, q, v, made.dt, u=np.ones((2, 1)), par=[[5.0], [0.1]], dt=made.dt / 4)
    np.testing.assert_array_equal(state, np.concatenate([run.q_last, run.v_last], axis=1))
    env.reset(seed=1, options={"par": {"m": 5.0}})
    np.testing.assert_array_equal(env.step(np.ones(1))[0], state[0])
    env.reset(seed=1)
    assert env.par != 5.0


def test_a_mask_resets_selected_environments(task: Any) -> None:
    envs = sf.interop.gymnasium.MechanismVectorEnv(task, 3, max_steps=4)
    first, _ = envs.reset(seed=3)
    moved = envs.step(np.ones((3, 1)))[0]
    state, _ = envs.reset(seed=[3, 4, 5], options={"reset_mask": np.array([False, True, False])})
    np.testing.assert_array_equal(state[[0, 2]], moved[[0, 2]])
    np.testing.assert_array_equal(state[1], first[1])
    cuts = [envs.step(np.zeros((3, 1)))[3].tolist() for _ in range(4)]
    assert cuts[2] == [True, False, True] and cuts[3] == [False, True, False]


def test_what_events_of_others_set_stays_where_one_environment_begins_anew(task: Any) -> None:
    """Parameters are the present ones; an episode begins with its own."""
    late_event = sf.Event("t - 0.03", action={"m": "m + 1"}, once=True)
    made = replace(with_masses(task, events={"late": late_event}), parameters=None)
    envs = sf.interop.gymnasium.MechanismVectorEnv(made, 2)
    envs.reset(seed=3)
    for _ in range(2):
        envs.step(np.ones((2, 1)))
    np.testing.assert_allclose(envs.par[:, 0], [1.1, 1.1])
    envs.reset(options={"reset_mask": np.array([True, False]), "par": {"m": [7.0, 8.0]}})
    np.testing.assert_allclose(envs.par[:, 0], [7.0, 1.1])
    envs.reset(options={"reset_mask": np.array([True, False])})
    np.testing.assert_allclose(envs.par[:, 0], [0.1, 1.1])


def test_parameters_of_selected_environments_leave_the_others_in_their_time(task: Any) -> None:
    envs = sf.interop.gymnasium.MechanismVectorEnv(with_masses(task), 3)
    envs.reset(seed=3, options={"par": {"m": [1.0, 2.0, 3.0]}})
    moved = envs.step(np.ones((3, 1)))[0]
    chosen = {"reset_mask": np.array([False, True, False]), "par": {"m": [7.0, 8.0, 9.0]}}
    state, _ = envs.reset(seed=[3, 4, 5], options=chosen)
    np.testing.assert_array_equal(envs.par[:, 0], [1.0, 8.0, 3.0])
    np.testing.assert_array_equal(state[[0, 2]], moved[[0, 2]])
    np.testing.assert_array_equal(envs._steppers.t, [task.dt, 0.0, task.dt])


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"options": {"state": [0.0] * 4}}, "no option 'state'"),
        ({"options": {"reset_mask": np.zeros(2, dtype=bool)}}, "reset_mask does not fit"),
        ({"seed": [1, 2, 3]}, "seeds do not fit"),
        ({"seed": 1.5}, "seeds do not fit"),
        ({"seed": "12"}, "seeds do not fit"),
        ({"seed": [1, 0.5]}, "seeds do not fit"),
    ],
)
def test_resets_that_mean_nothing_are_refused(task: Any, asked: dict[str, Any], says: str) -> None:
    with pytest.raises(sf.SymofrosError, match=says):
        sf.interop.gymnasium.MechanismVectorEnv(task, 2).reset(**asked)


@pytest.mark.parametrize("what", ["start", "parameters"])
def test_draws_of_another_shape_are_refused(task: Any, what: str) -> None:
    changed = {what: (lambda rng, n: (np.zeros(2), np.zeros(2))) if what == "start" else (lambda rng, n: np.zeros(3))}
    with pytest.raises(sf.SymofrosError, match="do not fit"):
        sf.interop.gymnasium.MechanismEnv(replace(with_masses(task), **changed)).reset(seed=0)


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"reward": lambda q, v, u: -q[:, :1]}, "reward does not fit"),
        ({"reward": lambda q, v, u: 1.0}, "reward does not fit"),
        ({"fails": lambda q, v: np.abs(q) > 1.0}, "fails does not fit"),
        ({"fails": lambda q, v: False}, "fails does not fit"),
        ({"largest": np.array([-1.0])}, "bounds of inputs do not fit"),
        ({"largest": np.array([np.nan])}, "bounds of inputs do not fit"),
        ({"largest": np.ones(2)}, "bounds of inputs do not fit"),
        ({"substeps": 0}, "no number of substeps"),
    ],
)
def test_tasks_that_mean_nothing_are_refused(task: Any, changed: dict[str, Any], says: str) -> None:
    for many in (True, False):
        with pytest.raises(sf.SymofrosError, match=says):
            odd = replace(task, **changed)
            envs, shape = sf.interop.gymnasium, (3, 1) if many else (1,)
            env = envs.MechanismVectorEnv(odd, 3) if many else envs.MechanismEnv(odd)
            env.reset()
            env.step(np.zeros(shape))


@pytest.mark.parametrize("sizes", [{"num_envs": 0}, {"num_envs": 2, "max_steps": 0}, {"num_envs": 1.5}])
def test_sizes_that_mean_nothing_are_refused(task: Any, sizes: dict[str, Any]) -> None:
    with pytest.raises(sf.SymofrosError, match="a whole number from 1 on"):
        sf.interop.gymnasium.MechanismVectorEnv(task, **sizes)


def test_resets_of_others_leave_the_states_of_forces() -> None:
    """Bristles that are bent stay so, also where the others' parameters are stated for the first time."""
    bristles = sf.LuGre(6.0, stiffness=4e3, damping=6.0, viscous=0.4)
    joint = sf.Joint("q", "revolute", axis=(0, 0, 1), elements=(bristles,), actuated=True)
    wheel = sf.RigidBody("wheel", joint, sf.Inertia(2.0, (0, 0, 0), (0.02, 0.02, "J")))
    model = sf.compile(sf.System("wheel", (wheel,), (sf.Parameter("J", 0.02),)))

    def rest(rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros((n, 1)), np.zeros((n, 1))

    def never(q: np.ndarray, v: np.ndarray) -> Any:
        return np.zeros(len(q), dtype=bool)

    turned = sf.interop.gymnasium.Task(model, np.array([9.0]), rest, lambda q, v, u: q[:, 0], never, 1e-3, 1)
    ends = []
    for options in (None, {}, {"par": np.full((2, 1), 0.02)}):
        envs = sf.interop.gymnasium.MechanismVectorEnv(turned, 2)
        envs.reset(seed=0)
        for k in range(40):
            if k == 20 and options is not None:
                envs.reset(options={"reset_mask": np.array([True, False]), **options})
            state, *_ = envs.step(np.full((2, 1), 4.0))
        ends.append(state[1])
    np.testing.assert_array_equal(ends[1], ends[0])
    np.testing.assert_allclose(ends[2], ends[0], rtol=1e-12)  # Other C where each has its own parameters.


def test_tasks_can_be_sent_to_other_processes(task: Any) -> None:
    again = sf.interop.gymnasium.MechanismEnv(pickle.loads(pickle.dumps(task)))
    env = sf.interop.gymnasium.MechanismEnv(task)
    np.testing.assert_array_equal(env.reset(seed=3)[0], again.reset(seed=3)[0])
    np.testing.assert_array_equal(env.step([1.0])[0], again.step([1.0])[0])


def test_observations_hold_coordinates_then_speeds_where_there_are_more_of_the_first() -> None:
    """A ball joint: 4 and 3, of each environment its own."""
    body = sf.RigidBody("top", sf.Joint("b", "ball"), sf.Inertia(1.0, (0, 0, 0.3), (0.1, 0.2, 0.25)))

    def start(rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
        q = rng.standard_normal((n, 4))
        return q / np.linalg.norm(q, axis=1, keepdims=True), rng.standard_normal((n, 3))

    kept = sf.interop.gymnasium.Task(
        sf.compile(sf.System("top", (body,))), np.zeros(0), start, lambda q, v, u: v[:, 2], lambda q, v: v[:, 2] > 9.0
    )
    envs = sf.interop.gymnasium.MechanismVectorEnv(kept, 6)
    first, _ = envs.reset(seed=3)
    state, rewards, *_ = envs.step(np.zeros((6, 0)))
    assert state.shape == (6, 7) and (rewards == state[:, 6]).all()
    for k in range(6):
        env = sf.interop.gymnasium.MechanismEnv(kept)
        assert (env.reset(seed=3 + k)[0] == first[k]).all()
        np.testing.assert_allclose(env.step(np.zeros(0))[0], state[k], rtol=1e-12)


def test_one_step_an_action_is_accurate_for_the_cart_pole(task: Any) -> None:
    ends = []
    for substeps in (task.substeps, 16):
        envs = sf.interop.gymnasium.MechanismVectorEnv(replace(task, substeps=substeps), 16)
        state, _ = envs.reset(seed=1)
        forces = np.random.default_rng(0)
        for _ in range(15):
            state, _, failed, *_ = envs.step(forces.uniform(-10.0, 10.0, (16, 1)))
        ends.append(state)
    assert not failed.any() and np.abs(ends[0] - ends[1]).max() < 2e-6
