"""The paper's square (section 8): how a rigid model's controller guides the flexible robot, and what that costs."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

import symofros as sf

from ..mechanics.geometry import Array
from ..references import MODELS, reference_module
from ..reporting.figures import Chart, Curve, Figure, Mark
from ..reporting.findings import Finding, Study

if TYPE_CHECKING:
    from reference_models.diagrams.square import square
else:
    square = reference_module("diagrams.square").square

DT, RECORD, T_END = 2.5e-4, 0.005, 12.0
APPROACH, ALONG, CORNER, SIDE = 3.0, 2.0, (0.3, 0.3), 0.6  # As the diagram's file has them.
MOST = 5
MOTORS = ("q1", "q2", "q3")


def softened(foreshortening: bool) -> sf.System:
    """The robot with foreshortening on or off in both links."""
    system = MODELS["planar_robot"]
    beams = system.beams
    stated: dict[str, str] = {} if foreshortening else {"retain": "zeroth_order"}
    changed = (replace(beam, foreshortening=foreshortening, **stated) for beam in beams)  # type: ignore[arg-type]
    return system.with_bodies(*changed)


def traced(diagram: sf.Diagram) -> sf.DiagramRun:
    """One run."""
    return sf.Simulation(diagram).run(T_END, dt=DT, record=RECORD)


def off(run: sf.DiagramRun) -> Array:
    """Distance of the tool from its desired position (n) [m]."""
    distance: Array = np.linalg.norm(run["tip.p"][:, :2] - run["path.p"], axis=1)
    return distance


def deflection(run: sf.DiagramRun) -> Array:
    """How far the tool is from where the motors' angles would put it on a rigid robot (n) [m]."""
    rigid = sf.compile(run.compiled.resolved.wired.models.system("control"))
    q = np.zeros((len(run.t), rigid.nq))
    for k, name in enumerate(MOTORS):
        q[:, rigid.names.q.index(name)] = run["q"][:, k]
    distance: Array = np.linalg.norm((run["tip.p"] - rigid.frame_pose("tool", q)[0])[:, :2], axis=1)
    return distance


def study(quick: bool) -> Study:
    """Measure how the flexible robot tracks the square under a rigid model's controller, and the run's speed."""
    simulation = sf.Simulation(square())
    flexible, rigid = simulation.run(T_END, dt=DT, record=RECORD), traced(square(functions=0))
    counts = (1, 2, 3) if quick else tuple(range(1, MOST + 1))
    runs = {n: traced(square(functions=n)) for n in counts}
    finest = runs[counts[-1]]["tip.p"]
    distances = {n: float(np.abs(run["tip.p"] - finest).max()) for n, run in runs.items() if n < counts[-1]}
    plain, foreshortened = (traced(square(robot=softened(shortens)))["tip.p"] for shortens in (False, True))
    bare = simulation.run(T_END, dt=DT, record=RECORD, parameters={"friction.factor": 0.0})
    speed, ratio, agreement = _speed(simulation, 0.5 if quick else 2.0)
    lag = float(np.abs(flexible["q_desired"] - flexible["q"]).max())
    worst, stiff = float(off(flexible).max()), float(off(rigid).max())
    control = len(simulation.resolved.wired.models.record("control").v_names)
    findings = (
        *_tracking(flexible, rigid),
        Finding(
            "speeds of the plant less those of the control model",
            float(simulation.resolved.layout.v["plant"].size - control),
            20.0,
            1.0,
            "two models in one run: the rigid one is the same description without shape functions",
        ),
        Finding(
            "tool, 2 shape functions a link against the finest [m]",
            distances[2],
            1e-3,
            reason="the first function carries the bending, later ones the detail",
        ),
        Finding(
            "foreshortening on and off, tool's largest difference [m]",
            float(np.abs(plain - foreshortened).max()),
            1e-2,
            5e-4,
            "a clamped beam whose end moves aside by d shortens by 3 d^2/(5 L): 5 mm for 60 mm on 0.5 m",
        ),
        Finding(
            "without friction compensation: motors' largest error over that with it",
            float(np.abs(bare["q_desired"] - bare["q"]).max() / lag),
            10.0,
            0.9,
            "the harmonic drives' friction is small against the other efforts",
        ),
        *_speeds(speed, ratio, agreement),
    )
    answer = (
        f"The tool follows the square within {1e3 * worst:.0f} mm, the same controller guides a rigid plant within"
        f" {1e3 * stiff:.1f} mm. Motors are never off by more than {1e3 * lag:.1f} mrad, so the path bulges"
        " where links bend: along accelerations in the middle of sides, and back as they stop, with the ringing of the"
        " first bending shapes at corners. As the paper says of its figure 9, this is the controller's, not the"
        f" simulation's. One second of motion takes {1e3 / speed:.2f} ms, controller, inverse kinematics and plant"
        f" included; block by block from Python {ratio:.0f} times as long."
    )
    return Study(
        "How does the flexible robot trace the paper's square?",
        answer,
        (_path(flexible, rigid), _errors(flexible, rigid), _effects(distances, runs, flexible)),
        findings,
        ("the SYMOFROS paper, section 8: start, corner, side, friction; gains and times are ours",),
    )


def _speeds(speed: float, ratio: float, agreement: float) -> tuple[Finding, ...]:
    """The compiled run beside the clock and the interpreted one (`_speed`)."""
    return (
        Finding(
            "compiled and interpreted run: largest difference of the tool [m]", agreement, 1e-11, reason="rounding"
        ),
        Finding("seconds of motion a second, 1 kHz control, RK4 at 0.25 ms", speed, np.inf, 100.0, "asked for: 100"),
        Finding(
            "time of the interpreted diagram (blocks compiled one by one) over the compiled one",
            ratio,
            np.inf,
            30.0,
            "asked for: 30",
        ),
    )


