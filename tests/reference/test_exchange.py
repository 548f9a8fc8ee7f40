"""The paper's task end to end: a hand takes hold, the other exchanges a part, which is locked and let go."""

from __future__ import annotations

import numpy as np

import symofros as sf
from reference_models.closed.exchange import PARTS, RACK, STOWAGE, WORKSITE
from reference_models.closed.two_arms import hand
from reference_models.diagrams.exchange import COMMANDS, T_END, exchanging

PLACES = {"worksite": WORKSITE, "stowage": STOWAGE, "rack": RACK}
RECORD = 0.1


def at(run: sf.DiagramRun, t: float) -> int:
    """Number of the record at a time."""
    return int(np.searchsorted(run.t, t - 1e-9))


def test_a_part_is_exchanged() -> None:
    run = sf.Simulation(exchanging()).run(T_END, dt=1e-3, record=RECORD)
    _check_commands(run)
    _check_parts(run)
    _check_hold(run)


def _check_commands(run: sf.DiagramRun) -> None:
    """Each acts at its instant, and no impact gives energy."""
    assert run.outcome.ok, run.outcome
    met = run.events["plant"]
    assert [(one.name, round(one.t, 9)) for one in met] == [(name, t) for name, (t, _) in COMMANDS.items()]
    for one in met:
        engages = any(COMMANDS[one.name][1].values())
        assert (one.energy_lost > 1e-9) if engages else (abs(one.energy_lost) < 1e-12), one.name


def _check_parts(run: sf.DiagramRun) -> None:
    """Between grasp and release the handle stays in the hand; before and after, the part in the station."""
    for part, (_, first, last) in PARTS.items():
        grasp, unlock, release = (COMMANDS[f"{verb}_{part}"][0] for verb in ("grasp", "unlock", "release"))
        carried = slice(at(run, grasp) + 1, at(run, release))
        in_hand = np.einsum("nji,nj->ni", run["hand.R"], run[f"{part}.p"] - run["hand.p"])[carried]
        assert np.ptp(in_hand, axis=0).max() < 1e-9, part
        before, after = run[f"{part}.p"][: at(run, unlock)], run[f"{part}.p"][at(run, release) + 1 :]
        assert max(np.ptp(x, axis=0).max() for x in (before, after)) < 1e-9, part
        goal = hand(PLACES[last], -1.0)[0]
        assert np.linalg.norm(before[0] - hand(PLACES[first], -1.0)[0]) < 1e-12
        # The mount gives way under what the arm carries; the constraint takes the part as it is.
        assert np.linalg.norm(after[-1] - goal) < 0.05, part


def _check_hold(run: sf.DiagramRun) -> None:
    """The hand that has taken hold stays."""
    frame = sf.compile(run.compiled.resolved.wired.models.system("plant"))
    held = range(at(run, COMMANDS["stabilise"][0]) + 1, len(run.t), 40)
    places = [frame.frame_pose("spdm_left_link7.end", run["plant.q"][i])[0] for i in held]
    assert np.ptp(places, axis=0).max() < 1e-9
