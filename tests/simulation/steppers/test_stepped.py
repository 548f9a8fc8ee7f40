"""What a loop of one's own might try on steppers takes effect, or is refused in words: nothing is silently ignored."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled

DT = 1e-3
FOUR_PARTS = r"[\s\S]*found:[\s\S]*rule:[\s\S]*remedy:"


def one(**options: Any) -> sf.Stepper:
    return sf.Stepper(compiled("cart_pole"), dt=DT, **options)


def many(**options: Any) -> sf.Steppers:
    return sf.Steppers(compiled("cart_pole"), 3, dt=DT, **options)


@pytest.mark.parametrize("made", [one, many])
@pytest.mark.parametrize("name", ["q", "v", "t", "u", "par", "dt", "inputs", "model"])
def test_assignments_without_effect_on_steps_are_refused(made: Any, name: str) -> None:
    stepper = made()
    with pytest.raises(sf.SymofrosError, match=f"{name} is not assigned" + FOUR_PARTS):
        setattr(stepper, name, getattr(stepper, name))
    for array in (stepper.q, stepper.v, stepper.par):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 1.0
    stepper.note = "an attribute of the caller's"
    assert np.all(stepper.step([1.0]))


def test_given_parameters_are_copied() -> None:
    par = np.tile(compiled("cart_pole").parameter_values, (3, 1))
    steppers = many(par=par)
    kept, energy = par.copy(), steppers.energy
    par[:] = 7.0
    np.testing.assert_array_equal(steppers.par, kept)
    np.testing.assert_array_equal(steppers.energy, energy)


def test_states_of_many_have_their_parameters() -> None:
    par = np.tile(compiled("cart_pole").parameter_values, (3, 1))
    steppers = many(par=par)
    steppers.reset([0.0, 0.3])
    steppers.step([1.0], 5)
    state = steppers.save()
    steppers.step([1.0], 20)
    reached, a = steppers.q.copy(), steppers.a
    steppers.reset([0.0, 0.1], par=1.5 * par)
    steppers.step([1.0], 3)
    steppers.restore(state)
    np.testing.assert_array_equal(steppers.par, par)
    steppers.step([1.0], 20)
    np.testing.assert_array_equal(steppers.q, reached)
    np.testing.assert_array_equal(steppers.a, a)


@pytest.mark.parametrize("how", [copy.copy, copy.deepcopy, lambda stepper: stepper.copy()])
@pytest.mark.parametrize("made", [one, many])
def test_copies_share_no_memory(made: Any, how: Any) -> None:
    stepper = made()
    stepper.step([1.0])
    other, before = how(stepper), stepper.q.copy()
    assert np.all(other.step([5.0]))
    np.testing.assert_array_equal(stepper.q, before)
    stepper.step([5.0])
    np.testing.assert_array_equal(stepper.q, other.q)
    other.restore(stepper.save())


@pytest.mark.parametrize("made", [one, many])
def test_steppers_are_not_pickled_and_their_states_only_go_back(made: Any) -> None:
    stepper = made()
    stepper.step([1.0])
    with pytest.raises(sf.SymofrosError, match="not pickled" + FOUR_PARTS):
        pickle.dumps(stepper)
    state = pickle.loads(pickle.dumps(stepper.save()))
    q = stepper.q.copy()
    stepper.step([1.0])
    stepper.restore(state)
    np.testing.assert_array_equal(stepper.q, q)
    assert len(repr(state)) < 400 and "cart_pole" in repr(stepper)


OTHER_PROCESS = """
import pickle, sys
import reference_models
import symofros as sf
from symofros.reference_models import MODELS
model = sf.compile(MODELS["cart_pole"])
states = pickle.loads(open(sys.argv[1], "rb").read())
for stepper, state in zip((sf.Stepper(model, dt=1e-2), sf.Steppers(model, 3, dt=1e-3)), states):
    try:
        stepper.restore(state)
    except sf.SymofrosError as error:
        assert "in the same process" in str(error)
    else:
        raise SystemExit("restored memory of another process")
"""


def test_states_of_another_process_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "states"
    file.write_bytes(pickle.dumps([one().save(), many().save()]))
    subprocess.run([sys.executable, "-c", OTHER_PROCESS, str(file)], check=True, timeout=300)


def test_a_class_of_the_callers_has_its_own_step() -> None:
    class Counted(sf.Stepper):
        count = 0

        def step(self, u: Any = None, steps: int = 1) -> bool:
            self.count += 1
            return super().step(u, steps)

    stepper = Counted(compiled("cart_pole"), dt=DT)
    assert stepper.step([1.0]) and stepper.step([1.0]) and stepper.count == 2


MESSAGES: dict[str, tuple[Callable[[], object], str]] = {
    "end": (lambda: one(t_end=2.0), "t_end[\\s\\S]*loop that makes the steps[\\s\\S]*remedy: leave it out"),
    "first": (lambda: one(q0=[0.0, 0.0]), r"q0[\s\S]*remedy: reset\(q, v, t\)"),
    "steps": (lambda: one().step(2), r"u does not fit[\s\S]*step\(steps=2\) makes 2 steps"),
    "option": (lambda: one(timestep=1e-3), r"arguments u, par, events[\s\S]*did you mean 'dt'"),
    "law": (lambda: one(u={"F": "t"}).step([1.0]), "all inputs are laws and numbers"),
    "row": (lambda: many().step([[0.0], [np.nan], [0.0]]), "nan for 'F' of motion 1"),
    "motion": (lambda: many().outcome(3), "no such motion" + FOUR_PARTS),
    "mask": (lambda: many().reset(which=[0, 1]), r"which does not fit[\s\S]*np.isin"),
}


@pytest.mark.parametrize("case", MESSAGES)
def test_messages_name_what_is_meant(case: str) -> None:
    call, said = MESSAGES[case]
    with pytest.raises(sf.SymofrosError, match=said):
        call()


@pytest.mark.parametrize(("method", "steps"), [("rk4", 60), ("rk4", 500), ("dopri5", 60)])
def test_two_threads_lose_no_step_in_silence(method: str, steps: int) -> None:
    stepper = one(method=method)
    stepper.reset({"q": 0.1})
    stepper.step([0.0])
    made, refused = [1], []

    def loop() -> None:
        for _ in range(200):
            try:
                stepper.step(None, steps)
                made.append(steps)
            except sf.SymofrosError as error:
                refused.append(str(error))

    threads = [threading.Thread(target=loop) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert stepper.t == pytest.approx(sum(made) * DT, rel=1e-12)
    assert all("another thread" in error and "remedy:" in error for error in refused)


def test_unknown_arguments_of_step_are_refused_without_a_private_name() -> None:
    stepper = one()
    with pytest.raises(TypeError, match=r"Stepper\.step\(\) got an unexpected keyword argument 'dt'"):
        stepper.step([1.0], dt=1e-2)  # type: ignore[call-arg]
