"""The woodpecker toy by rigid contacts: its limit cycle, beside SciPy's (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.simulation.contacts import woodpecker

# A cycle: the beak strikes, the sleeve's upper edge strikes, slides and lets go; the lower one strikes, slides until
# it jams, holds the toy while the bird swings back, slides again and lets go.
CYCLE = ("beak strikes", "upper slides", "upper opens", "lower slides", "lower sticks", "lower slides", "lower opens")
MODES = ((0, 0, 0), (0, 0, 1), (0, 0, 0), (0, -1, 0), (0, 2, 0), (0, -1, 0), (0, 0, 0))


def absolute(x: Any) -> Any:
    """Height and angles against the world, or their rates, from those of the joints."""
    return np.array([x[0], x[1], x[1] + x[2]])


def test_the_woodpecker_comes_to_its_limit_cycle() -> None:
    """From any start it pecks its way down: each cycle as the last one, and as an integration of its own says."""
    model = sf.compile(woodpecker.system())
    run = sf.simulate(model, [0, -0.1, -0.1], [-0.4, 0, -5.0], t_end=1.45, method="dopri5", rtol=1e-10, atol=1e-12)
    assert run.outcome.ok, run.outcome
    assert min(event.energy_lost for event in run.events) > -1e-15
    strikes = [k for k, event in enumerate(run.events) if event.name == "beak strikes"]
    first, last = strikes[-2:]
    events = run.events[first : last + 1]
    assert tuple(event.name for event in events) == (*CYCLE, CYCLE[0])
    period, before = (run.events[b].t - run.events[a].t for a, b in ((first, last), (strikes[-3], first)))
    assert period == pytest.approx(0.18812169, abs=2e-8) and before == pytest.approx(period, abs=2e-7)
    assert events[0].q[0] - events[-1].q[0] == pytest.approx(0.04874972, abs=1e-7)
    start = np.concatenate([absolute(events[0].q), absolute(events[0].v)])
    known = woodpecker.integrate(start, period + 1e-4)
    assert [name for _, name, _, _ in known] == [event.name.split()[0] for event in events[1:]]
    assert tuple(modes for _, _, modes, _ in known) == (*MODES[1:], MODES[0])
    np.testing.assert_allclose([t for t, *_ in known], [event.t - events[0].t for event in events[1:]], atol=1e-9)
    for (*_, x), event in zip(known, events[1:], strict=True):
        np.testing.assert_allclose(x[:3], absolute(event.q), atol=1e-9)
        np.testing.assert_allclose(x[3:], absolute(event.v_after), atol=1e-6)
