"""Gymnasium: environments that a model steps, one at a time or many in C.

    env = sf.interop.gymnasium.MechanismEnv(sf.interop.gymnasium.cart_pole())
    envs = sf.interop.gymnasium.MechanismVectorEnv(sf.interop.gymnasium.cart_pole(), num_envs=1024)

A Task states what is rewarded, where an episode ends and, where they vary, which parameters it has; steps are those of
`sf.Stepper` and `sf.Steppers`, inputs held. Environment k of many that are reset with seed s is the single one with
seed s + k, as in Gymnasium's own vector environments.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import symofros.interop.rules as rules
from symofros.base.arrays import Array
from symofros.compiler import compile_system
from symofros.description import Inertia, Input, Joint, RigidBody, System, as_value
from symofros.errors import Problem
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import Model
from symofros.simulation.stepper import Stepper
from symofros.simulation.steppers import Steppers

gymnasium = rules.framework("gymnasium", "gymnasium")
_Env: Any = gymnasium.Env
_VectorEnv: Any = gymnasium.vector.VectorEnv
_LARGEST_ANGLE = np.radians(12.0)  # Of a pole that still stands.


@dataclass(frozen=True)
class Task:
    """Task of an agent with a model.

    Attributes:
        model: Compiled model; its inputs u are the actions.
        largest: Largest magnitude of each input (nu) [N or N m].
        start: First states from a generator and their number n: q (n, nq), v (n, nv).
        reward: Rewards (n) of states after a step and of the inputs before it: q (n, nq), v (n, nv), u (n, nu).
        fails: Which states (n) end an episode.
        dt: Time between actions [s].
        substeps: Steps of rk4 in that time.
        parameters: Run-time parameters (n, npar) of n episodes from a generator (domain randomisation); those of the
            model if not given.
    """

    model: Model
    largest: Array
    start: Callable[[np.random.Generator, int], tuple[Array, Array]]
    reward: Callable[[Array, Array, Array], Array]
    fails: Callable[[Array, Array], np.ndarray[Any, np.dtype[np.bool_]]]
    dt: float = 0.02
    substeps: int = 4
    parameters: Callable[[np.random.Generator, int], Array] | None = None

    def __post_init__(self) -> None:
        """Check the sizes and numbers."""
        rules.check_model(self.model)
        largest, nu = np.asarray(self.largest, dtype=np.float64), self.model.nu
        if largest.shape != (nu,) or not (largest >= 0.0).all():
            found, rule = str(self.largest)[:60], f"({nu},), none negative"
            raise rules.InteropError("task: bounds of inputs do not fit", found, rule, "give one for each input")
        _check_count("task: no number of substeps", self.substeps, "substeps=1")

    def begin(self, rng: np.random.Generator) -> tuple[Array, Array, Array]:
        """First state of an episode, q (nq) and v (nv), and its parameters (npar).

        Raises:
            InteropError: `start` or `parameters` gives arrays of another shape.
            ShapeError: `start` gives a quaternion that is no rotation.
        """
        q, v, par = self._begin_each([rng])
        return q[0], v[0], par[0]

    def _begin_each(self, generators: Sequence[np.random.Generator]) -> tuple[Array, Array, Array]:
        """What `begin` gives of each generator: q (n, nq), v (n, nv), parameters (n, npar)."""
        states, model, drawn = list[Any](), self.model, list[Any]()
        for rng in generators:  # Of each episode its state, then its parameters.
            states.append(self.start(rng, 1))
            drawn += [self.parameters(rng, 1)] if self.parameters else []
        q, v = (
            _rows(f"{name} of start", values, size)
            for name, size, values in zip("qv", (model.nq, model.nv), zip(*states, strict=True), strict=True)
        )
        par = (
            _rows("parameters", drawn, model.npar) if self.parameters else np.tile(model.parameter_values, (len(q), 1))
        )
        return at_unit_length(model.record, "q", q, "q of start"), v, np.asarray(model.checked_parameters(par))

    def judge(self, q: Array, v: Array, u: Array) -> tuple[Array, np.ndarray[Any, Any]]:
        """Rewards (n) and whether episodes end (n), for states q (n, nq), v (n, nv) that inputs u (n, nu) led to."""
        rewards, failed, n = self.reward(q, v, u), self.fails(q, v), len(q)
        for name, found in (("reward", rewards), ("fails", failed)):
            if np.shape(found) != (n,):
                remedy = "return one number for each of the n states; np.full(len(q), x) where all have the same"
                raise rules.InteropError(
                    f"task: {name} does not fit", str(np.shape(found)), f"shape ({n},) for n = {n}", remedy
                )
        return rewards, failed

    @property
    def _steps(self) -> dict[str, Any]:
        """Integration method and step size of the steps between actions."""
        return {"method": "rk4", "dt": self.dt / self.substeps}

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

    Attributes:
        stepper: Stepper of the mechanism; a motion that ended goes on from its last good state.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, task: Task) -> None:
        self.task = task
        self.action_space, self.observation_space = task.action_space, task.observation_space
        self._least, self._largest = _bounds(task)
        self.stepper = Stepper(task.model, **task._steps)
        self._ready = False

    @property
    def par(self) -> Array:
        """Run-time parameters (npar) of the episode."""
        return self.stepper.par

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """A first state (nq + nv).

        Args:
            seed: Seed of the first state and of the parameters; without one the generator goes on.
            options: "par": run-time parameters (npar), or numbers by name, of this episode.

        Raises:
            InteropError: Another option is given.
        """
        super().reset(seed=seed)
        given = _checked_options(options, ("par",))
        q, v, par = self.task.begin(self.np_random)
        self.stepper.reset(q, v, par=par if given is None else given)
        self._ready = True
        return self._observation(), {}

    def step(self, action: Any) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """The state (nq + nv) after an action, its reward, whether the episode has failed.

        Raises:
            gymnasium.error.ResetNeeded: No episode has begun.
        """
        if not self._ready:
            raise _reset_needed("no episode has begun")
        u = _bounded(np.asarray(action, dtype=np.float64).reshape(-1), self._least, self._largest)
        stepper = self.stepper
        if not stepper.running:
            stepper.reset(stepper.q, stepper.v, stepper.t, z=stepper.z)
        going = stepper.step(u, self.task.substeps)
        reward, failed = self.task.judge(stepper.q[None], stepper.v[None], u[None])
        return self._observation(), float(reward[0]), bool(failed[0]) or not going, False, {}

    def _observation(self) -> Array:
        return np.concatenate((self.stepper.q, self.stepper.v))


class MechanismVectorEnv(_VectorEnv):  # type: ignore[misc]
    """Many mechanisms, stepped together in C; one that ended begins anew at its next step.

    Args:
        task: What is asked of the agent.
        num_envs: Number of mechanisms.
        max_steps: Number of steps after which an episode is cut off.
    """

    def __init__(self, task: Task, num_envs: int, max_steps: int = 500) -> None:
        for name, count in (("num_envs", num_envs), ("max_steps", max_steps)):
            _check_count(f"MechanismVectorEnv: {name} does not fit", count, f"{name}=1 at least")
        self.task, self.num_envs, self._max_steps = task, num_envs, max_steps
        self.single_action_space, self.single_observation_space = task.action_space, task.observation_space
        batch_space = gymnasium.vector.utils.batch_space
        self.action_space = batch_space(task.action_space, num_envs)
        self.observation_space = batch_space(task.observation_space, num_envs)
        self.metadata = {"render_modes": [], "autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP}
        self._least, self._largest = _bounds(task)
        par = np.array(task.model.parameter_values)
        self._steppers = self._made(par if task.parameters is None else np.tile(par, (num_envs, 1)))
        self._state = np.dtype([("q", f"V{8 * task.model.nq}"), ("v", f"V{8 * task.model.nv}")])
        self._steps, self._ended = np.zeros(num_envs, dtype=np.int64), np.zeros(num_envs, dtype=bool)
        self._generators: list[np.random.Generator | None] = [None] * num_envs
        self._ready = False

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """States (num_envs, nq + nv), the first ones of those that are reset.

        Args:
            seed: Seeds of the environments, one each; a number s stands for s, s + 1, and so on. Where there is none
                the environment's generator goes on.
            options: "reset_mask": which environments are reset (num_envs, of bool), all by default; "par": run-time
                parameters (num_envs, npar), or arrays (num_envs) by name, of the episodes that begin.

        Raises:
            InteropError: Another option is given, or one does not fit; or the number of seeds is another one.
        """
        options = dict(options or {})
        chosen = np.flatnonzero(_checked_mask(options.pop("reset_mask", None), self.num_envs))
        given, seeds = _checked_options(options, ("par", "reset_mask")), _checked_seeds(seed, self.num_envs)
        for k in chosen.tolist():
            if seeds[k] is not None:
                self._generators[k] = gymnasium.utils.seeding.np_random(seeds[k])[0]
        self._begin(chosen)
        if given is not None:
            shape = (self.num_envs, self.task.model.npar)
            self._change(chosen, np.broadcast_to(self.task.model.checked_parameters(given), shape))
        self._ready = None not in self._generators
        return self._observations(), {}

    @property
    def par(self) -> Array:
        """Run-time parameters (num_envs, npar) of the episodes."""
        return np.broadcast_to(self._steppers.par, (self.num_envs, self.task.model.npar))

    def _made(self, par: Array) -> Steppers:
        return Steppers(self.task.model, self.num_envs, par=par, **self.task._steps)

    def _change(self, chosen: Any, par: Array) -> None:
        """Set the parameters of chosen environments from their rows of par (num_envs, npar); their states stay."""
        before = self._steppers
        if before.par.ndim == 1:  # They had one set for all.
            rows = self.par.copy()
            rows[chosen] = par[chosen]
            self._steppers = self._made(rows)
            self._steppers.reset(before.q, before.v, z=before.z)
        else:
            before.reset(before.q, before.v, par=par, which=_mask(chosen, self.num_envs))

    def step(self, actions: Any) -> tuple[Array, Array, Any, Any, dict[str, Any]]:
        """States (num_envs, nq + nv), rewards, failures and cut-offs (num_envs).

        Raises:
            gymnasium.error.ResetNeeded: An environment has had no reset.
        """
        if not self._ready:
            raise _reset_needed(f"{self._generators.count(None)} of {self.num_envs} environments have had none")
        u = _bounded(np.asarray(actions, dtype=np.float64), self._least, self._largest)
        again, steppers = self._ended, self._steppers
        going = steppers.step(u, self.task.substeps)
        rewards, failed = self.task.judge(steppers.q, steppers.v, u)
        failed = failed | ~going
        steps = self._steps + 1
        if again.any():
            self._begin(np.flatnonzero(again))
            rewards, failed = np.where(again, 0.0, rewards), failed & ~again
        self._steps = np.where(again, 0, steps)
        cut = (self._steps >= self._max_steps) & ~failed
        self._ended = failed | cut
        return self._observations(), rewards, failed, cut, {}

    def _begin(self, chosen: Any) -> None:
        """New episodes in some environments, given by their numbers."""
        q, v, par = self._steppers.q.copy(), self._steppers.v.copy(), self.par.copy()
        generators = self._generators
        for k in chosen.tolist():
            generators[k] = generators[k] or gymnasium.utils.seeding.np_random()[0]
        q[chosen], v[chosen], par[chosen] = self.task._begin_each([generators[k] for k in chosen.tolist()])
        self._steppers.reset(q, v, par=par if self._steppers.par.ndim > 1 else None, which=_mask(chosen, self.num_envs))
        self._steps[chosen] = 0
        # A new array: the one before is part of what was returned by the last step.
        self._ended = self._ended.copy()
        self._ended[chosen] = False

    def _observations(self) -> Array:
        states = np.empty(
            self.num_envs, self._state
        )  # Moved as one item each: entry by entry takes seven times as long.
        for name, values in (("q", self._steppers.q), ("v", self._steppers.v)):
            states[name] = values.view(self._state[name])[:, 0]
        return states.view(np.float64).reshape(self.num_envs, -1)


def _rows(name: str, values: Sequence[Any], size: int) -> Array:
    """What a task has drawn, a row (1, size) an episode, together (n, size)."""
    odd = next((np.shape(row) for row in values if np.shape(row) != (1, size)), None)
    if odd is not None:
        remedy = "return one row for each of the n episodes that are asked for"
        raise rules.InteropError(f"task: {name} do not fit", str(odd), f"shape (1, {size}) for n = 1", remedy)
    return np.array(values, dtype=np.float64).reshape(len(values), size)


def _mask(chosen: Any, count: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
    mask = np.zeros(count, dtype=bool)
    mask[chosen] = True
    return mask


def _checked_options(options: Mapping[str, Any] | None, known: tuple[str, ...]) -> Any:
    """The parameters among the options of a reset; None where there are none."""
    for name in options or {}:
        if name not in known:
            what, rule = f"reset: no option '{name!s:.40}'", f"options are {' and '.join(known)}"
            raise rules.InteropError(what, repr(name)[:60], rule, "leave it out; first states are drawn by Task.start")
    return (options or {}).get("par")


def _checked_mask(mask: Any, count: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Which environments are reset."""
    if mask is None:
        return np.ones(count, dtype=bool)
    array = np.asarray(mask)
    if array.dtype != bool or array.shape != (count,) or not array.any():
        found = f"{array.dtype} of shape {array.shape}, {int(np.count_nonzero(array))} of them true"
        rule = f"one bool for each of {count} environments, one of them true at least"
        raise rules.InteropError("reset: reset_mask does not fit", found, rule, "leave it out to reset all")
    return array