def _tracking(flexible: sf.DiagramRun, rigid: sf.DiagramRun) -> tuple[Finding, ...]:
    """Findings on tracking: deviations of tool and motors from their desired motion, flexible and rigid robot."""
    corners = [float(np.linalg.norm(flexible["tip.p"][at, :2] - point)) for at, point in _corners(flexible)]
    return (
        Finding(
            "flexible robot: largest distance of the tool from its path [m]",
            float(off(flexible).max()),
            0.1,
            0.01,
            "of the size that links of spring steel bend by; a rigid model's controller does not know of it",
        ),
        Finding(
            "rigid robot, same controller: largest distance [m]",
            float(off(rigid).max()),
            5e-3,
            reason="what is left is the elastic joint, 1200 N m/rad, which the plant keeps and the controller"
            " holds at zero, and the friction of the sampled law",
        ),
        Finding(
            "largest error of a motor's angle [rad]",
            float(np.abs(flexible["q_desired"] - flexible["q"]).max()),
            5e-3,
            reason="the PD acts on the motors: the tool is off because links bend, not because motors lag",
        ),
        Finding("error of the tool at the corners, largest [m]", max(corners), 0.04, reason="it stops there and rings"),
    )


def _corners(run: sf.DiagramRun) -> list[tuple[int, tuple[float, float]]]:
    """When the tool should be at each corner, and where that is."""
    x, y = CORNER
    points = [(x, y), (x + SIDE, y), (x + SIDE, y - SIDE), (x, y - SIDE), (x, y)]
    return [(int(np.argmin(np.abs(run.t - (APPROACH + k * ALONG)))), point) for k, point in enumerate(points)]


def _speed(simulation: sf.Simulation, interpreted: float) -> tuple[float, float, float]:
    """Seconds of motion a second (median of five), the interpreted run's time over it, and their difference [m]."""
    worked = [simulation.run(T_END, dt=DT, record=RECORD).cost.worked / T_END for _ in range(5)]
    simulation.interpret(0.01, dt=DT, record=RECORD)  # Compiles the blocks.
    start = time.thread_time()
    slow = simulation.interpret(interpreted, dt=DT, record=RECORD)
    taken = (time.thread_time() - start) / interpreted
    fast = simulation.run(interpreted, dt=DT, record=RECORD)
    compiled = float(np.median(worked))
    return 1.0 / compiled, taken / compiled, float(np.abs(fast["tip.p"] - slow["tip.p"]).max())


def _path(flexible: sf.DiagramRun, rigid: sf.DiagramRun) -> Figure:
    desired = flexible["path.p"]
    curves = (
        Curve("desired", desired[:, 0], desired[:, 1], 5, "dashed"),
        Curve("flexible links", flexible["tip.p"][:, 0], flexible["tip.p"][:, 1], 0),
        Curve("rigid links", rigid["tip.p"][:, 0], rigid["tip.p"][:, 1], 1, "dotted"),
    )
    chart = Chart("path of the tool", "x [m]", "y [m]", curves, equal=True)
    return Figure(
        "From the start at the right the tool goes to the corner (0.3, 0.3) m and around the square, clockwise. The"
        " rigid robot covers the desired path; the flexible one bulges and rings, as in the paper's figure 9.",
        (chart,),
    )


def _errors(flexible: sf.DiagramRun, rigid: sf.DiagramRun) -> Figure:
    motors = [
        Curve(name, flexible.t, 1e3 * (flexible["q_desired"] - flexible["q"])[:, k], k) for k, name in enumerate(MOTORS)
    ]
    bent = deflection(flexible)
    tool = (
        Curve("flexible: off the path", flexible.t, 1e3 * off(flexible), 0),
        Curve("flexible: off where its motors point", flexible.t, 1e3 * bent, 4, "dotted"),
        Curve("rigid: off the path", rigid.t, 1e3 * off(rigid), 1),
    )
    ends = Mark("square closed", T_END - 1.0, "x")
    return Figure(
        "Left: motors keep to their desired angles within a few milliradians. Right: the tool's distance from its path"
        " is its distance from where the motors point, so it is bending; it peaks where sides are accelerated and"
        " decays after the square is closed.",
        (
            Chart("motors: desired less actual angle", "time [s]", "error [mrad]", tuple(motors), (ends,)),
            Chart("tool", "time [s]", "distance [mm]", tool, (ends,)),
        ),
    )


def _effects(distances: dict[int, float], runs: dict[int, sf.DiagramRun], flexible: sf.DiagramRun) -> Figure:
    counts = np.array(list(distances), dtype=float)
    finest = max(runs)
    left = Chart(
        f"tool against {finest} functions a link",
        "shape functions in each link",
        "largest distance [m]",
        (Curve("difference", counts, np.array(list(distances.values())), 0, "joined"),),
        log="y",
    )
    seen = flexible.t >= T_END - 1.2
    resolved = flexible.compiled.resolved
    names = resolved.layout.q_names[resolved.layout.q["plant"].slice]
    curves = [
        Curve(name.removeprefix("plant."), flexible.t[seen], 1e3 * flexible["plant.q"][seen][:, k], i)
        for i, (k, name) in enumerate((k, name) for k, name in enumerate(names) if name.endswith("[0]") or "e1" in name)
    ]
    right = Chart("after the last corner", "time [s]", "coordinate [mrad or 10⁻³]", tuple(curves))
    return Figure(
        "Left: what a richer plant changes. Right: the elastic joint and the first shape of each link ring on after the"
        " square is closed; their retardation damps them.",
        (left, right),
    )
