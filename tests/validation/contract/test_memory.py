"""Results are kept by what they depend on, the latest few."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from reference_models import MODELS
from validation.adapters.closed import ConstrainedEngine, joined_frames
from validation.adapters.compiled import build
from validation.contract.interface import States, Subject
from validation.contract.memory import KEPT, LatestResults
from validation.contract.quantities import CONSTRAINED
from validation.mechanics.assembly import assemble


def test_remembered_results_follow_arrays_changed_in_place() -> None:
    latest: LatestResults[float] = LatestResults()
    x = np.arange(3.0)
    assert latest.get((x,), lambda: float(x.sum())) == 3.0
    x[0] = 5.0
    assert latest.get((x,), lambda: float(x.sum())) == 8.0
    assert latest.get((x, x), lambda: -1.0) == -1.0


def test_the_oldest_result_is_left_out_first() -> None:
    latest: LatestResults[int] = LatestResults()
    asked: Counter[int] = Counter()

    def ask(k: int) -> int:
        return latest.get((np.array([float(k)]),), lambda: asked.update([k]) or k)  # type: ignore[func-returns-value]

    assert [ask(k) for k in [*range(KEPT), *range(KEPT), KEPT, 0]] == [*range(KEPT), *range(KEPT), KEPT, 0]
    assert asked == {0: 2, **dict.fromkeys(range(1, KEPT + 1), 1)}


def test_an_engine_of_trees_is_asked_once_for_the_kinematics_of_all_quantities_of_constraints(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each of five quantities of a loop asked for poses, velocities, accelerations and Jacobians anew."""
    system = MODELS["four_bar"]
    subject = Subject("four_bar", system)
    anchored = build(replace(subject, frames=joined_frames(assemble(system), system)))
    asked: Counter[str] = Counter()
    for name in ("frame_pose", "frame_velocity", "frame_acceleration", "frame_jacobian"):
        method = getattr(type(anchored), name)

        def counted(self: object, states: States, name: str = name, method: object = method) -> object:
            asked[name] += 1
            return method(self, states)  # type: ignore[operator]

        monkeypatch.setattr(type(anchored), name, counted)
    engine = ConstrainedEngine(anchored, anchored, subject, anchored.frames)
    rng = np.random.default_rng(4)
    q, v, a, u = (rng.standard_normal((3, n)) for n in (3, 3, 3, anchored.model.nu))
    states = States(q, v, a, u, 0.1 * v, 0.0 * v)
    values = {name: getattr(engine, name)(states) for name in (*sorted(CONSTRAINED), "forward_dynamics")}
    assert set(asked.values()) == {1}
    later = replace(states, applied=2.0 * states.applied)
    assert not np.allclose(engine.forward_dynamics(later), values["forward_dynamics"])  # Forces are arguments, too.
    assert set(asked.values()) == {1}
    residual = np.einsum("nij,nj->ni", engine.constraint_jacobian(states), values["forward_dynamics"])
    np.testing.assert_allclose(residual, values["constraint_bias"], atol=1e-9)
