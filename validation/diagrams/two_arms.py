"""Two arms at work: what taking hold of a stabilisation point does for the arm that carries."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import symofros as sf

from ..mechanics.geometry import Array
from ..references import reference_module
from ..reporting.figures import Chart, Curve, Figure, Mark
from ..reporting.findings import Finding, Study

if TYPE_CHECKING:
    from reference_models.closed.two_arms import HOLD, hand
    from reference_models.diagrams.two_arms import GRIPPED, PLACED, T_END, working
else:
    _two_arms = reference_module("closed.two_arms")
    HOLD, hand = _two_arms.HOLD, _two_arms.hand
    _at_work = reference_module("diagrams.two_arms")
    GRIPPED, PLACED, T_END, working = _at_work.GRIPPED, _at_work.PLACED, _at_work.T_END, _at_work.working

DT, RECORD = 1e-3, 0.02
_SPRINGS = tuple(f"{kind}_{axis}" for kind in ("give", "sway") for axis in "xyz")


def study(quick: bool) -> Study:
    """Measure a mount's sway while the right arm carries a payload, with the left hand holding and not holding."""
    held = sf.Simulation(working())
    with_grip = held.run(T_END, dt=DT, record=RECORD)
    open_hand = sf.Simulation(working(grips=False)).run(T_END, dt=DT, record=RECORD)
    point, _ = hand(HOLD)
    gap = {
        name: np.linalg.norm(run["hand.p"] - np.array(point), axis=1)
        for name, run in (("takes hold", with_grip), ("stays open", open_hand))
    }
    carrying = (with_grip.t > GRIPPED + 1.0) & (with_grip.t < PLACED + 2.0)
    swing = {
        name: np.ptp(_mount(run)[carrying], axis=0)
        for name, run in (("takes hold", with_grip), ("stays open", open_hand))
    }
    finer = held.run(GRIPPED + 2.0, dt=DT / 2, record=RECORD)
    same = float(np.abs(finer["payload.p"] - with_grip["payload.p"][: len(finer.t)]).max())
    at = int(np.searchsorted(with_grip.t, GRIPPED - 1e-9))
    sway = float(swing["takes hold"][1] / swing["stays open"][1])
    findings = _findings(with_grip, gap["takes hold"], sway, same, at)
    answer = (
        f"The left hand reaches its point, off by {1e3 * gap['takes hold'][at - 1]:.1f} mm because the mount sways, and"
        f" takes hold at {GRIPPED:.0f} s: from then on six conditions hold that were off before, in the same run. While"
        f" the right arm carries 200 kg, the mount sways by {_millimetres(swing['takes hold'])} mm along x, y and z,"
        f" against {_millimetres(swing['stays open'])} mm with the hand open: the point lies on the y side, and the"
        " arm, bent, has little leverage across."
    )
    return Study(
        "What does a stabilisation point do for two arms at work?",
        answer,
        (_motion(with_grip, open_hand), _grip(with_grip, gap)),
        findings,
        ("the SYMOFROS paper, introduction: the task; all values are ours",),
    )


def _findings(run: sf.DiagramRun, gap: Array, sway: float, same: float, at: int) -> tuple[Finding, ...]:
    """What is asked of the run that takes hold.

    Args:
        run: The run.
        gap: Distances of the hand from its point [m].
        sway: Sway of the mount towards the point, over that with the hand open.
        same: Largest difference of the payload's place with half the step [m].
        at: Number of the first instant with the grip.
    """
    later = run.t > GRIPPED + 0.01
    return (
        Finding(
            "hand on the point once it has taken hold [m]",
            float(gap[later].max()),
            1e-9,
            reason="a closure kept by projection",
        ),
        Finding(
            "hand off the point just before [m]",
            float(gap[at - 1]),
            1e-3,
            1e-5,
            "the mount sways from the arm's own motion; a grip takes up a thousandth at most, as a plastic impact",
        ),
        Finding(
            "multipliers before the grip, largest [N, N m]",
            float(np.abs(run["felt"][:at]).max()),
            0.0,
            reason="rows of a constraint that is off are zero",
        ),
        Finding(
            "multipliers after it, largest [N, N m]",
            float(np.abs(run["felt"][later]).max()),
            1e5,
            1.0,
            "the point carries what the payload's motion asks for",
        ),
        Finding(
            "sway of the mount along y, towards the point, with the grip over without it",
            sway,
            0.5,
            reason="what the stabilisation point is for; across, the arm has less leverage",
        ),
        Finding("payload, step halved [m]", same, 1e-3, reason="an impact moves by a step at most"),
        Finding(
            "seconds of motion a second",
            T_END / run.cost.worked,
            np.inf,
            1.0,
            "21 speeds, 6 constraints, 500 Hz control: faster than real time",
        ),
    )


def _millimetres(lengths: Array) -> str:
    return ", ".join(f"{1e3 * length:.0f}" for length in lengths)


def _mount(run: sf.DiagramRun) -> Array:
    """Displacements of the mount along x, y, z (n, 3) [m]."""
    resolved = run.compiled.resolved
    names = resolved.layout.q_names[resolved.layout.q["plant"].slice]
    places = [names.index(f"plant.{name}") for name in _SPRINGS[:3]]
    positions: Array = run["plant.q"][:, places]
    return positions


def _motion(held: sf.DiagramRun, free: sf.DiagramRun) -> Figure:
    marks = (Mark("takes hold", GRIPPED, "x"), Mark("placed", PLACED, "x"))
    sway = tuple(
        Curve(f"{axis}, {name}", run.t, 1e3 * _mount(run)[:, k], k, kind)  # type: ignore[arg-type]
        for name, run, kind in (("holding", held, "line"), ("open", free, "dotted"))
        for k, axis in enumerate("xyz")
    )
    payload = tuple(Curve(axis, held.t, held["payload.p"][:, k], k) for k, axis in enumerate("xyz"))
    return Figure(
        "Left: where the payload is. Right: the mount, which stands for the tip of the large arm, sways with every"
        " motion of the arms; held by the left hand (lines) it hardly moves along y, where the point is; with the"
        " hand open (dotted) it does.",
        (
            Chart("payload", "time [s]", "position [m]", payload, marks),
            Chart("mount", "time [s]", "displacement [mm]", sway, marks),
        ),
    )


def _grip(run: sf.DiagramRun, gap: dict[str, Array]) -> Figure:
    distance = tuple(Curve(name, run.t, values, k) for k, (name, values) in enumerate(gap.items()))
    labels = ("x", "y", "z", "rx", "ry", "rz")
    forces = tuple(Curve(name, run.t, run["felt"][:, k], k) for k, name in enumerate(labels[:3]))
    moments = tuple(Curve(name, run.t, run["felt"][:, k + 3], k) for k, name in enumerate(labels[3:]))
    mark = (Mark("takes hold", GRIPPED, "x"),)
    return Figure(
        "The hand's distance from its point: from the grip on it is zero to rounding. Then what the point feels:"
        " nothing before, the impact as the hand takes hold, and what the payload's motion asks for.",
        (
            Chart("hand to point", "time [s]", "distance [m]", distance, mark, log="y"),
            Chart("forces of the closure", "time [s]", "multiplier [N]", forces, mark),
            Chart("moments of the closure", "time [s]", "multiplier [N m]", moments, mark),
        ),
    )
