import numpy as np
import pytest

import symofros as sf
from tests.validation.subjects import every_kind, states_of, subject_of
from validation.adapters.compiled import build_weightless
from validation.comparison.motion import FreeMotion, fall, judge_drift, step

SUBJECT = every_kind()
FUNCTIONS = ("forward_dynamics", "generalized_force", "kinetic_energy", "potential_energy")


@pytest.fixture(scope="module")
def model() -> sf.Model:
    return sf.compile(SUBJECT.system, sf.Options(functions=FUNCTIONS))


def test_steps_are_of_fourth_order_on_rotations_too(model: sf.Model) -> None:
    states = states_of(SUBJECT, 12)
    q0, v0 = states.q[-2:], states.v[-2:]
    u = np.zeros((2, model.nu))

    def end(steps: int) -> tuple[np.ndarray, np.ndarray]:
        q, v = q0, v0
        for _ in range(steps):
            q, v, _ = step(model, q, v, u, 0.2 / steps)
        return q, v

    exact = end(240)
    errors = [np.abs(model.difference(end(n)[0], exact[0])).max() for n in (15, 30, 60)]
    for coarse, fine in zip(errors, errors[1:], strict=False):
        assert 3.7 < np.log2(coarse / fine) < 4.6


def test_energy_and_work_balance_in_a_motion(model: sf.Model) -> None:
    states = states_of(SUBJECT, 12)
    row = judge_drift("m", fall(model, states.q[-2:], states.v[-2:]))
    assert row.ok and row.error is not None and row.error < 1e-9


def test_work_of_a_damper_is_counted() -> None:
    joint = sf.Joint("q", "revolute", axis=(0, 1, 0), effort=("-2*dq",))
    body = sf.RigidBody("rod", joint, sf.Inertia(1.0, (0.5, 0, 0), (0.1, 0.1, 0.1)))
    damped = sf.compile(subject_of(sf.System("damped", [body])).system, sf.Options(functions=FUNCTIONS))
    motion = fall(damped, np.array([[0.3]]), np.array([[4.0]]))
    assert motion.drift[1] < 1e-9


def test_work_on_a_spring_is_counted_once() -> None:
    joint = sf.Joint("q", "revolute", axis=(0, 1, 0), elements=[sf.Spring(30.0, 0.4), sf.Damper(0.5)])
    system = sf.System("sprung", [sf.RigidBody("rod", joint, sf.Inertia(1.0, (0.5, 0, 0), (0.1, 0.1, 0.1)))])
    sprung = sf.compile(system, sf.Options(functions=FUNCTIONS))
    weightless = build_weightless(subject_of(system))
    motion = fall(sprung, np.array([[0.3]]), np.array([[4.0]]), weightless)
    assert motion.drift[1] < 1e-9


def with_drift(coarse: float, fine: float) -> FreeMotion:
    return FreeMotion(states_of(SUBJECT, 1), 1.0, (coarse, fine))


@pytest.mark.parametrize(
    ("coarse", "fine", "status"),
    [
        (1.6e-6, 1.0e-7, "agree"),  # Fourth order.
        (1.6e-6, 8.0e-7, "disagree"),  # First order: a term is missing somewhere.
        (1.6e-6, 1.6e-6, "disagree"),  # No order: energy is not conserved.
        (5.0e-13, 4.0e-13, "agree"),  # Rounding.
        (0.5, 0.03, "disagree"),  # Too coarse to say.
        (float("nan"), 1.0, "failed"),
    ],
)
def test_drift_decides_the_verdict(coarse: float, fine: float, status: str) -> None:
    assert judge_drift("m", with_drift(coarse, fine)).status == status


@pytest.mark.slow
def test_stiff_dampers_are_watched_for_a_shorter_time() -> None:
    """A damper that stops its link within 10 us makes the explicit method run away with steps of 1 ms."""
    joint = sf.Joint("q", "revolute", axis=(0, 1, 0), elements=[sf.Damper(1.0)])
    body = sf.RigidBody("rod", joint, sf.Inertia(1e-5, (0, 0, 0), (1e-5, 1e-5, 1e-5)))
    damped = sf.compile(sf.System("damped", [body]), sf.Options(functions=FUNCTIONS))
    motion = fall(damped, np.array([[0.3]]), np.array([[4.0]]))
    assert motion.step == pytest.approx(1e-6) and judge_drift("m", motion).ok