def _checked_seeds(seed: int | Sequence[int | None] | None, count: int) -> Sequence[int | None]:
    """One seed for each environment, or None."""
    if seed is None:
        return [None] * count
    if isinstance(seed, int | np.integer):
        return [int(seed) + k for k in range(count)]
    seeds = list(seed) if isinstance(seed, Sequence | np.ndarray) and not isinstance(seed, str) else []
    if len(seeds) != count or not all(one is None or isinstance(one, int | np.integer) for one in seeds):
        rule = f"a whole number, or one (or None) for each of {count}"
        raise rules.InteropError("reset: seeds do not fit", f"{type(seed).__name__} {seed!r:.60}", rule, "seed=0")
    return [None if one is None else int(one) for one in seeds]


def _reset_needed(found: str) -> Any:
    """The refusal of a step without a first state, of Gymnasium's class."""
    rule = "steps go on from the first state that reset() draws"
    return gymnasium.error.ResetNeeded(str(Problem("step before reset", found, rule, "reset() before the first step")))


def _check_count(what: str, count: object, remedy: str) -> None:
    """Refuse what is no whole number from 1 on."""
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
        raise rules.InteropError(what, repr(count)[:60], "a whole number from 1 on", remedy)


def _bounds(task: Task) -> tuple[Array, Array]:
    """Lower and upper bounds of the inputs (nu)."""
    largest = np.array(task.largest, dtype=np.float64)
    return -largest, largest


def _bounded(u: Array, least: Array, largest: Array) -> Array:
    """Inputs clipped to their bounds; np.clip would take some microseconds more."""
    return np.minimum(np.maximum(u, least), largest)


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

    # One step of rk4 errs by some 1e-6 in half a second of full forces.
    return Task(model, np.array([largest]), _nearly_upright, _standing, _fallen, substeps=1)


def _nearly_upright(rng: np.random.Generator, n: int) -> tuple[Array, Array]:
    return rng.uniform(-0.05, 0.05, (n, 2)), rng.uniform(-0.05, 0.05, (n, 2))


def _standing(q: Array, v: Array, u: Array) -> Array:
    return np.ones(len(q))


def _fallen(q: Array, v: Array) -> np.ndarray[Any, np.dtype[np.bool_]]:
    return np.asarray((np.abs(q[:, 0]) > 2.4) | (np.abs(q[:, 1]) > _LARGEST_ANGLE))
